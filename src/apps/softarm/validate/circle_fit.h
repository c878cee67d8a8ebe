// The online paper's baseline: one arc through all points.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace softarm::app::validate {

/// The arc from the origin, along z there, that minimises (7): the sum over points at i L / K of their
/// distance over i. The estimator's cc_points does the same, but has no estimate where the arc lies off by a
/// tenth of the length.
/// @param points measured, rod's base frame
/// @param length_m a guess of L
/// @return the arc's points at i L / K
std::vector<Eigen::Vector3d> fit_circle(const std::vector<Eigen::Vector3d>& points, double length_m);

}  // namespace softarm::app::validate
