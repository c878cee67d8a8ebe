#include "input_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "math/linear_algebra.h"
#include "math/statistics.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFewestValues = 20;
constexpr double kLongestSpan_s = 1.0;       // of a value's neighbours, two on either side
constexpr double kMedianOfNormal = 0.67449;  // of the size of a standard normal number

/// Weights of the cubic through four stamps at another.
std::array<double, 4> cubic_weights(const std::array<double, 4>& at, double wanted) {
  std::array<double, 4> weights{1.0, 1.0, 1.0, 1.0};
  for (std::size_t j = 0; j < 4; ++j) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (k != j) weights[j] *= (wanted - at[k]) / (at[j] - at[k]);
    }
  }
  return weights;
}

/// Stamps and values of one input: its own, or else those of the frames.
void series_of(const trial::Trial& trial, std::size_t input, std::vector<double>& stamp_s,
               std::vector<double>& value) {
  if (input < trial.inputs.size()) {
    const trial::InputSeries& series = trial.inputs[input];
    for (std::size_t i = 0; i < series.value.size(); ++i) {
      stamp_s.push_back(1e-9 * static_cast<double>(series.stamp_ns[i] - series.stamp_ns.front()));
      value.push_back(series.value[i]);
    }
    return;
  }
  for (const trial::Frame& frame : trial.frames) {
    if (input >= frame.inputs.size() || !frame.inputs[input]) continue;
    stamp_s.push_back(frame.stamp_s());
    value.push_back(*frame.inputs[input]);
  }
}

}  // namespace

double scatter_of(const std::vector<double>& all_stamps_s, const std::vector<double>& all, bool sampled) {
  std::vector<double> stamp_s, value;  // one of each run of the same
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && all[i] == all[i - 1]) continue;
    stamp_s.push_back(all_stamps_s[i]);
    value.push_back(all[i]);
  }
  if (2 * value.size() < all.size() && !sampled) return 0.0;
  if (2 * value.size() >= all.size()) {  // by chance
    stamp_s = all_stamps_s;
    value = all;
  }
  std::vector<double> off;
  for (std::size_t i = 2; i + 2 < value.size(); ++i) {
    const std::array<double, 4> at{stamp_s[i - 2], stamp_s[i - 1], stamp_s[i + 1], stamp_s[i + 2]};
    const bool rising = at[0] < at[1] && at[1] < stamp_s[i] && stamp_s[i] < at[2] && at[2] < at[3];
    if (!rising || at[3] - at[0] > kLongestSpan_s) continue;
    const std::array<double, 4> weights = cubic_weights(at, stamp_s[i]);
    const std::array<double, 4> neighbours{value[i - 2], value[i - 1], value[i + 1], value[i + 2]};
    double expected = 0.0, variance = 1.0;
    for (std::size_t k = 0; k < 4; ++k) {
      expected += weights[k] * neighbours[k];
      variance += weights[k] * weights[k];
    }
    off.push_back(std::abs(value[i] - expected) / std::sqrt(variance));
  }
  return off.size() < kFewestValues ? 0.0 : math::median(off) / kMedianOfNormal;
}

SensorErrors sensor_errors(const arm::Arm& arm, const std::vector<trial::Trial>& trials) {
  const std::vector<arm::ScalarInput>& inputs = arm.inputs.scalars;
  SensorErrors errors;
  errors.noise_sd.setZero(static_cast<Eigen::Index>(trials.size()), static_cast<Eigen::Index>(inputs.size()));
  errors.zero_sd.setZero(static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    errors.zero_sd[column] = inputs[k].zero_sd_si;
    for (std::size_t t = 0; t < trials.size(); ++t) {
      double& sd = errors.noise_sd(static_cast<Eigen::Index>(t), column);
      if (inputs[k].noise_sd_si) {
        sd = *inputs[k].noise_sd_si;
        continue;
      }
      std::vector<double> stamp_s, value;
      series_of(trials[t], k, stamp_s, value);
      sd = scatter_of(stamp_s, value, inputs[k].between == arm::Between::kSampled);
    }
  }
  return errors;
}

FrameInputs::FrameInputs(const trial::StaticFrame& recorded, VectorXd noise_sd, const VectorXd& zero_sd)
    : frame_(recorded),
      noise_sd_(std::move(noise_sd)),
      zero_sd_(zero_sd),
      noise_(VectorXd::Zero(noise_sd_.size())),
      wanted_(noise_),
      zero_(VectorXd::Zero(zero_sd_.size())),
      wanted_zero_(zero_) {
  const auto rows = static_cast<Eigen::Index>(6 * recorded.bodies.size());
  by_noise_.setZero(rows, noise_sd_.size());
  by_zero_.setZero(rows, zero_sd_.size());
  whitening_.setIdentity(rows, rows);
}

void FrameInputs::update(const VectorXd& off, const MatrixXd& by_inputs, double misfit,
                         const VectorXd& zero) {
  by_noise_ = by_inputs * noise_sd_.asDiagonal();
  by_zero_ = -by_inputs * zero_sd_.asDiagonal();
  const VectorXd rho = reduced(off, zero);
  MatrixXd covariance = by_noise_ * by_noise_.transpose() / (misfit * misfit);
  covariance.diagonal().array() += 1.0;
  const math::Eigensystem eigen = math::eigensystem_of(covariance);
  whitening_ =
      eigen.vectors * eigen.values.cwiseSqrt().cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  wanted_ = by_noise_.transpose() * (whitening_ * (whitening_ * rho)) / (misfit * misfit);
  wanted_zero_ = zero;
}

double FrameInputs::step(const trial::StaticFrame& recorded) {
  const double change = noise_.size() > 0 ? (wanted_ - noise_).cwiseAbs().maxCoeff() : 0.0;
  noise_ = wanted_;
  zero_ = wanted_zero_;
  for (std::size_t k = 0; k < recorded.inputs.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!recorded.inputs[k] || i >= noise_.size()) continue;
    frame_.inputs[k] = *recorded.inputs[k] - noise_sd_[i] * noise_[i] - zero_sd_[i] * zero_[i];
  }
  return change;
}

VectorXd FrameInputs::reduced(const VectorXd& off, const VectorXd& zero) const {
  return off + by_noise_ * noise_ + by_zero_ * (zero - zero_);
}

}  // namespace softarm::identify
