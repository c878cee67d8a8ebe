// What is known of an arm's motion, and what is not: modes, swings that no input made, blocks that are left
// out.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "joint_model.h"
#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Block;
using model::Predicted;
using model::Seen;
using model::TrialData;

/// A swing that no input made: from where a trial begins, or a hand let go.
struct FreeSwing {
  std::size_t first = 0;
  double reach_m = 0.0;      ///< as far as it may be, of a body
  std::vector<MatrixXd> by;  ///< of the blocks from there on, see model::free_swing()
};

/// By how fast a swing dies away, of the mode that keeps it longest, 1/s.
double decay_of(const model::Modes* modes, const Predicted& now) {
  const double least = 1.0 / kPolicy.motion.longest_swing_s;
  if (modes == nullptr || now.rest.stations.empty()) return least;
  return std::max(least, 0.5 * modes->springs_of(now.rest, now.sluggish).damping.minCoeff());
}

double distance_m(const Predicted& a, const Predicted& b) {
  return (a.rest.stations.back() - b.rest.stations.back()).norm();
}

/// All of a trial.
std::vector<FreeSwing> free_swings(const model::TrialModes& modes, const TrialData& trial,
                                   const std::vector<Predicted>& predicted, double noise_m) {
  std::vector<model::Rest> rest;
  for (const Predicted& block : predicted) rest.push_back(block.solved ? block.rest : model::Rest());
  std::vector<FreeSwing> list;
  const Predicted* before_hand = nullptr;
  bool begins = true;
  double hand_m = 0.0;  // how far the equilibria went under it
  for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
    if (!predicted[k].solved) continue;
    if (trial.blocks[k].begins) {
      begins = true;
      before_hand = nullptr;
      hand_m = 0.0;
    }
    if (trial.blocks[k].set_aside) {
      if (before_hand != nullptr) hand_m = std::max(hand_m, distance_m(predicted[k], *before_hand));
      begins = true;
      continue;
    }
    before_hand = &predicted[k];
    if (!begins || modes[k] == nullptr) continue;
    begins = false;
    FreeSwing swing;
    swing.first = k;
    const std::size_t next = k + 1;
    double by_inputs_m = 0.0;  // in the time of the slowest mode
    if (next < rest.size() && predicted[next].solved && rest[next].t_s > rest[k].t_s)
      by_inputs_m = distance_m(predicted[k], predicted[next]) / (rest[next].t_s - rest[k].t_s) /
                    std::sqrt(modes[k]->stiffness.minCoeff());
    swing.reach_m = noise_m + hand_m + by_inputs_m;
    swing.by = model::free_swing(modes, trial, rest, predicted[k].sluggish, k);
    hand_m = 0.0;
    list.push_back(std::move(swing));
  }
  return list;
}

/// What bodies and tangents did of a free swing, by block, and how well that is known.
struct Known {
  std::vector<VectorXd> displacement;  ///< 6b
  std::vector<double> sd_m;            ///< of the body that is known least, per axis
};

