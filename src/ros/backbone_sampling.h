// The backbone of an estimate between its points.
#pragma once

#include <vector>

#include "softarm/estimate/estimator.h"

namespace softarm {

/// The backbone at an arclength (m, of the arm at zero input; held to the ends): cubic Hermite through the
/// points with their tangents, attitude by slerp, curvature linear.
/// @pre at least one point, ordered by arclength
estimate::BackbonePoint backbone_at(const std::vector<estimate::BackbonePoint>& backbone, double arclength_m);

/// The backbone at `count` equidistant arclengths, ends included.
/// @pre count >= 2, backbone not empty
std::vector<estimate::BackbonePoint> resample_backbone(const std::vector<estimate::BackbonePoint>& backbone,
                                                       int count);

}  // namespace softarm
