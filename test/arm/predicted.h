// What the laws make of an arm's first segment.
#pragma once

#include <cmath>
#include <optional>
#include <stdexcept>

#include "softarm/arm/laws.h"

namespace softarm {

constexpr double kDeg = M_PI / 180.0;

inline arm::SegmentPrediction predicted(const arm::Arm& arm, const arm::InputValues& inputs) {
  const std::optional<arm::SegmentPrediction> prediction =
      arm::predict_segment(arm, arm.segments.front(), inputs);
  if (!prediction) throw std::runtime_error("no prediction");
  return *prediction;
}

}  // namespace softarm
