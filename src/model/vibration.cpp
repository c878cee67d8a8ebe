#include "vibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Of an input's spread over a trial: as far apart are neighbouring blocks of the same inputs, so that what
/// changes slowly, or is noise, goes on with time.
constexpr double kStepOfTime = 0.02;
constexpr double kLeastStep = 0.005;  // the same, of what tells more than noise
constexpr double kSmallAngle = 1e-6;  // rad: sine and cosine by their first terms

VectorXd stacked(const std::vector<Vector3d>& list) {
  VectorXd all(3 * static_cast<Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) all.segment<3>(3 * static_cast<Index>(i)) = list[i];
  return all;
}

std::vector<Vector3d> unstacked(const VectorXd& all) {
  std::vector<Vector3d> list;
  for (Index i = 0; i < all.size(); i += 3) list.push_back(all.segment<3>(i));
  return list;
}

/// Where on the way of the equilibria through three neighbouring blocks the arm belongs at a frame: as its
/// inputs lie between those of the blocks.
class Way {
 public:
  Way(const TrialData& trial, const Series& series, const std::vector<Rest>& rest)
      : trial_(trial), rest_(rest), inputs_(series.moment_inputs) {
    for (Index i = 0; i < inputs_.rows(); ++i) {
      const double spread = inputs_.row(i).maxCoeff() - inputs_.row(i).minCoeff();
      inputs_.row(i) /= spread > 0.0 ? spread : 1.0;
    }
    for (const Block& block : trial.blocks)
      means_.push_back(
          inputs_.middleCols(static_cast<Index>(block.first), static_cast<Index>(block.last - block.first))
              .rowwise()
              .mean());
    t_s_ = series.t_s;
  }

  bool joined(std::size_t k) const {  // to the block before
    return k > 0 && k < rest_.size() && !trial_.blocks[k].begins && has(k) && has(k - 1);
  }
  const Rest& rest(std::size_t k) const { return rest_[k]; }
  bool has(std::size_t k) const { return !rest_[k].stations.empty(); }

  /// By the differences to the blocks before and after it, as far as those make the inputs of the frame.
  /// @param at of the equilibria of blocks k - 1, k, k + 1, in modes
  VectorXd rest_of(std::size_t k, Index frame, const VectorXd (&at)[3]) const {
    const Index n = inputs_.rows();
    Eigen::MatrixX2d steps = Eigen::MatrixX2d::Zero(n + 1, 2);
    if (joined(k)) steps.col(0) << means_[k - 1] - means_[k], -kStepOfTime;
    if (joined(k + 1)) steps.col(1) << means_[k + 1] - means_[k], kStepOfTime;
    const double before_s = joined(k) ? rest_[k].t_s - rest_[k - 1].t_s : 0.0,
                 after_s = joined(k + 1) ? rest_[k + 1].t_s - rest_[k].t_s : before_s;
    VectorXd off(n + 1);
    off << inputs_.col(frame) - means_[k],
        after_s > 0.0 ? kStepOfTime * (t_s_[frame] - rest_[k].t_s) / after_s : 0.0;
    Eigen::Matrix2d normal = steps.transpose() * steps;
    normal.diagonal().array() += kLeastStep * kLeastStep;
    const Eigen::Vector2d share = normal.inverse() * (steps.transpose() * off);
    VectorXd rest = at[1];
    if (joined(k)) rest += share[0] * (at[0] - at[1]);
    if (joined(k + 1)) rest += share[1] * (at[2] - at[1]);
    return rest;
  }

 private:
  const TrialData& trial_;
  const std::vector<Rest>& rest_;
  MatrixXd inputs_;
  std::vector<VectorXd> means_;
  VectorXd t_s_;
};

/// All modes at one instant.
struct Swinging {
  VectorXd x, rate;
};

/// Means over a block.
struct BlockMeans {
  VectorXd rate, acceleration;
};

