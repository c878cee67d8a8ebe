// The fit of the joint model: robust weights, bounds, what the arm's motion spoils.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "joint_model.h"

namespace softarm::diagnose {
namespace {

using effects::Block;
using effects::Predicted;
using effects::Present;
using Eigen::VectorXd;

constexpr double kHuber = 4.0;            // times the typical distance
constexpr double kMedianOfChi3 = 1.5382;  // of the length of a normal vector in three dimensions
constexpr double kSwingDecay_s = 0.8;     // of what a sudden motion leaves
constexpr double kMotionShare = 0.3;      // of what inertia and delay do that is not known
constexpr double kSwing_m = 0.0015;

}  // namespace

double huber_weight(double distance, double threshold) {
  return distance <= threshold ? 1.0 : threshold / distance;
}

void JointModel::set_threshold(const std::vector<std::vector<Predicted>>& predicted) {
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd r = residual(t, predicted[t]);
    for (Eigen::Index i = 0; i < r.size(); i += 3) {
      const double d = r.segment<3>(i).norm();
      if (d > 0.0) distances.push_back(d);
    }
  }
  if (distances.empty()) return;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  threshold_ = kHuber * std::max(1.0, *middle / kMedianOfChi3) * kMedianOfChi3;
}

double JointModel::cost(const Parameters& parameters, const std::vector<std::vector<Predicted>>& predicted,
                        const std::vector<Column>& columns) const {
  double sum = 0.0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd r = residual(t, predicted[t]);
    for (Eigen::Index i = 0; i < r.size(); i += 3) {
      const double d = r.segment<3>(i).norm();
      sum += d <= threshold_ ? d * d : threshold_ * (2.0 * d - threshold_);
    }
    // A block without an equilibrium is as bad as one that is far off.
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      if (used_[t][k] && !predicted[t][k].solved)
        sum += 10.0 * threshold_ * threshold_ * static_cast<double>(trials_[t].blocks[k].bodies.size());
    }
  }
  Linearised dummy;
  dummy.at = parameters;
  dummy.columns = columns;
  const VectorXd x = dummy.unknowns();
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Column& c = columns[static_cast<std::size_t>(j)];
    sum += misfit_ * std::pow((x[j] - c.start) / c.prior_sd, 2);
  }
  return sum;
}

Linearised JointModel::fit(Parameters parameters, const FitOptions& options,
                           const std::vector<std::vector<Predicted>>* start) {
  std::vector<std::vector<Predicted>> predicted;
  predict(parameters, start, predicted);
  set_threshold(predicted);
  Linearised lin;
  const bool feedback = answers_itself(parameters);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    lin = linearise(parameters, &predicted, Derivatives::kShapesHeld, !feedback);
    const double before = cost(parameters, lin.predicted, lin.columns);
    const VectorXd x = lin.unknowns();
    VectorXd step = lin.information.ldlt().solve(lin.gradient);
    // Unknowns that would leave their range stay at its end, and the others are solved for again.
    std::vector<bool> fixed(lin.columns.size(), false);
    for (int round = 0; round < 5; ++round) {
      bool more = false;
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        const Column& c = lin.columns[static_cast<std::size_t>(j)];
        if (fixed[static_cast<std::size_t>(j)]) continue;
        const double wanted = (x[j] + step[j]) * c.scale;
        if (wanted < c.low || wanted > c.high) {
          fixed[static_cast<std::size_t>(j)] = true;
          step[j] = (wanted < c.low ? c.low : c.high) / c.scale - x[j];
          more = true;
        }
      }
      if (!more) break;
      Eigen::MatrixXd h = lin.information;
      VectorXd g = lin.gradient;
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        if (!fixed[static_cast<std::size_t>(j)]) continue;
        g -= lin.information.col(j) * step[j];
      }
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        if (!fixed[static_cast<std::size_t>(j)]) continue;
        h.row(j).setZero();
        h.col(j).setZero();
        h(j, j) = 1.0;
        g[j] = step[j];
      }
      step = h.ldlt().solve(g);
    }
    double share = 1.0;
    bool better = false;
    Parameters next;
    std::vector<std::vector<Predicted>> there;
    for (int halving = 0; halving < 5 && !better; ++halving, share *= 0.4) {
      next = parameters;
      for (Eigen::Index j = 0; j < x.size(); ++j)
        set_unknown(next, lin.columns[static_cast<std::size_t>(j)], x[j] + share * step[j]);
      predict(next, &lin.predicted, there);
      better = cost(next, there, lin.columns) <= before;
    }
    if (!better) break;
    parameters = next;
    predicted = std::move(there);
    const VectorXd sd =
        lin.information.ldlt().solve(Eigen::MatrixXd::Identity(x.size(), x.size())).diagonal().cwiseSqrt();
    const double misfit = std::max(1.0, std::sqrt(lin.square / std::max(1, lin.rows)));
    set_threshold(predicted);
    if ((step.array() / sd.array()).abs().maxCoeff() < options.tolerance * misfit) break;
  }
  return linearise(parameters, &predicted,
                   feedback && options.whole ? Derivatives::kWhole : Derivatives::kShapesHeld, !feedback);
}

bool JointModel::answers_itself(const Parameters& parameters) const {
  const std::vector<Present> present = all(parameters.effects);
  return std::any_of(present.begin(), present.end(),
                     [](const Present& one) { return one.effect->needs_shape(); });
}

std::size_t JointModel::allow_for_motion(const std::vector<std::vector<Predicted>>& predicted) {
  // A swing spoils what is smaller than it is. Beside a model that is off by more, little would be won, and
  // of an arm that never rests nearly everything lost.
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const std::vector<Block>& blocks = trials_[t].blocks;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (!used_[t][k] || !predicted[t][k].solved) continue;
      for (std::size_t i = 0; i < blocks[k].bodies.size(); ++i)
        distances.push_back(
            (blocks[k].bodies[i].p_base - predicted[t][k].p.col(static_cast<Eigen::Index>(i))).norm());
    }
  }
  double swing_m = kSwing_m;
  if (!distances.empty()) {
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    swing_m = std::max(kSwing_m, *middle);
  }
  std::size_t aside = 0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    double envelope_m = 0.0;
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      const Predicted& now = predicted[t][k];
      envelope_m = now.instant.dt_s > 0.0 ? envelope_m * std::exp(-now.instant.dt_s / kSwingDecay_s) : 0.0;
      if (now.solved) envelope_m = std::max(envelope_m, now.inertial_m);
      motion_sd_m_[t][k] = kMotionShare * envelope_m;
      if (envelope_m > swing_m && used_[t][k]) {
        used_[t][k] = false;
        ++aside;
      }
    }
  }
  return aside;
}

}  // namespace softarm::diagnose
