// Where inputs bend the arm, by the arm file.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "softarm/arm/arm.h"

namespace softarm::check {

/// Towards where an input bends the arm as it grows: a unit vector across the rod at its base; nothing where
/// it bends none, or several segments apart.
std::optional<Eigen::Vector2d> bending_direction(const arm::Arm& arm, const std::string& input);

}  // namespace softarm::check