/// By least squares upon what was seen, beside an error of the model that goes along straight lines.
Known known_of(const FreeSwing& swing, const model::Modes& modes, const TrialData& trial,
               const std::vector<Predicted>& predicted) {
  const Index r = swing.by.front().cols() / 2, bodies = swing.by.front().rows() / 6;
  const Index unknowns = 2 * r + 6 * bodies;
  std::vector<double> distances;
  for (std::size_t i = 0; i < swing.by.size(); ++i) {
    const std::size_t k = swing.first + i;
    for (std::size_t j = 0; j < trial.blocks[k].bodies.size() && predicted[k].solved; ++j)
      distances.push_back(
          (trial.blocks[k].bodies[j].p_base - predicted[k].p.col(static_cast<Index>(j))).norm());
  }
  Known known;
  if (distances.empty()) return known;
  const double misfit_m = math::median(std::move(distances)) / kMedianOfChi3;
  MatrixXd information = MatrixXd::Zero(unknowns, unknowns);
  VectorXd gradient = VectorXd::Zero(unknowns);
  const double begin_s = predicted[swing.first].rest.t_s,
               span_s = std::max(1.0, predicted[swing.first + swing.by.size() - 1].rest.t_s - begin_s);
  for (std::size_t i = 0; i < swing.by.size(); ++i) {
    const std::size_t k = swing.first + i;
    if (!predicted[k].solved) continue;
    for (std::size_t j = 0; j < trial.blocks[k].bodies.size(); ++j) {
      const Seen& seen = trial.blocks[k].bodies[j];
      const double variance = std::max(seen.white_sd_m * seen.white_sd_m, misfit_m * misfit_m);
      MatrixXd row = MatrixXd::Zero(3, unknowns);
      row.leftCols(2 * r) = swing.by[i].middleRows<3>(3 * seen.body);
      row.middleCols<3>(2 * r + 6 * seen.body).setIdentity();
      row.middleCols<3>(2 * r + 6 * seen.body + 3) =
          (predicted[k].rest.t_s - begin_s) / span_s * Eigen::Matrix3d::Identity();
      const Vector3d off = seen.p_base - predicted[k].p.col(static_cast<Index>(j));
      information.noalias() += row.transpose() * row / variance;
      gradient.noalias() += row.transpose() * off / variance;
    }
  }
  for (Index m = 0; m < r; ++m) {
    const double sd = swing.reach_m / modes.bodies.topRows(3 * bodies).col(m).cwiseAbs().maxCoeff();
    information(m, m) += 1.0 / (sd * sd);
    information(r + m, r + m) += 1.0 / (sd * sd * modes.stiffness[m]);
  }
  information.diagonal().tail(6 * bodies).array() += 1.0 / (misfit_m * misfit_m + 1e-12);
  const MatrixXd covariance = math::inverse_of_symmetric(information);
  const VectorXd state = (covariance * gradient).head(2 * r);
  const MatrixXd sure = covariance.topLeftCorner(2 * r, 2 * r);
  for (const MatrixXd& by : swing.by) {
    known.displacement.push_back(by * state);
    const MatrixXd places = by.topRows(3 * bodies);
    known.sd_m.push_back(std::sqrt((places * sure).cwiseProduct(places).rowwise().sum().maxCoeff()));
  }
  return known;
}

double most_m(const VectorXd& displacement) {
  double most = 0.0;
  for (Index b = 0; b < displacement.size() / 6; ++b)
    most = std::max(most, displacement.segment<3>(3 * b).norm());
  return most;
}

}  // namespace

void JointModel::find_modes(const JointParameters& parameters,
                            const std::vector<std::vector<Predicted>>& predicted) {
  const arm::Arm arm = arm_with(parameters.constants);
  std::vector<model::TrialModes> found(trials_.size());
  math::in_parallel(trials_.size(), jobs_, [&](std::size_t t) {
    found[t] =
        models_[t].modes(arm, all(parameters.effects), dynamics(parameters, t), trials_[t], predicted[t]);
  });
  modes_ = std::move(found);
}

/// A trial's unknown motion is what inertia does of which a share is not known, and what no input made. Both
/// die away as the modes do.
void JointModel::find_swings(std::size_t trial, std::vector<Predicted>& predicted, bool recorded) {
  const TrialData& data = trials_[trial];
  std::vector<double>& sd_m = motion_sd_m_[trial];
  double unknown_m = 0.0;
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    const Predicted& now = predicted[k];
    unknown_m *=
        now.instant.dt_s > 0.0 ? std::exp(-now.instant.dt_s * decay_of(modes_[trial][k].get(), now)) : 0.0;
    if (data.blocks[k].set_aside)
      unknown_m = 0.0;  // a hand held the arm
    else if (now.solved)
      unknown_m = std::max(unknown_m, kPolicy.motion.share * now.inertial_m);
    sd_m[k] = unknown_m;
  }
  if (!recorded) return;
  std::vector<VectorXd>& left = swings_[trial];
  left.assign(predicted.size(), {});
  for (const FreeSwing& swing : free_swings(modes_[trial], data, predicted, noise_m(arm_))) {
    const Known known = known_of(swing, *modes_[trial][swing.first], data, predicted);
    for (std::size_t i = 0; i < known.sd_m.size(); ++i) {
      const std::size_t k = swing.first + i;
      left[k] = known.displacement[i];
      sd_m[k] = std::hypot(sd_m[k], std::hypot(known.sd_m[i], kPolicy.motion.share * most_m(left[k])));
    }
  }
}

