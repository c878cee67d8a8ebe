// Against the arm's geometry: units, order of the bodies, attitude of base and rings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "context.h"
#include "math/statistics.h"
#include "math_of_poses.h"
#include "policy.h"
#include "shape.h"

namespace softarm::check {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr std::size_t kMostPermuted = 7;  // 5040 orders

/// Length of the chain base - bodies in order of arclength, over what the arm file says.
std::optional<double> length_ratio(const std::vector<Place>& places) {
  if (places.empty() || !(places.back().arclength_m > 0.0)) return std::nullopt;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (const Place& place : places) {
    sum += (place.p_base - last).norm();
    last = place.p_base;
  }
  return sum / places.back().arclength_m;
}

/// How badly an order fits: distances of neighbours, against their spacing. order[k] is the body that takes
/// the k-th place.
double misfit(const std::vector<Place>& places, const std::vector<std::size_t>& order) {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double last_s = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Eigen::Vector3d& p = places[order[k]].p_base;
    const double spacing = places[k].arclength_m - last_s, chord = (p - last).norm();
    sum += chord > spacing ? std::pow(chord - spacing, 2) : 0.25 * std::pow(spacing - chord, 2);
    last = p;
    last_s = places[k].arclength_m;
  }
  return sum;
}

/// Twist of a section about its tangent against the base, beside the bending: rad.
double twist_of(const Eigen::Quaterniond& q) {
  return 2.0 * std::atan2(q.z(), q.w());
}

}  // namespace

void check_units(Context& context) {
  const auto ratio = length_ratio(places_in(context, shape_span(context)));
  if (!ratio || (*ratio > 0.6 && *ratio < 1.6)) return;
  struct Unit {
    const char* name;
    double metres;
    const char* remedy;
  };
  constexpr Unit kUnits[] = {{"mm", 1e-3, "mm"}, {"cm", 1e-2, "cm"}, {"m", 1.0, "m"}, {"inch", 0.0254, ""}};
  const double now = context.arm.inputs.bodies.scale_to_m;
  CheckFinding& finding =
      context.add(Severity::kSerious, "length_unit", "",
                  fmt::format("base and bodies lie {:.3g} times as far apart as the arm file says", *ratio));
  finding.figure = *ratio;
  finding.unit = "1";
  for (const Unit& unit : kUnits) {
    const double corrected = *ratio * unit.metres / now;
    if (!(corrected > 0.75 && corrected < 1.35) || unit.metres == now) continue;
    finding.what += fmt::format(": positions are in {}", unit.name);
    finding.remedy = *unit.remedy ? "name the unit of the positions in the arm file"
                                  : "let the driver publish metres; inches cannot be named";
    if (*unit.remedy) finding.setting = fmt::format("inputs.bodies.unit: {}", unit.remedy);
    return;
  }
  finding.remedy =
      "another arm's file, another body's name for the base, or arclengths that are wrong: measure "
      "from the clamp along the backbone";
  finding.setting = "bodies[].arclength_m, base";
}

void check_order(Context& context) {
  const std::vector<Place> places = places_in(context, shape_span(context));
  const auto ratio = length_ratio(places);
  if (places.size() < 2 || places.size() > kMostPermuted || !ratio || *ratio > 20.0 || *ratio < 0.2) return;
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double as_is = misfit(places, order);
  std::vector<std::size_t> best = order;
  double least = as_is;
  while (std::next_permutation(order.begin(), order.end())) {
    const double m = misfit(places, order);
    if (m < least) {
      least = m;
      best = order;
    }
  }
  const double arm_m = places.back().arclength_m;
  if (std::is_sorted(best.begin(), best.end()) || as_is < std::pow(0.08 * arm_m, 2) || least > 0.1 * as_is)
    return;
  std::string is, fits;
  for (std::size_t k = 0; k < best.size(); ++k) {
    is += (k ? ", " : "") + context.tracks[places[k].track].name;
    fits += (k ? ", " : "") + context.tracks[places[best[k]].track].name;
  }
  CheckFinding& finding = context.add(
      Severity::kSerious, "body_order", "",
      fmt::format(
          "from base to tip the arm file has {}, the recording {}: distances of neighbours are off by "
          "{:.0f} mm (rms), in that order by {:.0f} mm",
          is, fits, 1e3 * std::sqrt(as_is / places.size()), 1e3 * std::sqrt(least / places.size())));
  finding.figure = std::sqrt(as_is / places.size());
  finding.unit = "m";
  finding.remedy = "exchange the names in the mocap software, or the arclengths in the arm file";
  finding.setting = "bodies, from base to tip: " + fits;
  // Everything that follows is about places along the arm: with the names as they should be.
  std::vector<Track> renamed(best.size());
  for (std::size_t k = 0; k < best.size(); ++k) renamed[k] = context.tracks[places[best[k]].track];
  for (std::size_t k = 0; k < best.size(); ++k) {
    Track& track = context.tracks[places[k].track];
    track.poses = renamed[k].poses;
  }
}

