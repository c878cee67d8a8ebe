// Centres of marker clusters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "arm_chain.h"

namespace softarm::trial {

/// Every circle of about this radius that passes through at least three points, each once.
/// @param points mocap frame, m
/// @param markers how many points a circle has at most
/// @param kind what to write into the places
std::vector<Place> clusters_through(const std::vector<Eigen::Vector3d>& points, int markers, double radius_m,
                                    int kind);

}  // namespace softarm::trial