/// Goes through the frames of a block, up to the first of the next one.
BlockMeans pass_through(const Modes& modes, const Way& way, const TrialData& trial, const VectorXd& t_s,
                        std::size_t k, const Sluggishness& sluggish, const VectorXd (&at)[3], Swinging& now) {
  const Block& block = trial.blocks[k];
  const Modes::Springs springs = modes.springs_of(way.rest(k), sluggish);
  BlockMeans means{VectorXd::Zero(now.x.size()), VectorXd::Zero(now.x.size())};
  const double share = 1.0 / static_cast<double>(block.last - block.first);
  VectorXd g = way.rest_of(k, static_cast<Index>(block.first), at);
  for (std::size_t i = block.first; i < block.last; ++i) {
    means.rate += share * now.rate;
    means.acceleration +=
        share * (springs.stiffness.cwiseProduct(g - now.x) - springs.damping.cwiseProduct(now.rate));
    const auto next = static_cast<Index>(i + 1);
    if (next >= t_s.size()) break;
    const VectorXd g_next = way.rest_of(k, next, at);
    for (Index m = 0; m < g.size(); ++m) {
      const Oscillator::State there =
          Oscillator(springs.stiffness[m], springs.damping[m], t_s[next] - t_s[next - 1])
              .step({now.x[m], now.rate[m]}, g[m], g_next[m]);
      now.x[m] = there.x;
      now.rate[m] = there.rate;
    }
    g = g_next;
  }
  return means;
}

/// What of the motion of the equilibria lies in the modes gives way to how those swing.
void replace(const Modes& modes, const BlockMeans& means, Motion& motion) {
  if (motion.velocity_m_s.empty()) {
    motion.velocity_m_s = unstacked(modes.shape * means.rate);
    motion.acceleration_m_s2 = unstacked(modes.shape * means.acceleration);
    motion.curvature_rate = unstacked(modes.curvature * means.rate);
    return;
  }
  const VectorXd velocity = stacked(motion.velocity_m_s), acceleration = stacked(motion.acceleration_m_s2);
  const VectorXd rate = means.rate - modes.project * velocity;
  motion.velocity_m_s = unstacked(velocity + modes.shape * rate);
  motion.acceleration_m_s2 =
      unstacked(acceleration + modes.shape * (means.acceleration - modes.project * acceleration));
  motion.curvature_rate = unstacked(stacked(motion.curvature_rate) + modes.curvature * rate);
}

}  // namespace

Oscillator::Oscillator(double stiffness, double damping, double dt_s)
    : dt_s_(dt_s), behind_(damping / stiffness) {
  const double half = 0.5 * damping, square = stiffness - half * half;
  const double w = std::sqrt(std::abs(square)), angle = w * dt_s, decay = std::exp(-half * dt_s);
  double c = decay, s = decay * dt_s;  // cos, and sin over w, as they die away
  if (angle > kSmallAngle && square > 0.0) {
    c = decay * std::cos(angle);
    s = decay * std::sin(angle) / w;
  } else if (angle > kSmallAngle) {
    const double slow = std::exp((w - half) * dt_s), fast = std::exp(-(w + half) * dt_s);
    c = 0.5 * (slow + fast);
    s = 0.5 * (slow - fast) / w;
  }
  xx_ = c + half * s;
  xr_ = s;
  rx_ = -stiffness * s;
  rr_ = c - half * s;
}

Oscillator::State Oscillator::following(double g0, double g1) const {
  const double slope = (g1 - g0) / dt_s_;
  return {g0 - behind_ * slope, slope};
}

Oscillator::State Oscillator::step(const State& at, double g0, double g1) const {
  // About the motion that follows the line once all has died away.
  const double slope = (g1 - g0) / dt_s_, late = behind_ * slope;
  const double x = at.x - (g0 - late), rate = at.rate - slope;
  return {g1 - late + xx_ * x + xr_ * rate, slope + rx_ * x + rr_ * rate};
}

