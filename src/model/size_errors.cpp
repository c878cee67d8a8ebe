#include "size_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::model {
namespace {

const double kAnywhere = 1.0 / std::sqrt(12.0);  // sd of a number that may be anywhere, over its range
constexpr double kLeastRoom = 0.1;               // of a standard deviation, for a difference to be one

/// The end of a number's range on an arm.
double high_of(const Parameter& parameter, const arm::Arm& arm) {
  return parameter.along ? std::min(parameter.high, arm.total_length_m()) : parameter.high;
}

/// By how much a number is moved for one standard deviation's difference; 0: it cannot be.
double step_of(double low, double high, double value, double sd) {
  const double above = high - value, below = value - low;
  const double side = above >= sd || above >= below ? 1.0 : -1.0;
  const double step = std::min(sd, side > 0.0 ? above : below);
  return step >= kLeastRoom * sd ? side * step : 0.0;
}

}  // namespace

SizeErrors::SizeErrors(const arm::Arm& arm, std::vector<Present> effects)
    : arm_(arm), effects_(in_order(std::move(effects))) {
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    const Present& present = effects_[e];
    const std::vector<Parameter>& parameters = present.effect->info().parameters;
    for (Eigen::Index k = 0; k < present.sd.size(); ++k) {
      const Parameter& parameter = parameters[static_cast<std::size_t>(k)];
      if (parameter.counts || !(present.sd[k] > 0.0)) continue;
      const double low = parameter.low, high = high_of(parameter, arm_);
      const double sd = std::min(present.sd[k], kAnywhere * (high - low));
      const double step = step_of(low, high, present.values[k], sd);
      if (step == 0.0) continue;
      std::vector<Present> others = effects_;
      others[e].values[k] += step;
      numbers_.push_back({e, k, sd, sd / step, others, Memories(others)});
    }
  }
}

std::vector<Present> SizeErrors::leaning(const Eigen::VectorXd& by_sd) const {
  std::vector<Present> effects = effects_;
  for (int k = 0; k < count(); ++k) {
    const Number& number = at(k);
    Present& present = effects[number.effect];
    const Parameter& parameter =
        present.effect->info().parameters[static_cast<std::size_t>(number.parameter)];
    double& value = present.values[number.parameter];
    value = std::clamp(value + by_sd[k] * number.sd, parameter.low, high_of(parameter, arm_));
  }
  return effects;
}

void SizeErrors::rest() {
  for (Number& number : numbers_) number.memories.rest();
}

void SizeErrors::drive(const Series& undriven) {
  for (Number& number : numbers_) {
    Series series = undriven;
    model::drive(arm_, number.effects, series);
    number.inputs = series.inputs.rightCols<1>();
    number.moment_inputs = series.moment_inputs.rightCols<1>();
    number.payload_kg = series.payload_kg[series.payload_kg.size() - 1];
  }
}

void SizeErrors::remember(const FineRod& fine, const Instant& instant, const Shape& shape) {
  for (Number& number : numbers_) number.memories.remember(arm_, fine, instant, shape);
}

void SizeErrors::drive(int k, Instant& instant) const {
  instant.inputs = at(k).inputs;
  instant.moment_inputs = at(k).moment_inputs;
  instant.payload_kg = at(k).payload_kg;
}

}  // namespace softarm::model
