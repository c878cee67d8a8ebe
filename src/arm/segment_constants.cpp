// The constants of a segment itself: its stiffness without input, its length and its shape at rest.
#include <algorithm>

#include "constant_spec.h"

namespace softarm::arm {
namespace {

constexpr double kLengthThatMatters = 0.04;  // of the length
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