std::vector<MatrixXd> free_swing(const TrialModes& modes, const TrialData& trial,
                                 const std::vector<Rest>& rest, const Sluggishness& sluggish,
                                 std::size_t first) {
  std::vector<MatrixXd> by;
  MatrixXd x, rate;  // r x 2r
  for (std::size_t k = first; k < rest.size(); ++k) {
    const Modes* const here = modes[k].get();
    if (here == nullptr || rest[k].stations.empty() || trial.blocks[k].set_aside ||
        (k > first && trial.blocks[k].begins))
      break;
    const Index r = here->stiffness.size();
    if (k == first) {
      x = MatrixXd::Identity(r, 2 * r);
      rate.setZero(r, 2 * r);
      rate.rightCols(r).setIdentity();
    } else {
      if (here != modes[k - 1].get()) {
        const MatrixXd turn = here->project * modes[k - 1]->shape;
        x = turn * x;
        rate = turn * rate;
      }
      const Modes::Springs springs = here->springs_of(rest[k], sluggish);
      for (Index m = 0; m < r; ++m) {
        const Oscillator oscillator(springs.stiffness[m], springs.damping[m], rest[k].t_s - rest[k - 1].t_s);
        for (Index c = 0; c < 2 * r; ++c) {
          const Oscillator::State there = oscillator.step({x(m, c), rate(m, c)}, 0.0, 0.0);
          x(m, c) = there.x;
          rate(m, c) = there.rate;
        }
      }
    }
    by.push_back(here->bodies * x);
  }
  return by;
}

SwingOfChange::SwingOfChange(const TrialModes& modes, const TrialData& trial, const std::vector<Rest>& rest,
                             const Sluggishness& sluggish)
    : steps_(rest.size()) {
  for (std::size_t k = 1; k < rest.size(); ++k) {
    const Modes *const before = modes[k - 1].get(), *const here = modes[k].get();
    if (before == nullptr || here == nullptr || rest[k - 1].stations.empty() || rest[k].stations.empty() ||
        trial.blocks[k].begins || trial.blocks[k].set_aside)
      continue;
    Step& step = steps_[k];
    const Modes::Springs springs = here->springs_of(rest[k], sluggish);
    for (Index m = 0; m < springs.stiffness.size(); ++m)
      step.to.emplace_back(springs.stiffness[m], springs.damping[m], rest[k].t_s - rest[k - 1].t_s);
    if (before != here) step.turn = here->project * before->shape;
  }
}

MatrixXd SwingOfChange::beyond(const MatrixXd& now, const MatrixXd& next) const {
  MatrixXd out = MatrixXd::Zero(now.rows(), now.cols());
  VectorXd beyond = VectorXd::Zero(now.rows()), rate = beyond;  // of the block before
  bool begins = true;
  for (Index k = 0; k < now.cols(); ++k) {
    const Step& step = steps_[static_cast<std::size_t>(k)];
    if (step.to.empty()) {
      beyond.setZero();
      begins = true;
      continue;
    }
    if (step.turn.size() > 0) {
      beyond = step.turn * beyond;
      rate = step.turn * rate;
    }
    for (Index m = 0; m < beyond.size(); ++m) {
      const double from = next(m, k - 1), to = now(m, k);
      const Oscillator& oscillator = step.to[static_cast<std::size_t>(m)];
      // At first it follows its equilibria, whether those rest or move.
      const Oscillator::State there = oscillator.step(
          begins ? oscillator.following(from, to) : Oscillator::State{from + beyond[m], rate[m]}, from, to);
      beyond[m] = there.x - to;
      rate[m] = there.rate;
    }
    begins = false;
    out.col(k) = beyond;
  }
  return out;
}

