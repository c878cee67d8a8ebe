// The semi-physical pressure laws: what the inputs make of a segment (semi-physical paper, (3)-(13)).
#pragma once

#include <optional>
#include <vector>

#include "softarm/arm/arm.h"

namespace softarm {

/// Gauge values of all inputs in the order of Arm::inputs.pressures: chambers as P - ambient, vacuum inputs
/// as ambient - P, both Pa. An input that is not known is absent.
using InputValues = std::vector<std::optional<double>>;

/// What a segment's inputs make of it.
struct SegmentPrediction {
  /// (M0 cos phi, M0 sin phi): phi is the bending direction.
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  double bending_stiffness_nm2 = 0.0;
  double length_m = 0.0;
};

/// Applies length law (3)-(6), stiffness law (7)-(9) and moment law (10)-(13) to one segment. The sign of the
/// third chamber's M_y is that of the geometry (chambers 120 degrees apart), not the printed one. A minimum
/// or a sum of pressures below zero (a sensor's zero error) adds no negative stiffness.
/// @param inputs in the order of Arm::inputs.pressures; a shorter list lacks its last inputs
/// @return nothing where an input that the segment needs is absent or not finite, or where the inputs lie so
/// far outside the laws' validity that no positive length remains. The vacuum is needed only by a segment
/// whose stiffness depends on it.
std::optional<SegmentPrediction> predict_segment(const Arm& arm, const Segment& segment,
                                                 const InputValues& inputs);

}  // namespace softarm
