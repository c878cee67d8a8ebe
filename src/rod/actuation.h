// What the inputs make of a segment, put into a rod.
#pragma once

#include <Eigen/Core>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/rod.h"

namespace softarm::rod {

/// Lengths, stiffnesses and actuation of one segment of the arm, or of a share of its length.
/// @param actuation_nm moment of all actuation, towards (cos phi, sin phi)
void actuate(const arm::Segment& from, const arm::SegmentPrediction& now, const Eigen::Vector2d& actuation_nm,
             double share, Segment& to);

}  // namespace softarm::rod
