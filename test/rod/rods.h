// Rods for tests.
#pragma once

#include <cmath>

#include "softarm/rod/rod.h"

namespace softarm::rod::testing {

/// A straight, massless rod of one segment along +z with one dead load (index 0) at its tip.
inline rod::Rod plain_rod(double length = 0.2, double bending_stiffness = 0.03) {
  rod::Rod rod;
  rod::Segment segment;
  segment.rest_length_m = segment.length_m = length;
  segment.bending_compliance = 1.0 / bending_stiffness;
  rod.segments.push_back(segment);
  rod::PointLoad tip;
  tip.s_m = length;
  rod.loads.push_back(tip);
  return rod;
}

/// The online paper's arm with everything at once: hanging, weight, payload out of the bending plane,
/// torsion.
inline rod::Rod loaded_arm() {
  rod::Rod rod = plain_rod(0.2, 0.03);
  rod.gravity_m_s2 = {0.0, 0.0, 9.81};
  rod.segments[0].mass_kg = 0.2;
  rod.segments[0].torsional_compliance = 1.0 / 0.025;
  rod.segments[0].moment_nm = {-0.3 * std::sin(0.4), 0.3 * std::cos(0.4), 0.0};
  rod.loads[0].mass_kg = 0.2;
  rod.loads[0].force_n = {0.1, 0.25, -0.05};
  return rod;
}

/// Two segments with different everything, a profile, shear and extension, a load in the middle, a follower
/// at the tip.
inline rod::Rod complicated_rod() {
  rod::Rod rod = loaded_arm();
  rod.gravity_m_s2 = {1.0, -2.0, 9.0};
  rod.q_base = Eigen::Quaterniond(0.9, 0.2, -0.3, 0.1).normalized();
  rod.p_base = {0.4, -0.3, 1.2};
  rod::Segment& first = rod.segments[0];
  first.axial_compliance = 1.0 / 150.0;
  first.shear_compliance = 1.0 / 60.0;
  first.rest_curvature_per_m = {0.5, -1.0, 0.7};
  first.stiffness_profile = {{0.0, 1.3}, {0.4, 0.9}, {1.0, 1.1}};
  first.length_m = 0.207;
  rod::Segment second = first;
  second.rest_length_m = 0.12;
  second.length_m = 0.118;
  second.bending_compliance = 1.0 / 0.02;
  second.moment_nm = {0.05, 0.1, 0.01};
  second.stiffness_profile.clear();
  second.mass_kg = 0.1;
  rod.segments.push_back(second);
  rod.segments[0].anisotropy = {0.2, -0.1};
  rod.segments[1].anisotropy = {-0.3, 0.25};
  rod.loads[0].s_m = 0.15;
  rod.loads[0].offset_m = {0.01, -0.02, 0.005};
  rod::PointLoad follower;
  follower.s_m = 0.32;
  follower.follower = true;
  follower.force_n = {0.3, -0.2, -0.5};
  follower.moment_nm = {0.01, 0.02, -0.015};
  follower.mass_kg = 0.05;
  follower.offset_m = {0.0, 0.015, 0.0};
  rod.loads.push_back(follower);
  return rod;
}

}  // namespace softarm::rod::testing
