// What is known of an arm's motion, and what is not: in modes or to first order, and which blocks are left
// out.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "free_swing.h"
#include "joint_model.h"
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

/// By how fast a swing dies away, of the mode that keeps it longest, 1/s.
double decay_of(const model::Modes* modes, const Predicted& now) {
  if (modes == nullptr || now.rest.stations.empty()) return 1.0 / kPolicy.motion.usual_swing_s;
  return std::max(1.0 / kPolicy.motion.longest_swing_s,
                  0.5 * modes->springs_of(now.rest, now.sluggish).damping.minCoeff());
}

/// What an arm's equilibrium is off, per share by which its stiffness is. Weight and payload take from the
/// stiffness: near buckling little is left of it, and the arm falls where the model still stands.
double by_stiffness_m(const model::Modes* modes, const Predicted& now) {
  const Vector3d& tip = now.rest.stations.back();
  const double deflection_m = (tip - Vector3d(0.0, 0.0, now.rest.lengths_m.sum())).norm(),
               most = 1.0 / kPolicy.motion.least_stiffness;
  if (modes == nullptr) return most * deflection_m;  // nothing holds it
  const double beyond = modes->elastic.cwiseQuotient(modes->stiffness).maxCoeff() - 1.0;
  return std::clamp(beyond, 0.0, most) * deflection_m;
}

double most_m(const VectorXd& displacement) {
  double most = 0.0;
  for (Index b = 0; b < displacement.size() / 6; ++b)
    most = std::max(most, displacement.segment<3>(3 * b).norm());
  return most;
}

/// Of the errors of blocks, by Student's t: their own size, and the shares that are not known of what inertia
/// does and of the stiffness.
struct ErrorOfBlock {
  double square_m2 = 0.0, inertial_m = 0.0, by_stiffness_m = 0.0;
};

double minus_log_likelihood(const std::vector<ErrorOfBlock>& errors, double calm_m,
                            const UnknownShares& shares) {
  double sum = 0.0;
  for (const ErrorOfBlock& e : errors) {
    const double variance = calm_m * calm_m + std::pow(shares.inertia * e.inertial_m, 2) +
                            std::pow(shares.stiffness * e.by_stiffness_m, 2);
    sum += 0.5 * std::log(variance) +
           0.5 * (kPolicy.motion.degrees_of_freedom + 1.0) *
               std::log1p(e.square_m2 / (kPolicy.motion.degrees_of_freedom * variance));
  }
  return sum;
}

/// Of the likeliest shares.
double least_minus_log_likelihood(const std::vector<ErrorOfBlock>& errors) {
  double least = std::numeric_limits<double>::infinity();
  if (errors.empty()) return least;
  std::vector<double> squares;
  for (const ErrorOfBlock& e : errors) squares.push_back(e.square_m2);
  const double median_m = std::sqrt(math::median(std::move(squares)));
  for (const double calm : kPolicy.motion.calm_errors) {
    for (const double inertia : kPolicy.motion.shares) {
      for (const double stiffness : kPolicy.motion.stiffness_shares)
        least = std::min(least, minus_log_likelihood(errors, calm * median_m, {inertia, stiffness}));
    }
  }
  return least;
}

}  // namespace

const model::Modes* JointModel::modes_at(std::size_t trial, std::size_t block) const {
  return modes_.empty() ? nullptr : modes_[trial][block].get();
}

/// What inertia did, as far as it lasts: all of it, as if nothing of it were known.
std::vector<double> JointModel::inertial_m(std::size_t trial, const std::vector<Predicted>& predicted) const {
  std::vector<double> list;
  double lasting_m = 0.0;
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    const Predicted& now = predicted[k];
    lasting_m *=
        now.instant.dt_s > 0.0 ? std::exp(-now.instant.dt_s * decay_of(modes_at(trial, k), now)) : 0.0;
    if (trials_[trial].blocks[k].set_aside)
      lasting_m = 0.0;  // a hand held the arm
    else if (now.solved)
      lasting_m = std::max(lasting_m, now.inertial_m);
    list.push_back(lasting_m);
  }
  return list;
}

/// Minus the logarithm of the likelihood of the arm's motion.
double JointModel::unlikeliness(const std::vector<std::vector<Predicted>>& predicted) const {
  std::vector<ErrorOfBlock> errors;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const std::vector<double> inertial = inertial_m(t, predicted[t]);
    for (std::size_t k = 0; k < predicted[t].size(); ++k) {
      const std::vector<Seen>& bodies = trials_[t].blocks[k].bodies;
      if (!used_[t][k] || !predicted[t][k].solved || bodies.empty()) continue;
      ErrorOfBlock e{0.0, inertial[k],
                     modes_.empty() ? 0.0 : by_stiffness_m(modes_at(t, k), predicted[t][k])};
      for (std::size_t i = 0; i < bodies.size(); ++i)
        e.square_m2 += (bodies[i].p_base - predicted[t][k].p.col(static_cast<Index>(i))).squaredNorm() /
                       (3.0 * static_cast<double>(bodies.size()));
      errors.push_back(e);
    }
  }
  // Neighbouring errors are one: those of a stretch count once.
  double span_s = 0.0;
  for (const TrialData& trial : trials_)
    span_s += trial.series.t_s[trial.series.t_s.size() - 1] - trial.series.t_s[0];
  const double stretches = std::max(1.0, span_s / kPolicy.fit.stretch_s),
               blocks = std::max(stretches, static_cast<double>(errors.size()));
  return stretches / blocks * least_minus_log_likelihood(errors);
}

