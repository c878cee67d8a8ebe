// A tube along the backbone as triangles.
#pragma once

#include <visualization_msgs/Marker.h>

#include <Eigen/Geometry>
#include <vector>

#include "softarm/arm/arm.h"

namespace softarm {

/// One circular section of a tube.
struct TubeSection {
  Eigen::Vector3d p;     ///< centre, m
  Eigen::Quaterniond q;  ///< z along the tube
  double radius_m = 0.0;
  double shade = 0.0;  ///< 0 ... 1 on the colour scale
};

/// Of the segment that has this arclength of the arm at rest, m.
double diameter_at(const arm::Arm& arm, double arclength_m);

/// Appends the surface between the sections, and its two end caps, to a TRIANGLE_LIST.
void add_tube(const std::vector<TubeSection>& sections, float alpha, visualization_msgs::Marker* marker);

/// Colour of a value in 0 ... 1 (held to it): blue, green, yellow, red, of even brightness.
std_msgs::ColorRGBA shade_color(double shade, float alpha);

}  // namespace softarm
