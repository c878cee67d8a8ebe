// The bodies at one time, in the frame of the rod's base.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "context.h"

namespace softarm::check {

/// A body's place at rest.
struct Place {
  std::size_t track = 0;
  double arclength_m = 0.0;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();  ///< of the backbone there, in the rod's base frame
  std::optional<Eigen::Quaterniond> q_base;          ///< of the section
};

/// Mean places of all bodies that are seen in a stretch, by arclength; empty without a base. Skin markers are
/// left out: they are not on the backbone.
struct Shape {
  std::vector<Place> places;
  std::vector<Place> far_away;  ///< further from the base than the arm reaches, where most are not
};
Shape shape_in(const Context& context, const CheckSpan& span);

/// Length of the chain base - bodies in order of arclength, over what the arm file says.
std::optional<double> length_ratio(const std::vector<Place>& places);

/// The stretch in which the shape is looked at: rest, else all of the recording's first second.
CheckSpan shape_span(const Context& context);

}  // namespace softarm::check
