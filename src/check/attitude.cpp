// Attitudes of base and rings against the arm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math_of_poses.h"
#include "policy.h"
#include "settings.h"
#include "shape.h"

namespace softarm::check {
namespace {

/// Turn of a section about its tangent against the base, beside the bending: rad, 0 to pi.
double turn_about_tangent(const Eigen::Quaterniond& q) {
  return std::abs(std::remainder(2.0 * std::atan2(q.z(), q.w()), 2.0 * M_PI));
}

/// @param off angle of the rod's z axis at the base from the chord to the first body
void say_base(Context& context, const Place& first, double off) {
  // Which of its two attitudes is the true one nobody knows yet: that has been said.
  if (std::any_of(context.findings.begin(), context.findings.end(), [&](const CheckFinding& f) {
        return f.id == "turned_over" && f.where == context.tracks[0].name;
      }))
    return;
  const bool backwards = off > kPolicy.geometry.upside_down_rad;
  CheckFinding& finding = context.add(
      backwards ? "base_upside_down" : "base_attitude", context.tracks[0].name,
      fmt::format("the rod's z axis at the base, which should point along the arm, points {:.0f} deg away "
                  "from {}",
                  off / kDegree, context.tracks[first.track].name));
  finding.figure = off;
  finding.unit = "rad";
  finding.remedy = backwards
                       ? "the rigid body of a hanging arm has z upwards, the rod's base z along the arm: "
                         "turn it by half a turn"
                       : "turn the rod's base frame so that its z axis is the backbone's tangent there "
                         "(an up axis that was not converted turns it by 90 deg)";
  // The rotation that brings z to the arm, in the body's frame.
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), first.p_base);
  Eigen::Isometry3d pose = context.arm.base.body ? context.arm.base.rod_in_body : context.arm.base.fixed_pose;
  pose.linear() = (pose.linear() * turn).eval();
  finding.remedy += "; the setting is right up to the bend of the arm at rest and a turn about z";
  finding.setting = (context.arm.base.body ? "base.rod_in_body: " : "base.fixed: ") + pose_value(pose);
}

void say_backwards(Context& context, const Track& track, double tilt) {
  const bool usable = track.body->orientation_usable;
  CheckFinding& finding = context.add(
      usable ? Severity::kSerious : Severity::kWarning, "tangent_backwards", track.name,
      fmt::format("its z axis, which should be the backbone's tangent towards the tip, points {:.0f} deg "
                  "away from it",
                  tilt / kDegree));
  finding.figure = tilt;
  finding.unit = "rad";
  finding.remedy = usable ? "turn the section in the body's frame"
                          : "its orientation is not used yet; turn the section before using it";
  const Eigen::Isometry3d section =
      track.body->section_in_body * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
  finding.setting = fmt::format("bodies[{}].section_in_body: {}", track.name, pose_value(section));
}

void say_turned(Context& context, const Track& track, double turn_rad) {
  CheckFinding& finding =
      context.add("turned_about_tangent", track.name,
                  fmt::format("its frame is turned by {:.0f} deg about the backbone against the base",
                              turn_rad / kDegree));
  finding.figure = turn_rad;
  finding.unit = "rad";
  finding.remedy =
      "the tangent is right, so estimates of bending are not affected; positions are affected where "
      "section_in_body has an offset across the arm. Check whether the other trials show the same";
  const Eigen::Isometry3d section =
      track.body->section_in_body * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  finding.setting = fmt::format("bodies[{}].section_in_body: {}", track.name, pose_value(section));
}

void check_attitude(Context& context) {
  const std::vector<Place> places = shape_in(context, shape_span(context)).places;
  const auto ratio = length_ratio(places);
  if (places.empty() || !ratio || *ratio > kPolicy.geometry.most_attitude ||
      *ratio < kPolicy.geometry.least_attitude)
    return;
  // The chord to the first body leaves the base at half the bend up to it.
  const Place& first = places.front();
  const double off = angle_between(Eigen::Vector3d::UnitZ(), first.p_base);
  const bool near_base = first.arclength_m < kPolicy.geometry.near_base * context.arm.total_length_m();
  if (off > (near_base ? kPolicy.geometry.base_off_rad : kPolicy.geometry.far_base_off_rad)) {
    return say_base(context, first, off);
  }
  // Tangents of the rings, against the chord from the body before; and their turn about it.
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Place& place : places) {
    const Track& track = context.tracks[place.track];
    const Eigen::Vector3d chord = place.p_base - last;
    last = place.p_base;
    if (!place.q_base || track.body->kind != arm::BodyKind::kRing) continue;
    const double tilt = angle_between(*place.q_base * Eigen::Vector3d::UnitZ(), chord);
    const double turn_rad = turn_about_tangent(*place.q_base);
    if (tilt > kPolicy.geometry.backwards_rad) {
      say_backwards(context, track, tilt);
    } else if (turn_rad > kPolicy.geometry.half_turn_rad) {
      say_turned(context, track, turn_rad);
    }
  }
}

}  // namespace

Check make_attitude() {
  return {check_attitude,
          {{"base_upside_down", Severity::kSerious},
           {"base_attitude", Severity::kSerious},
           {"tangent_backwards", {}},
           {"turned_about_tangent", Severity::kWarning}}};
}

}  // namespace softarm::check
