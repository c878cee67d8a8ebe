// Where inputs bend the arm, by the arm file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "softarm/arm/arm.h"

namespace softarm::check {

/// Towards where an input bends the arm as it grows: a unit vector across the rod at its base; nothing where
/// it bends none, or several segments apart.
/// @param segments from the base that are looked at
std::optional<Eigen::Vector2d> bending_direction(const arm::Arm& arm, const std::string& input,
                                                 std::size_t segments);

}  // namespace softarm::check
