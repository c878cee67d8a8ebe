#include "resamples.h"

#include <algorithm>
#include <cstdint>
#include <random>

#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;

constexpr Index kResamples = 500;  // a probability to two percent
constexpr std::uint64_t kSeed = 1;

}  // namespace

Eigen::MatrixXd bootstrap_weights(std::size_t units) {
  std::mt19937_64 random(kSeed);
  std::exponential_distribution<double> exponential;
  Eigen::MatrixXd weights(static_cast<Index>(units), kResamples);
  for (Index b = 0; b < kResamples; ++b) {
    for (Index u = 0; u < weights.rows(); ++u) weights(u, b) = exponential(random);
    weights.col(b) *= static_cast<double>(units) / weights.col(b).sum();
  }
  return weights;
}

std::vector<std::size_t> resampled_units(const std::vector<std::size_t>& trial) {
  std::vector<std::size_t> begins;  // of trials, then the end
  for (std::size_t i = 0; i < trial.size(); ++i)
    if (i == 0 || trial[i] != trial[i - 1]) begins.push_back(i);
  const std::size_t trials = begins.size();
  begins.push_back(trial.size());
  const std::size_t fewest = kPolicy.posterior.fewest_units;
  const std::size_t pieces = trials == 0 ? 0 : (fewest + trials - 1) / trials;
  std::vector<std::size_t> units;
  for (std::size_t t = 0; t < trials; ++t) {
    const std::size_t length = begins[t + 1] - begins[t];
    for (std::size_t i = 0; i < length; ++i) units.push_back(t * pieces + i * pieces / length);
  }
  return units;
}

Eigen::VectorXd averaged_over_resamples(const Eigen::VectorXd& log, const Eigen::MatrixXd& by_unit) {
  const Eigen::MatrixXd weights = bootstrap_weights(static_cast<std::size_t>(by_unit.rows()));
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(log.size());
  for (Index b = 0; b < weights.cols(); ++b) {
    const Eigen::VectorXd resampled = log + by_unit.transpose() * (weights.col(b).array() - 1.0).matrix();
    const Eigen::VectorXd share = (resampled.array() - resampled.maxCoeff()).exp();
    sum += share / share.sum();
  }
  return sum / static_cast<double>(weights.cols());
}

}  // namespace softarm::diagnose