/// A trial's unknown motion: shares of what inertia does and of the stiffness, and what a hand left.
void JointModel::find_swings(std::size_t trial, const std::vector<Predicted>& predicted, bool seen) {
  const TrialData& data = trials_[trial];
  std::vector<double>& sd_m = motion_sd_m_[trial];
  const std::vector<double> inertial = inertial_m(trial, predicted);
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    sd_m[k] = unknown_.inertia * inertial[k];
    if (!modes_.empty() && predicted[k].solved && !data.blocks[k].set_aside)
      sd_m[k] = std::hypot(sd_m[k], unknown_.stiffness * by_stiffness_m(modes_at(trial, k), predicted[k]));
  }
  if (!seen || modes_.empty()) return;
  std::vector<VectorXd>& left = swings_[trial];
  left.assign(predicted.size(), {});
  for (const FreeSwing& swing : free_swings(modes_[trial], data, predicted, noise_m(arm_))) {
    const KnownSwing known = known_of(swing, *modes_[trial][swing.first], data, predicted);
    for (std::size_t i = 0; i < known.sd_m.size(); ++i) {
      const std::size_t k = swing.first + i;
      left[k] = known.displacement[i];
      sd_m[k] = std::hypot(sd_m[k], std::hypot(known.sd_m[i], unknown_.inertia * most_m(left[k])));
    }
  }
}

void JointModel::find_modes(const JointParameters& parameters,
                            const std::vector<std::vector<Predicted>>& predicted) {
  const arm::Arm arm = arm_with(parameters.constants);
  std::vector<model::TrialModes> found(trials_.size());
  each_trial([&](std::size_t t) {
    found[t] =
        models_[t].modes(arm, all(parameters.effects), dynamics(parameters, t), trials_[t], predicted[t]);
  });
  modes_ = std::move(found);
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
  each_trial([&](std::size_t t) {
    models_[t].predict(arm, all(parameters.effects), {false, parameters.viscoelastic_lag_s}, trials_[t],
                       &swinging[t], still[t]);
  });
  double rows = 0.0;
  const double with = chi2(swinging, rows), without = chi2(still, rows);
  return without < kPolicy.verdict.as_noise_chi2 * rows && with - without > kPolicy.motion.no_inertia_chi2;
}

/// Modes are no better than the masses and the damping that make them: of arms in which those are guessed,
/// the motion to first order may be likelier. The shares are those of arms that are known well: what else
/// moving arms are off by is what the diagnosis looks for.
void JointModel::choose_motion(const JointParameters& parameters,
                               std::vector<std::vector<Predicted>>& predicted) {
  const double in_modes = unlikeliness(predicted);
  std::vector<model::TrialModes> modes = std::move(modes_);
  modes_.clear();
  std::vector<std::vector<Predicted>> first_order;
  predict(parameters, &predicted, first_order);
  if (unlikeliness(first_order) - in_modes < kPolicy.motion.modes_gain)
    predicted = std::move(first_order);
  else
    modes_ = std::move(modes);
}

void JointModel::move_alike(const JointModel& other, const JointParameters& parameters,
                            std::vector<std::vector<Predicted>>& predicted) {
  quasi_static_ = other.quasi_static_;
  if (other.swings()) return;
  modes_.clear();
  predict(parameters, &predicted, predicted);
}

std::size_t JointModel::allow_for_motion(const JointParameters& parameters,
                                         std::vector<std::vector<Predicted>>& predicted,
                                         const JointModel* alike) {
  const bool seen = alike == nullptr;
  find_modes(parameters, predicted);
  predict(parameters, &predicted, predicted);
  if (!seen) {
    move_alike(*alike, parameters, predicted);
  } else if (is_quasi_static(parameters, predicted)) {
    quasi_static_ = true;
    modes_.clear();
    predict(parameters, &predicted, predicted);
  } else {
    choose_motion(parameters, predicted);
  }
  if (quasi_static_) return 0;
  if (!swings()) unknown_.inertia = kPolicy.motion.first_order_share;
  swings_.resize(trials_.size());
  each_trial([&](std::size_t t) { find_swings(t, predicted[t], seen); });
  // What is not known of a swing spoils what is smaller than it is. Beside a model that is off by more,
  // little would be won, and of an arm that never rests nearly everything lost.
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    add_swings(t, predicted[t]);
    const std::vector<Block>& blocks = trials_[t].blocks;
    for (std::size_t k = 0; k < blocks.size() && seen; ++k) {
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
