// The constants of a segment itself: its stiffness without input, its length and its shape at rest.
#include <algorithm>

#include "constant_spec.h"

namespace softarm::arm {
namespace {

constexpr double kLengthThatMatters = 0.04;  // of the length
constexpr double kShareThatMatters = 0.1;    // of what the laws say, that comes late
constexpr double kJointThatMatters = 0.1;    // of what the segment itself turns by under a moment at its end

int one_of(const Segment&) {
  return 1;
}

bool held_by_default(const Segment&) {
  return false;
}

std::string rest_advice(const Segment&, int, const RecordedInputs&) {
  return "record the arm at rest, without any input";
}

ConstantSpec base_stiffness() {
  ConstantSpec c{ConstantKind::kBendingStiffness, ConstantRole::kBendingStiffness, "bending_stiffness.base",
                 "N m^2"};
  c.count = [](const Segment& s) { return s.bending_stiffness.by_pressure.empty() ? 1 : 0; };
  c.value = [](const Segment& s, int) { return s.bending_stiffness.base_nm2; };
  c.set = [](Segment& s, int, double value) { s.bending_stiffness.base_nm2 = value; };
  c.allowed = [](const Segment& s, int) {
    return Range{std::max(1e-6, s.bending_stiffness_range_nm2.low),
                 std::min(1e3, s.bending_stiffness_range_nm2.high)};
  };
  c.change = [](const Segment& s, int, const InputReader&, Change& change) {
    change.drive.base_stiffness_nm2 = s.bending_stiffness.by_pressure.empty() ? 1.0 : 0.0;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) { return 0.1 * unloaded_stiffness_nm2(s); };
  c.advice = [](const Segment&, int, const RecordedInputs& recorded) { return recorded.load_advice(); };
  return c;
}

ConstantSpec joint_compliance() {
  ConstantSpec c{ConstantKind::kJointCompliance, ConstantRole::kJoint, "joint_compliance", "rad/(N m)"};
  c.moves = kMovesJoint;
  c.count = one_of;
  c.stated = [](const Segment& s, int) { return s.joint_compliance_rad_per_nm.has_value(); };
  c.value = [](const Segment& s, int) { return s.joint_compliance_rad_per_nm.value_or(0.0); };
  c.set = [](Segment& s, int, double value) { s.joint_compliance_rad_per_nm = value; };
  c.allowed = [](const Segment&, int) { return Range{0.0, 100.0}; };
  c.change = [](const Segment&, int, const InputReader&, Change& change) {
    change.joint_compliance_rad_per_nm = 1.0;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) {
    return kJointThatMatters * s.length_m / unloaded_stiffness_nm2(s);
  };
  c.advice = [](const Segment&, int, const RecordedInputs& recorded) {
    return "the joint turns by the moment of weights alone: " + recorded.load_advice();
  };
  return c;
}

std::string wall_advice(const Segment&, int, const RecordedInputs&) {
  return "change the inputs in steps and hold them for some times as long as the wall creeps, without "
         "leaving "
         "frames out";
}

const std::vector<WallElement>& elements_of(const Segment& s, bool axial) {
  return axial ? s.wall.axial : s.wall.bending;
}

/// What is common to time and share of an element.
template <bool kAxial>
ConstantSpec wall_element(ConstantKind kind, const char* name, const char* unit) {
  ConstantSpec c{kind, ConstantRole::kWall, name, unit};
  c.count = [](const Segment& s) { return static_cast<int>(elements_of(s, kAxial).size()); };
  c.change = [](const Segment&, int, const InputReader&, Change&) { return true; };
  c.advice = wall_advice;
  return c;
}

template <bool kAxial>
WallElement& element_at(Segment& s, int i) {
  return (kAxial ? s.wall.axial : s.wall.bending)[static_cast<std::size_t>(i)];
}

template <bool kAxial>
int element_number(const Segment& s, int i) {
  return kAxial ? static_cast<int>(s.wall.bending.size()) + i : i;
}

template <bool kAxial>
ConstantSpec wall_time(ConstantKind kind, const char* name) {
  ConstantSpec c = wall_element<kAxial>(kind, name, "s");
  c.value = [](const Segment& s, int i) {
    return elements_of(s, kAxial)[static_cast<std::size_t>(i)].time_s;
  };
  c.set = [](Segment& s, int i, double value) { element_at<kAxial>(s, i).time_s = value; };
  c.allowed = [](const Segment&, int) { return Range{kLeastWallTime_s, kMostWallTime_s}; };
  c.wall = [](const Segment& s, int i) {
    return WallChange{element_number<kAxial>(s, i), 1.0, 0.0, 0.0, 0.0};
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs&) {
    return 0.5 * elements_of(s, kAxial)[static_cast<std::size_t>(i)].time_s;
  };
  return c;
}

template <bool kAxial>
ConstantSpec wall_share(ConstantKind kind, const char* name) {
  ConstantSpec c = wall_element<kAxial>(kind, name, "1");
  c.value = [](const Segment& s, int i) { return elements_of(s, kAxial)[static_cast<std::size_t>(i)].share; };
  c.set = [](Segment& s, int i, double value) { element_at<kAxial>(s, i).share = value; };
  // Each may grow by its part of what the shares leave, so that they never take all.
  c.allowed = [](const Segment& s, int i) {
    const std::vector<WallElement>& all = elements_of(s, kAxial);
    double sum = 0.0;
    for (const WallElement& e : all) sum += e.share;
    return Range{0.0, all[static_cast<std::size_t>(i)].share +
                          std::max(0.0, kMostWallShare - sum) / static_cast<double>(all.size())};
  };
  c.wall = [](const Segment& s, int i) {
    return WallChange{element_number<kAxial>(s, i), 0.0, 1.0, 0.0, 0.0};
  };
  c.scale = [](const Segment&, int, const RecordedInputs&) { return kShareThatMatters; };
  return c;
}

/// What of the wall goes with pressure: `kSlope` per mean gauge pressure.
template <std::optional<double> Wall::*kSlope>
ConstantSpec wall_by_pressure(ConstantKind kind, const char* name) {
  ConstantSpec c{kind, ConstantRole::kWall, name, "1/Pa"};
  c.count = [](const Segment& s) { return s.wall.empty() ? 0 : 1; };
  c.stated = [](const Segment& s, int) { return (s.wall.*kSlope).has_value(); };
  c.value = [](const Segment& s, int) { return (s.wall.*kSlope).value_or(0.0); };
  c.set = [](Segment& s, int, double value) { s.wall.*kSlope = value; };
  c.allowed = [](const Segment&, int) { return Range{0.0, 0.001}; };
  c.change = [](const Segment&, int, const InputReader&, Change&) { return true; };
  c.wall = [](const Segment&, int) {
    constexpr bool kSlows = kSlope == &Wall::slows_per_pa;
    return WallChange{-1, 0.0, 0.0, kSlows ? 1.0 : 0.0, kSlows ? 0.0 : 1.0};
  };
  c.scale = [](const Segment&, int, const RecordedInputs&) { return 0.5 / kUsualPressure_pa; };
  c.advice = wall_advice;
  return c;
}

ConstantSpec axial_stiffness() {
  ConstantSpec c{ConstantKind::kAxialStiffness, ConstantRole::kAxialStiffness, "axial_stiffness", "N"};
  c.moves = kMovesModulus;
  c.count = [](const Segment& s) { return s.axial_stiffness_n ? 1 : 0; };
  c.free_by_default = strained_by_inputs;
  c.value = [](const Segment& s, int) { return *s.axial_stiffness_n; };
  c.set = [](Segment& s, int, double value) { s.axial_stiffness_n = value; };
  c.allowed = [](const Segment&, int) { return Range{0.1, 1e8}; };
  c.change = [](const Segment&, int, const InputReader&, Change& change) {
    change.axial_stiffness_n = 1.0;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) {
    return 0.1 * s.axial_stiffness_n.value_or(1.0);
  };
  c.advice = [](const Segment&, int, const RecordedInputs&) -> std::string {
    return "the arm is strained too little along its axis: record trials with higher central pressure or "
           "tension, or a heavier payload";
  };
  return c;
}

ConstantSpec length() {
  ConstantSpec c{ConstantKind::kLength, ConstantRole::kOther, "length", "m"};
  c.count = one_of;
  c.free_by_default = held_by_default;
  c.value = [](const Segment& s, int) { return s.length_m; };
  c.set = [](Segment& s, int, double value) { s.length_m = value; };
  c.allowed = [](const Segment& s, int) {
    if (s.length_range_m.high > s.length_range_m.low) return s.length_range_m;
    return Range{0.7 * s.length_m, 1.5 * s.length_m};
  };
  c.change = [](const Segment&, int, const InputReader&, Change& change) {
    change.drive.length_m = 1.0;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) { return kLengthThatMatters * s.length_m; };
  c.advice = rest_advice;
  return c;
}

template <int kAxis>
ConstantSpec rest_curvature(ConstantKind kind, const char* name) {
  ConstantSpec c{kind, ConstantRole::kOther, name, "1/m"};
  c.moves = kAxis == 0 ? kMovesRestX : kMovesRestY;
  c.count = one_of;
  c.free_by_default = held_by_default;
  c.value = [](const Segment& s, int) { return s.rest_curvature_per_m[kAxis]; };
  c.set = [](Segment& s, int, double value) { s.rest_curvature_per_m[kAxis] = value; };
  c.allowed = [](const Segment&, int) { return Range{-200.0, 200.0}; };
  c.change = [](const Segment&, int, const InputReader&, Change& change) {
    change.rest_curvature_per_m[kAxis] = 1.0;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) { return kBendThatMatters_rad / s.length_m; };
  c.advice = rest_advice;
  return c;
}

}  // namespace

const std::vector<ConstantSpec>& segment_constants() {
  static const std::vector<ConstantSpec> list{
      base_stiffness(),
      joint_compliance(),
      wall_time<false>(ConstantKind::kWallBendingTime, "wall.bending_{}.time"),
      wall_share<false>(ConstantKind::kWallBendingShare, "wall.bending_{}.share"),
      wall_time<true>(ConstantKind::kWallAxialTime, "wall.axial_{}.time"),
      wall_share<true>(ConstantKind::kWallAxialShare, "wall.axial_{}.share"),
      wall_by_pressure<&Wall::slows_per_pa>(ConstantKind::kWallSlowing, "wall.slowing"),
      wall_by_pressure<&Wall::shares_grow_per_pa>(ConstantKind::kWallShareGrowth, "wall.share_growth"),
      axial_stiffness(),
      length(),
      rest_curvature<0>(ConstantKind::kRestCurvatureX, "rest_curvature.x"),
      rest_curvature<1>(ConstantKind::kRestCurvatureY, "rest_curvature.y")};
  return list;
}

double unloaded_stiffness_nm2(const Segment& segment) {
  const StiffnessLaw& law = segment.bending_stiffness;
  return law.by_pressure.empty() ? law.base_nm2 : law.by_pressure.front().bending_stiffness_nm2;
}

}  // namespace softarm::arm