std::vector<Motion> follow(const TrialData& trial, const std::vector<Rest>& rest) {
  std::vector<Motion> list(rest.size());
  for (std::size_t k = 1; k + 1 < rest.size(); ++k) {
    const Rest &before = rest[k - 1], &now = rest[k], &after = rest[k + 1];
    if (before.stations.empty() || now.stations.empty() || after.stations.empty() || trial.blocks[k].begins ||
        trial.blocks[k + 1].begins)
      continue;
    const double a = now.t_s - before.t_s, b = after.t_s - now.t_s;
    const auto second = [&](const Vector3d& x0, const Vector3d& x1, const Vector3d& x2) {
      return Vector3d(2.0 * ((x2 - x1) / b - (x1 - x0) / a) / (a + b));
    };
    const auto first = [&](const Vector3d& x0, const Vector3d& x1, const Vector3d& x2) {
      return Vector3d((a * (x2 - x1) / b + b * (x1 - x0) / a) / (a + b));
    };
    for (std::size_t j = 0; j < now.stations.size(); ++j) {
      list[k].velocity_m_s.push_back(first(before.stations[j], now.stations[j], after.stations[j]));
      list[k].acceleration_m_s2.push_back(second(before.stations[j], now.stations[j], after.stations[j]));
      list[k].curvature_rate.push_back(first(before.curvature[j], now.curvature[j], after.curvature[j]));
    }
  }
  return list;
}

std::vector<Motion> swing(const TrialModes& modes, const TrialData& trial, const Series& series,
                          const Sluggishness& sluggish, const std::vector<Rest>& rest) {
  std::vector<Motion> list = follow(trial, rest);
  const Way way(trial, series, rest);
  const Modes* last = nullptr;
  Swinging now;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const Modes* const here = modes[k].get();
    if (here == nullptr || !way.has(k) || trial.blocks[k].set_aside) {
      last = nullptr;
      continue;
    }
    VectorXd at[3];
    const VectorXd own = stacked(rest[k].stations);
    at[1] = VectorXd::Zero(here->stiffness.size());
    if (way.joined(k)) at[0] = here->project * (stacked(rest[k - 1].stations) - own);
    if (k + 1 < rest.size() && way.joined(k + 1))
      at[2] = here->project * (stacked(rest[k + 1].stations) - own);
    if (last != nullptr && way.joined(k)) {
      // Its displacements were counted from the equilibrium before; what of the way is beside those modes the
      // arm followed.
      const Modes& before = *last;
      const VectorXd way_m = own - stacked(rest[k - 1].stations),
                     beside_m = way_m - before.shape * (before.project * way_m);
      const double dt = rest[k].t_s - rest[k - 1].t_s,
                   share = (series.t_s[static_cast<Index>(trial.blocks[k].first)] - rest[k - 1].t_s) / dt;
      now.x = at[0] + here->project * (before.shape * now.x + share * beside_m);
      now.rate = here->project * (before.shape * now.rate + beside_m / dt);
    } else {
      // It follows its equilibria, whether those rest or move.
      now.x = way.rest_of(k, static_cast<Index>(trial.blocks[k].first), at);
      now.rate = VectorXd::Zero(now.x.size());
      if (at[2].size() > 0) {
        const Modes::Springs springs = here->springs_of(rest[k], sluggish);
        const double dt = rest[k + 1].t_s - rest[k].t_s;
        now.rate = at[2] / dt;
        if (k + 2 < rest.size() && way.joined(k + 2)) {
          const VectorXd bend = here->project * (stacked(rest[k + 2].stations) - own) - 2.0 * at[2];
          const double early = (rest[k].t_s - series.t_s[static_cast<Index>(trial.blocks[k].first)]) / dt;
          now.rate -= (0.5 + early) / dt * bend;
        }
        now.x -= springs.damping.cwiseQuotient(springs.stiffness).cwiseProduct(now.rate);
      }
    }
    replace(*here, pass_through(*here, way, trial, series.t_s, k, sluggish, at, now), list[k]);
    last = here;
  }
  return list;
}

}  // namespace softarm::model
