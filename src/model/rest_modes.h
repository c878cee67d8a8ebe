// The modes of vibration of an arm about where it rests at no input.
#pragma once

#include <optional>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "vibration.h"

namespace softarm::model {

/// By the arm's laws at inputs of 0, the gravity of its fixed base (else of a base that stands upright), its
/// masses and this payload.
/// @return nothing where it has no stable rest there
std::optional<Modes> modes_at_no_input(const arm::Arm& arm, double payload_kg, int count);

/// By these values of the segments, under a gravity in the rod's base frame.
/// @return as above
std::optional<Modes> modes_at(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& segments,
                              double payload_kg, const Eigen::Vector3d& gravity_base, int count);

}  // namespace softarm::model
