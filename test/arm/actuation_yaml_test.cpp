// The keys of tendons, cables, central chambers and rubber: what is read, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "arm_text.h"

namespace softarm {
namespace {

const std::string kDriven = R"(format: 1
name: driven
base: {body: base}
segments:
  - name: rubber
    length_m: 0.1
    mass_per_length_kg_m: 0.1
    diameter_m: 0.012
    bending_stiffness:
      base_nm2: 0.001
      by_pressure:
        - {pressure_pa: 0, bending_stiffness_nm2: 0.001}
        - {pressure_pa: 1e4, bending_stiffness_nm2: 0.002}
    axial_stiffness_n: 70
    material: {c10_pa: 277000, c01_pa: -209000}
    central_chamber: {input: centre, area_m2: 1e-5}
    tendons:
      - {input: pull, bending_direction_deg: 30, offset_m: 0.004}
    cables:
      - {input: wind, bending_direction_deg: -90, spool_radius_m: 0.02, lever_m: 0.01}
      - {input: count, bending_direction_deg: 45, curvature_gain_per_m_rad: 5}
bodies:
  - {name: ring_1, arclength_m: tip}
inputs:
  pressures:
    - {name: centre, topic: /pressure/chamber_1}
    - {name: jam, topic: /pressure/vacuum, vacuum: true}
  tensions:
    - {name: pull, topic: /tendon/1/tension, unit: mN, zero: 250}
  angles:
    - {name: wind, topic: /servo/1/angle}
    - {name: count, topic: /pwm, type: std_msgs/Float32MultiArray, element: 1, rad_per_unit: -0.002, zero: 1365}
estimator: {unknown: both, window_s: 0.5, prior: {enabled: true}}
)";

TEST(ActuationYaml, EverySegmentKey) {
  const arm::Arm arm = arm::parse_arm(kDriven, "arm.yaml");
  const arm::Segment& segment = arm.segments.at(0);
  ASSERT_EQ(segment.bending_stiffness.by_pressure.size(), 2u);
  EXPECT_EQ(segment.bending_stiffness.by_pressure[1].pressure_pa, 1e4);
  EXPECT_EQ(segment.bending_stiffness.by_pressure[1].bending_stiffness_nm2, 0.002);
  ASSERT_TRUE(segment.material && segment.central_chamber);
  EXPECT_EQ(segment.material->c10_pa, 277e3);
  EXPECT_EQ(segment.material->c01_pa, -209e3);
  EXPECT_EQ(segment.central_chamber->input, "centre");
  EXPECT_EQ(segment.central_chamber->area_m2, 1e-5);
  ASSERT_EQ(segment.tendons.size(), 1u);
  EXPECT_EQ(segment.tendons[0].input, "pull");
  EXPECT_DOUBLE_EQ(segment.tendons[0].bending_direction_rad, M_PI / 6);
  EXPECT_EQ(segment.tendons[0].offset_m, 0.004);
  ASSERT_EQ(segment.cables.size(), 2u);
  EXPECT_EQ(segment.cables[0].input, "wind");
  EXPECT_DOUBLE_EQ(segment.cables[0].bending_direction_rad, -M_PI / 2);
  EXPECT_DOUBLE_EQ(segment.cables[0].curvature_gain_per_m_rad, 20.0);  // 0.02 / (0.1 * 0.01)
  EXPECT_EQ(segment.cables[1].input, "count");
  EXPECT_EQ(segment.cables[1].curvature_gain_per_m_rad, 5.0);
}

TEST(ActuationYaml, NoneIsTheDefault) {
  const arm::Segment segment = arm::parse_arm(kSmallArm, "arm.yaml").segments.at(0);
  EXPECT_FALSE(segment.material || segment.central_chamber);
  EXPECT_TRUE(segment.tendons.empty() && segment.cables.empty());
  EXPECT_TRUE(segment.bending_stiffness.by_pressure.empty());
}

TEST(ActuationYaml, EveryInputKey) {
  const arm::Arm arm = arm::parse_arm(kDriven, "arm.yaml");
  const std::vector<arm::ScalarInput>& inputs = arm.inputs.scalars;
  ASSERT_EQ(inputs.size(), 5u);  // pressures, then tensions, then angles
  EXPECT_EQ(inputs[0].kind, arm::InputKind::kPressure);
  EXPECT_EQ(inputs[1].kind, arm::InputKind::kVacuum);
  const arm::ScalarInput& pull = inputs[2];
  EXPECT_EQ(pull.kind, arm::InputKind::kTension);
  EXPECT_EQ(pull.name, "pull");
  EXPECT_EQ(pull.topic, "/tendon/1/tension");
  EXPECT_EQ(pull.type, "std_msgs/Float64");
  EXPECT_EQ(pull.element, 0);
  EXPECT_DOUBLE_EQ(pull.scale_to_si, 1e-3);
  EXPECT_DOUBLE_EQ(pull.zero_si, 0.25);
  EXPECT_EQ(inputs[3].kind, arm::InputKind::kAngle);
  EXPECT_EQ(inputs[3].type, "std_msgs/Float64");
  EXPECT_EQ(inputs[3].scale_to_si, 1.0);
  EXPECT_EQ(inputs[3].zero_si, 0.0);
  const arm::ScalarInput& count = inputs[4];
  EXPECT_EQ(count.kind, arm::InputKind::kAngle);
  EXPECT_EQ(count.type, "std_msgs/Float32MultiArray");
  EXPECT_EQ(count.element, 1);
  EXPECT_EQ(count.scale_to_si, -0.002);
  EXPECT_DOUBLE_EQ(count.zero_si, -2.73);
  EXPECT_EQ(arm.estimator.unknown, arm::Unknown::kBoth);
  EXPECT_EQ(arm.estimator.window_s, 0.5);
  EXPECT_TRUE(arm.estimator.prior.enabled);
}

TEST(ActuationYaml, Units) {
  const std::pair<const char*, double> tensions[] = {
      {"N", 1}, {"mN", 1e-3}, {"kgf", 9.80665}, {"gf", 9.80665e-3}};
  for (const auto& [word, scale] : tensions) {
    const arm::Arm arm =
        arm::parse_arm(edited(kDriven, "unit: mN", std::string("unit: ") + word), "arm.yaml");
    EXPECT_DOUBLE_EQ(arm.inputs.scalars[2].scale_to_si, scale) << word;
    EXPECT_DOUBLE_EQ(arm.inputs.scalars[2].zero_si, 250 * scale) << word;
  }
  const std::pair<const char*, double> angles[] = {{"rad", 1}, {"deg", M_PI / 180}};
  for (const auto& [word, scale] : angles) {
    const arm::Arm arm = arm::parse_arm(
        edited(kDriven, "topic: /servo/1/angle", std::string("topic: a, zero: 90, unit: ") + word),
        "arm.yaml");
    EXPECT_DOUBLE_EQ(arm.inputs.scalars[3].scale_to_si, scale) << word;
    EXPECT_DOUBLE_EQ(arm.inputs.scalars[3].zero_si, 90 * scale) << word;
  }
}

/// Any way of driving an arm makes a prior possible.
TEST(ActuationYaml, PriorOfEveryKindOfActuation) {
  const std::string passive = edited(edited("    chambers:\n      - {input: chamber_1, "
                                            "bending_direction_deg: 90, moment_gain_nm_per_pa: 6.0e-6}\n",
                                            "DRIVE"),
                                     "estimator: {method: full_points}",
                                     "  tensions: [{name: t, topic: t}]\n  angles: [{name: a, topic: "
                                     "a}]\nestimator: {prior: {enabled: true}}");
  refusal(edited(passive, "DRIVE", ""));
  for (const char* const drive :
       {"    central_chamber: {input: chamber_1, area_m2: 1e-5}\n",
        "    tendons: [{input: t, bending_direction_deg: 0, offset_m: 0.01}]\n",
        "    cables: [{input: a, bending_direction_deg: 0, curvature_gain_per_m_rad: 5}]\n"}) {
    EXPECT_NO_THROW(arm::parse_arm(edited(passive, "DRIVE", drive), "arm.yaml")) << drive;
  }
}

class ActuationYamlRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(ActuationYamlRefuses, WithOneClearLine) {
  const Refusal& c = GetParam();
  EXPECT_EQ(refusal(edited(kDriven, c.from, c.to)), c.message);
}

constexpr char kMaterial[] = "c10_pa: 277000, c01_pa: -209000";
constexpr char kGeared[] = "spool_radius_m: 0.02, lever_m: 0.01";

INSTANTIATE_TEST_SUITE_P(
    Segments, ActuationYamlRefuses,
    ::testing::Values(
        Refusal{"rubber_without_modulus", kMaterial, "c10_pa: 209000, c01_pa: -209000",
                "arm.yaml:15: key 'segments[0].material.c01_pa': value -209000 makes 6 (c10_pa + c01_pa), "
                "the modulus "
                "at rest, 0 Pa; it must be positive"},
        Refusal{"rubber_on_a_rigid_axis", "axial_stiffness_n: 70", "axial_stiffness_n: rigid",
                "arm.yaml:15: key 'segments[0].material.c10_pa': needs the segment's axial_stiffness_n: a "
                "rigid axis "
                "does not stretch the material"},
        Refusal{"rubber_in_mpa_text", "c10_pa: 277000", "c10_pa: 0.277 MPa",
                "arm.yaml:15: key 'segments[0].material.c10_pa': value '0.277 MPa' is not a number in "
                "[-1e+09, 1e+09] "
                "Pa"},
        Refusal{"rubber_of_one_term", kMaterial, "c10_pa: 277000",
                "arm.yaml:15: key 'segments[0].material.c01_pa': is missing; C01; 6 (C10 + C01), the modulus "
                "at rest, "
                "must be positive; allowed: [-1e+09, 1e+09] Pa"},
        Refusal{
            "chamber_in_mm2", "area_m2: 1e-5", "area_m2: 9.6",
            "arm.yaml:16: key 'segments[0].central_chamber.area_m2': value 9.6 is outside the allowed range "
            "[1e-09, 0.1] m^2"},
        Refusal{"chamber_by_vacuum", "input: centre", "input: jam",
                "arm.yaml:16: key 'segments[0].central_chamber.input': value jam is a vacuum input; a "
                "chamber needs a "
                "pressure"},
        Refusal{"chamber_by_tension", "input: centre", "input: pull",
                "arm.yaml:16: key 'segments[0].central_chamber.input': value pull is one of inputs.tensions; "
                "a chamber "
                "needs one of inputs.pressures"},
        Refusal{"tendon_by_pressure", "input: pull", "input: centre",
                "arm.yaml:18: key 'segments[0].tendons[0].input': value centre is one of inputs.pressures; a "
                "tendon "
                "needs one of inputs.tensions"},
        Refusal{
            "tendon_by_nothing", "input: pull", "input: tendon_1",
            "arm.yaml:18: key 'segments[0].tendons[0].input': value tendon_1 is no input of inputs.tensions; "
            "declared: pull"},
        Refusal{"tendon_in_mm", "offset_m: 0.004", "offset_m: 4",
                "arm.yaml:18: key 'segments[0].tendons[0].offset_m': value 4 is outside the allowed range "
                "[0, 0.5] m"},
        Refusal{"cable_by_tension", "input: wind", "input: pull",
                "arm.yaml:20: key 'segments[0].cables[0].input': value pull is one of inputs.tensions; a "
                "cable needs "
                "one of inputs.angles"},
        Refusal{"cable_by_nothing", "input: wind", "input: winch",
                "arm.yaml:20: key 'segments[0].cables[0].input': value winch is no input of inputs.angles; "
                "declared: "
                "wind, count"},
        Refusal{"cable_without_lever", kGeared, "spool_radius_m: 0.02",
                "arm.yaml:20: key 'segments[0].cables[0].lever_m': is missing; a cable needs it, or "
                "curvature_gain_per_m_rad; allowed: [0.0001, 1] m"},
        Refusal{"cable_without_gain", kGeared, "",
                "arm.yaml:20: key 'segments[0].cables[0].spool_radius_m': is missing; a cable needs it, or "
                "curvature_gain_per_m_rad; allowed: [0.0001, 1] m"},
        Refusal{"cable_with_gain_and_lever", kGeared, "curvature_gain_per_m_rad: 3, lever_m: 0.01",
                "arm.yaml:20: key 'segments[0].cables[0].lever_m': is given beside curvature_gain_per_m_rad, "
                "which it "
                "is part of"},
        Refusal{"knots_out_of_order", "pressure_pa: 1e4", "pressure_pa: 0",
                "arm.yaml:13: key 'segments[0].bending_stiffness.by_pressure[1].pressure_pa': value 0 does "
                "not lie "
                "beyond the knot before it, 0 Pa"},
        Refusal{"knot_outside_own_range", "bending_stiffness_nm2: 0.002", "bending_stiffness_nm2: 20",
                "arm.yaml:13: key 'segments[0].bending_stiffness.by_pressure[1].bending_stiffness_nm2': "
                "value 20 is "
                "outside the segment's own range_nm2 [0.0001, 10] N m^2"},
        Refusal{"knots_without_chamber", "    central_chamber: {input: centre, area_m2: 1e-5}\n", "",
                "arm.yaml:11: key 'segments[0].bending_stiffness.by_pressure': needs the segment's "
                "central_chamber, "
                "whose pressure it is about"},
        Refusal{"misspelt", "tendons:", "tendon:",
                "arm.yaml:17: key 'segments[0].tendon': unknown key; did you mean 'tendons'?"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Inputs, ActuationYamlRefuses,
    ::testing::Values(
        Refusal{"unit_of_force", "unit: mN", "unit: lbf",
                "arm.yaml:29: key 'inputs.tensions[0].unit': value 'lbf' is none of: N, mN, kgf, gf"},
        Refusal{"unit_of_angle", "topic: /servo/1/angle", "topic: a, unit: turns",
                "arm.yaml:31: key 'inputs.angles[0].unit': value 'turns' is none of: rad, deg"},
        Refusal{"type_of_tension", "unit: mN", "type: sensor_msgs/FluidPressure",
                "arm.yaml:29: key 'inputs.tensions[0].type': value sensor_msgs/FluidPressure is none of: "
                "std_msgs/Float64, std_msgs/Float32MultiArray, std_msgs/Float64MultiArray; for a message of "
                "another type give field"},
        Refusal{"element_without_array", "unit: mN", "element: 2",
                "arm.yaml:29: key 'inputs.tensions[0].element': value 2 is an index of an array, but type "
                "std_msgs/Float64 holds one value"},
        Refusal{
            "two_units", "rad_per_unit: -0.002", "unit: deg, rad_per_unit: 0.002",
            "arm.yaml:32: key 'inputs.angles[1].rad_per_unit': is given beside unit; give one of them only"},
        Refusal{"no_gear", "rad_per_unit: -0.002", "rad_per_unit: 0",
                "arm.yaml:32: key 'inputs.angles[1].rad_per_unit': value 0 must not be 0"},
        Refusal{
            "zero_not_finite", "zero: 250", "zero: .inf",
            "arm.yaml:29: key 'inputs.tensions[0].zero': value .inf is not finite; allowed: [-1e+06, 1e+06]"},
        Refusal{"name_of_a_pressure", "name: pull", "name: centre",
                "arm.yaml:29: key 'inputs.tensions[0].name': value centre is given to another input already; "
                "names are "
                "unique"},
        Refusal{"name_of_a_tension", "name: wind", "name: pull",
                "arm.yaml:31: key 'inputs.angles[0].name': value pull is given to another input already; "
                "names are "
                "unique"},
        Refusal{"topic_of_a_tension", "topic: /servo/1/angle", "topic: /tendon/1/tension",
                "arm.yaml:31: key 'inputs.angles[0].topic': value /tendon/1/tension with element 0 is read "
                "by input "
                "'pull' already"},
        Refusal{"type_of_a_tensions_topic", "topic: /pwm", "topic: /tendon/1/tension",
                "arm.yaml:32: key 'inputs.angles[1].type': value std_msgs/Float32MultiArray differs from "
                "that of input "
                "'pull' on the same topic"},
        Refusal{"window_too_long", "window_s: 0.5", "window_s: 500",
                "arm.yaml:33: key 'estimator.window_s': value 500 is outside the allowed range [0, 60] s"},
        Refusal{"jitter_negative", "enabled: true", "moment_jitter_sd_nm: -1",
                "arm.yaml:33: key 'estimator.prior.moment_jitter_sd_nm': value -1 is outside the allowed "
                "range [0, 100] "
                "N m"},
        Refusal{"unknown_unknown", "unknown: both", "unknown: all",
                "arm.yaml:33: key 'estimator.unknown': value 'all' is none of: stiffness, payload, both"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(ActuationYaml, EveryTruncationIsRefusedOrRead) {
  for (std::size_t length = 0; length < kDriven.size(); ++length) {
    try {
      arm::parse_arm(kDriven.substr(0, length), "arm.yaml");
    } catch (const arm::ArmError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace softarm