/// Of bodies, by their white noise alone.
double JointModel::chi2(const std::vector<std::vector<Predicted>>& predicted, double& rows) const {
  double sum = 0.0;
  rows = 0.0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      const std::vector<Seen>& bodies = trials_[t].blocks[k].bodies;
      for (std::size_t i = 0; i < bodies.size() && used_[t][k] && predicted[t][k].solved; ++i, rows += 3.0)
        sum += (bodies[i].p_base - predicted[t][k].p.col(static_cast<Index>(i))).squaredNorm() /
               (bodies[i].white_sd_m * bodies[i].white_sd_m);
    }
  }
  return sum;
}

/// Statics alone may explain trials to the noise, and better than an arm that swings: such trials come from a
/// computation without inertia, and nothing swings there.
bool JointModel::is_quasi_static(const JointParameters& parameters,
                                 const std::vector<std::vector<Predicted>>& swinging) {
  std::vector<std::vector<Predicted>> still(trials_.size());
  const arm::Arm arm = arm_with(parameters.constants);
  math::in_parallel(trials_.size(), jobs_, [&](std::size_t t) {
    models_[t].predict(arm, all(parameters.effects), {false, parameters.viscoelastic_lag_s}, trials_[t],
                       &swinging[t], still[t]);
  });
  double rows = 0.0;
  const double with = chi2(swinging, rows), without = chi2(still, rows);
  return without < kPolicy.verdict.as_noise_chi2 * rows && with - without > kPolicy.motion.no_inertia_chi2;
}

std::size_t JointModel::allow_for_motion(const JointParameters& parameters,
                                         std::vector<std::vector<Predicted>>& predicted, bool recorded) {
  find_modes(parameters, predicted);
  predict(parameters, &predicted, predicted);
  if (recorded && is_quasi_static(parameters, predicted)) {
    quasi_static_ = true;
    modes_.clear();
    predict(parameters, &predicted, predicted);
    return 0;
  }
  swings_.resize(trials_.size());
  math::in_parallel(trials_.size(), jobs_, [&](std::size_t t) { find_swings(t, predicted[t], recorded); });
  // What is not known of a swing spoils what is smaller than it is. Beside a model that is off by more,
  // little would be won, and of an arm that never rests nearly everything lost.
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    add_swings(t, predicted[t]);
    const std::vector<Block>& blocks = trials_[t].blocks;
    for (std::size_t k = 0; k < blocks.size() && recorded; ++k) {
      if (!used_[t][k] || !predicted[t][k].solved) continue;
      for (std::size_t i = 0; i < blocks[k].bodies.size(); ++i)
        distances.push_back(
            (blocks[k].bodies[i].p_base - predicted[t][k].p.col(static_cast<Index>(i))).norm());
    }
  }
  double limit_m = kPolicy.motion.swing * noise_m(arm_);
  if (!distances.empty()) limit_m = std::max(limit_m, math::median(std::move(distances)));
  std::size_t aside = 0;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      if (motion_sd_m_[t][k] <= limit_m || !used_[t][k]) continue;
      used_[t][k] = false;
      ++aside;
    }
  }
  return aside;
}

void JointModel::add_swings(std::size_t trial, std::vector<Predicted>& predicted) const {
  if (swings_.empty() || swings_[trial].empty()) return;
  const auto bodies = static_cast<Index>(arm_.bodies.size());
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    const VectorXd& swing = swings_[trial][k];
    if (swing.size() == 0 || !predicted[k].solved) continue;
    const Block& block = trials_[trial].blocks[k];
    for (std::size_t i = 0; i < block.bodies.size(); ++i)
      predicted[k].p.col(static_cast<Index>(i)) += swing.segment<3>(3 * block.bodies[i].body);
    for (std::size_t i = 0; i < block.tangents.size(); ++i)
      predicted[k].tangents.col(static_cast<Index>(i)) +=
          swing.segment<3>(3 * (bodies + block.tangents[i].body));
  }
}

}  // namespace softarm::diagnose
