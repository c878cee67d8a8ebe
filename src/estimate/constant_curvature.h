// Constant-curvature baselines in closed form.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "problem.h"

namespace softarm::estimate {

/// Parameters of the unique chain of arcs through the given bodies, one at the end of each segment
/// (cc_endpoint). Each arc starts along the end of the one before.
Eigen::VectorXd constant_curvature_through(const arm::Arm& arm, const Problem& problem,
                                           const std::vector<int>& end_bodies);

/// Tip orientation of the chain of arcs with these parameters.
Eigen::Quaterniond constant_curvature_tip(const Problem& problem, const Eigen::VectorXd& x);

}  // namespace softarm::estimate