void check_attitude(Context& context) {
  const std::vector<Place> places = places_in(context, shape_span(context));
  const auto ratio = length_ratio(places);
  if (places.empty() || !ratio || *ratio > 2.0 || *ratio < 0.4) return;
  // The chord to the first body leaves the base at half the bend up to it.
  const double off = angle_between(Eigen::Vector3d::UnitZ(), places.front().p_base);
  const bool near_base = places.front().arclength_m < 0.6 * context.arm.total_length_m();
  const bool backwards = off > 120.0 * kDegree;
  if (off > (near_base ? 50.0 : 80.0) * kDegree) {
    // Which of its two attitudes is the true one nobody knows yet: that has been said.
    if (std::any_of(context.findings.begin(), context.findings.end(), [&](const CheckFinding& f) {
          return f.id == "turned_over" && f.where == context.tracks[0].name;
        }))
      return;
    CheckFinding& finding = context.add(
        Severity::kSerious, backwards ? "base_upside_down" : "base_attitude", context.tracks[0].name,
        fmt::format("the rod's z axis at the base, which should point along the arm, points {:.0f} deg away "
                    "from {}",
                    off / kDegree, context.tracks[places.front().track].name));
    finding.figure = off;
    finding.unit = "rad";
    finding.remedy = backwards
                         ? "the rigid body of a hanging arm has z upwards, the rod's base z along the arm: "
                           "turn it by half a turn"
                         : "turn the rod's base frame so that its z axis is the backbone's tangent there "
                           "(an up axis that was not converted turns it by 90 deg)";
    // The rotation that brings z to the arm, in the body's frame.
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), places.front().p_base);
    const Eigen::Quaterniond q = Eigen::Quaterniond(context.arm.base.rod_in_body.linear()) * turn;
    finding.setting = context.arm.base.body
                          ? fmt::format(
                                "base.rod_in_body.quaternion_xyzw: [{:.3f}, {:.3f}, {:.3f}, {:.3f}], up to "
                                "the bend of the arm at rest and a turn about z",
                                q.x(), q.y(), q.z(), q.w())
                          : "base.fixed.attitude";
    return;
  }
  // Tangents of the rings, against the chord from the body before; and their turn about it.
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Place& place : places) {
    const Track& track = context.tracks[place.track];
    const Eigen::Vector3d chord = place.p_base - last;
    last = place.p_base;
    if (!place.q_base) continue;
    const double tilt = angle_between(*place.q_base * Eigen::Vector3d::UnitZ(), chord);
    const bool usable = track.body->orientation_usable;
    if (tilt > 100.0 * kDegree) {
      CheckFinding& finding = context.add(
          usable ? Severity::kSerious : Severity::kWarning, "tangent_backwards", track.name,
          fmt::format("its z axis, which should be the backbone's tangent towards the tip, points {:.0f} deg "
                      "away from it",
                      tilt / kDegree));
      finding.figure = tilt;
      finding.unit = "rad";
      finding.remedy = usable ? "turn the section in the body's frame"
                              : "its orientation is not used yet; turn the section before it is";
      const Eigen::Quaterniond q = Eigen::Quaterniond(track.body->section_in_body.linear()) *
                                   Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()));
      finding.setting =
          fmt::format("bodies[{}].section_in_body.quaternion_xyzw: [{:.3f}, {:.3f}, {:.3f}, {:.3f}]",
                      track.name, q.x(), q.y(), q.z(), q.w());
    } else if (std::abs(std::remainder(twist_of(*place.q_base), 2.0 * M_PI)) > 150.0 * kDegree) {
      CheckFinding& finding =
          context.add(Severity::kWarning, "turned_about_tangent", track.name,
                      fmt::format("its frame is turned by {:.0f} deg about the backbone against the base",
                                  std::abs(std::remainder(twist_of(*place.q_base), 2.0 * M_PI)) / kDegree));
      finding.figure = std::abs(std::remainder(twist_of(*place.q_base), 2.0 * M_PI));
      finding.unit = "rad";
      finding.remedy =
          "the tangent is right, so estimates of bending suffer no harm; positions do where "
          "section_in_body has an offset across the arm. Look whether the other trials have it too";
      finding.setting =
          fmt::format("bodies[{}].section_in_body.rpy_deg: half a turn about the backbone", track.name);
    }
  }
}

