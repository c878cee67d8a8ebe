// How far a joint model's predictions lie from what was seen, and how far a fit may go towards what was
// expected.
#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include "joint_model.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::VectorXd;
using model::Block;
using model::Predicted;

constexpr double kNoWorse = 1.02;  // of the loss: what priors and rounding make of a step that does nothing
constexpr int kShorterWays = 8;    // half, a quarter, ... of where a fit was expected

/// A share of the way from one set of parameters to another, which may have effects more.
JointParameters between(const JointParameters& from, const JointParameters& to, double share) {
  JointParameters p = to;
  p.constants = from.constants + share * (to.constants - from.constants);
  p.viscoelastic_lag_s = from.viscoelastic_lag_s + share * (to.viscoelastic_lag_s - from.viscoelastic_lag_s);
  p.mounts = from.mounts + share * (to.mounts - from.mounts);
  for (std::size_t e = 0; e < p.effects.size(); ++e) {
    auto& values = p.effects[e].values;
    if (e < from.effects.size())
      values = from.effects[e].values + share * (values - from.effects[e].values);
    else
      values.head(p.effects[e].effect->info().sizes) *= share;
  }
  return p;
}

}  // namespace

double huber_weight(double distance, double threshold) {
  return distance <= threshold ? 1.0 : threshold / distance;
}

double huber_threshold(std::vector<double> distances) {
  return kPolicy.fit.huber * std::max(1.0, math::median(std::move(distances)) / math::kMedianOfChi3) *
         math::kMedianOfChi3;
}

double JointModel::threshold_at(const std::vector<std::vector<Predicted>>& predicted) const {
  std::vector<double> distances;
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const VectorXd r = residual(t, predicted[t]);
    for (Eigen::Index i = 0; i < r.size(); i += 3) {
      const double d = r.segment<3>(i).norm();
      if (d > 0.0) distances.push_back(d);
    }
  }
  return distances.empty() ? threshold_ : huber_threshold(std::move(distances));
}

/// Huber's loss of a trial's bodies that count; those without an equilibrium are as far off as a fit has
/// them.
double JointModel::loss(std::size_t trial, const std::vector<Predicted>& predicted, double threshold) const {
  const ceres::HuberLoss huber(threshold);
  const VectorXd r = residual(trial, predicted);
  double sum = 0.0;
  Eigen::Index row = 0;
  const auto add = [&](std::size_t block, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i, row += 3) {
      if (!used_[trial][block]) continue;
      const double square =
          predicted[block].solved ? r.segment<3>(row).squaredNorm() : std::pow(kUnsolved * threshold, 2);
      double rho[3];
      huber.Evaluate(square, rho);
      sum += rho[0];
    }
  };
  const std::vector<Block>& blocks = trials_[trial].blocks;
  for (std::size_t k = 0; k < blocks.size(); ++k) add(k, blocks[k].bodies.size());
  for (std::size_t k = 0; k < blocks.size(); ++k) add(k, blocks[k].tangents.size());
  return sum;
}

double JointModel::loss(const std::vector<std::vector<Predicted>>& predicted, double threshold) const {
  double sum = 0.0;
  for (std::size_t t = 0; t < trials_.size(); ++t) sum += loss(t, predicted[t], threshold);
  return sum;
}

/// Predictions that are only wanted where their loss is no more than so much: where equilibria are hard to
/// find they take long.
/// @param out without any equilibrium where it is more
/// @return whether it is not
bool JointModel::predict_within(const JointParameters& parameters,
                                const std::vector<std::vector<Predicted>>& start, double threshold,
                                double most, std::vector<std::vector<Predicted>>& out) {
  std::vector<std::vector<Predicted>> made(trials_.size());
  std::mutex mutex;
  double sum = 0.0;
  std::atomic<bool> within{true};
  each_trial([&](std::size_t t) {
    if (looks_at(t) && within) {
      made[t] = predict_trial(parameters, t, &start[t]);
      const double of_trial = loss(t, made[t], threshold);
      const std::lock_guard<std::mutex> lock(mutex);
      sum += of_trial;
      if (sum > most) within = false;
    }
  });
  for (std::size_t t = 0; t < trials_.size(); ++t)
    if (!within || !looks_at(t)) made[t].assign(trials_[t].blocks.size(), {});
  out = std::move(made);
  return within;
}

/// What is expected to first order may overshoot by far where an arm bends much: goes as far as it makes
/// nothing worse.
/// @return whether less than all of the way was gone
bool JointModel::go_as_far_as_it_helps(const Linearised& from, JointParameters& parameters,
                                       std::vector<std::vector<Predicted>>& predicted) {
  const double threshold = threshold_at(from.predicted);
  const double most = kNoWorse * loss(from.predicted, threshold);
  const JointParameters all = parameters;
  double share = 1.0;
  for (int i = 0; !predict_within(parameters, from.predicted, threshold, most, predicted); ++i) {
    if (i == kShorterWays) {
      predict(parameters, &from.predicted, predicted);
      break;
    }
    share *= 0.5;
    parameters = between(from.at, all, share);
  }
  return share < 1.0;
}

}  // namespace softarm::diagnose
