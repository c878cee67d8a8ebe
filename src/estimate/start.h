// A first guess of a frame's parameters from the measured shape alone.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "problem.h"

namespace softarm::estimate {

struct Start {
  Eigen::VectorXd x;
  Eigen::Quaterniond q_tip = Eigen::Quaterniond::Identity();
};

/// Joins the base and the measured positions by circular arcs, takes lengths and curvatures from them, and
/// attributes to the actuation what is left of the curvature when the loads at the measured places have had
/// their share.
/// @param flexibility c of each segment; where absent it follows from how the curvature follows the load's
/// moment along the segment, if it does
Start start_from_shape(const arm::Arm& arm, const Problem& problem,
                       const std::vector<std::optional<double>>& flexibility, double payload_kg);

}  // namespace softarm::estimate