void check_base_moves(Context& context) {
  const Track& base = context.tracks[0];
  if (base.poses.size() < 30) return;
  const double block_s = std::max(0.5, 10.0 * base.period_s);
  std::vector<double> times;
  std::vector<Eigen::Vector3d> places;
  std::vector<std::optional<Eigen::Quaterniond>> attitudes;
  for (double t = base.poses.front().t_s; t + block_s <= base.poses.back().t_s; t += block_s) {
    const auto p = base.mean_position(t, t + block_s);
    if (!p) continue;
    times.push_back(t + 0.5 * block_s);
    places.push_back(*p);
    attitudes.push_back(base.mean_orientation(t, t + block_s));
  }
  if (places.size() < 3) return;
  // Noise of a block's mean, correlated noise included, from neighbours.
  std::vector<double> neighbours_m, neighbours_rad;
  std::size_t step_at = 0;
  double step_m = 0.0, far_m = 0.0, step_rad = 0.0, far_rad = 0.0;
  const auto turn = [&](std::size_t a, std::size_t b) {
    return attitudes[a] && attitudes[b] ? rotation_between(*attitudes[a], *attitudes[b]).norm() : 0.0;
  };
  for (std::size_t i = 1; i < places.size(); ++i) {
    neighbours_m.push_back((places[i] - places[i - 1]).norm());
    neighbours_rad.push_back(turn(i - 1, i));
    far_m = std::max(far_m, (places[i] - places[0]).norm());
    far_rad = std::max(far_rad, turn(0, i));
    if (i < 2) continue;
    // Over two blocks: the step itself may lie within one.
    if ((places[i] - places[i - 2]).norm() > step_m) {
      step_m = (places[i] - places[i - 2]).norm();
      step_at = i - 1;
    }
    step_rad = std::max(step_rad, turn(i - 2, i));
  }
  const double usual_m = math::median(neighbours_m), usual_rad = math::median(neighbours_rad);
  if (far_m < context.of_length(kPolicy.places.base_moves) + 6.0 * usual_m &&
      far_rad < kPolicy.places.base_moves_rad + 6.0 * usual_rad)
    return;
  const bool bumped = step_m > 0.6 * far_m || step_rad > 0.6 * far_rad;
  CheckFinding& finding =
      context.add(far_m > context.of_length(kPolicy.places.base_far) || far_rad > kPolicy.places.base_far_rad
                      ? Severity::kSerious
                      : Severity::kWarning,
                  bumped ? "base_bumped" : "base_drifts", base.name,
                  fmt::format("the mount {} by {:.2g} mm and {:.2g} deg",
                              bumped ? "moves at a blow," : "drifts", 1e3 * far_m, far_rad / kDegree));
  finding.figure = far_m;
  finding.unit = "m";
  if (bumped) finding.spans = {{times[step_at], times[step_at]}};
  finding.remedy =
      "clamp mount and cameras; the shape is taken against the measured base, so what counts is "
      "whether the direction of gravity in the mocap frame changed: if the cameras were bumped, "
      "leave out what comes after";
}

}  // namespace softarm::check
