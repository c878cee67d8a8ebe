// What a moving arm does as if gravity were another.
#pragma once

#include <algorithm>

namespace softarm::model {

/// What at the tip, without any weight along the arm, would bend it as much, kg.
/// @param own_kg of the arm, evenly along it
/// @param end_kg at the tip
inline double bending_load(double own_kg, double end_kg) {
  constexpr double kSag = 1.0 / 3.0;
  return kSag * own_kg + end_kg;
}

/// An arm whose tip is accelerated by a bends as if at rest under a gravity that is less by this share of a:
/// the share of what its generalised inertia is to what gravity does to it, in a motion that grows with the
/// square of the arclength.
/// @param own_kg of the arm, evenly along it
/// @param end_kg at the tip
inline double inertia_over_weight(double own_kg, double end_kg) {
  constexpr double kSwing = 1.0 / 5.0;
  return (kSwing * own_kg + end_kg) / std::max(1e-12, bending_load(own_kg, end_kg));
}

}  // namespace softarm::model
