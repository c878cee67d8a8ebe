// What parse_arm() reads.
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

#include "arm_text.h"
#include "predicted.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

TEST(ArmYaml, SmallArmWithDefaults) {
  const arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  EXPECT_EQ(arm.name, "small");
  EXPECT_EQ(arm.gravity_m_s2, Eigen::Vector3d(0, 0, -9.80665));
  EXPECT_EQ(arm.base.body, "base");
  ASSERT_EQ(arm.segments.size(), 1u);
  const arm::Segment& segment = arm.segments[0];
  EXPECT_DOUBLE_EQ(segment.length_m, 0.2);
  EXPECT_DOUBLE_EQ(segment.length_range_m.low, 0.14);
  EXPECT_NEAR(segment.length_range_m.high, 0.3, 1e-15);
  EXPECT_FALSE(segment.torsional_stiffness_nm2 || segment.axial_stiffness_n || segment.shear_stiffness_n);
  EXPECT_FALSE(segment.jamming_input);
  ASSERT_EQ(segment.chambers.size(), 1u);
  EXPECT_DOUBLE_EQ(segment.chambers[0].bending_direction_rad, 90 * kDeg);
  EXPECT_DOUBLE_EQ(segment.chambers[0].moment_gain_nm_per_pa, 6e-6);
  ASSERT_EQ(arm.bodies.size(), 2u);
  EXPECT_DOUBLE_EQ(arm.bodies[1].arclength_m, 0.2);
  EXPECT_FALSE(arm.bodies[0].orientation_usable);
  EXPECT_TRUE(arm.bodies[1].orientation_usable);
  EXPECT_DOUBLE_EQ(arm.bodies[0].position_sd_m, 0.0005);
  EXPECT_DOUBLE_EQ(arm.bodies[0].orientation_sd_rad, 0.02);
  EXPECT_DOUBLE_EQ(arm.payload.arclength_m, 0.2);
  EXPECT_FALSE(arm.payload.default_kg);
}

TEST(ArmYaml, DefaultsAreThoseOfTheStructs) {
  const arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  const arm::Inputs inputs;
  EXPECT_EQ(arm.inputs.bodies.topic, inputs.bodies.topic);
  EXPECT_EQ(arm.inputs.bodies.type, inputs.bodies.type);
  EXPECT_EQ(arm.inputs.bodies.scale_to_m, inputs.bodies.scale_to_m);
  EXPECT_EQ(arm.inputs.ambient_pressure_pa, inputs.ambient_pressure_pa);
  EXPECT_EQ(arm.inputs.payload_topic, inputs.payload_topic);
  EXPECT_EQ(arm.inputs.body_sync_tolerance_s, inputs.body_sync_tolerance_s);
  EXPECT_EQ(arm.inputs.input_max_age_s, inputs.input_max_age_s);
  const arm::ScalarInput pressure;
  ASSERT_EQ(arm.inputs.scalars.size(), 1u);
  EXPECT_EQ(arm.inputs.scalars[0].type, "sensor_msgs/FluidPressure");
  EXPECT_EQ(arm.inputs.scalars[0].element, pressure.element);
  EXPECT_EQ(arm.inputs.scalars[0].scale_to_si, pressure.scale_to_si);
  EXPECT_EQ(arm.inputs.scalars[0].reference, pressure.reference);
  EXPECT_EQ(arm.inputs.scalars[0].kind, pressure.kind);
  const arm::EstimatorOptions options;
  EXPECT_EQ(arm.estimator.method, options.method);
  EXPECT_EQ(arm.estimator.unknown, options.unknown);
  EXPECT_EQ(arm.estimator.objective, options.objective);
  EXPECT_EQ(arm.estimator.weights, options.weights);
  EXPECT_EQ(arm.estimator.robust, options.robust);
  EXPECT_EQ(arm.estimator.identifiable_relative_sd, options.identifiable_relative_sd);
  EXPECT_EQ(arm.estimator.prior.enabled, options.prior.enabled);
  EXPECT_EQ(arm.estimator.prior.moment_sd_nm, options.prior.moment_sd_nm);
  EXPECT_EQ(arm.estimator.prior.bending_stiffness_sd_rel, options.prior.bending_stiffness_sd_rel);
  EXPECT_EQ(arm.estimator.prior.length_sd_m, options.prior.length_sd_m);
  EXPECT_EQ(arm.estimator.prior.moment_sd_rel, options.prior.moment_sd_rel);
  EXPECT_EQ(arm.estimator.prior.moment_jitter_sd_nm, options.prior.moment_jitter_sd_nm);
  EXPECT_EQ(arm.estimator.prior.length_jitter_sd_m, options.prior.length_jitter_sd_m);
  EXPECT_EQ(arm.estimator.window_s, options.window_s);
  const arm::PayloadMount payload;
  EXPECT_EQ(arm.payload.range_kg.low, payload.range_kg.low);
  EXPECT_EQ(arm.payload.range_kg.high, payload.range_kg.high);
  const arm::Segment segment;
  EXPECT_EQ(arm.segments[0].bending_stiffness_range_nm2.low, segment.bending_stiffness_range_nm2.low);
  EXPECT_EQ(arm.segments[0].bending_stiffness_range_nm2.high, segment.bending_stiffness_range_nm2.high);
  EXPECT_EQ(arm.base.hold_last, arm::Base().hold_last);
}

/// Every key with a value other than its default.
const std::string kFullArm = R"(format: 1
name: full
gravity_m_s2: [0, -9.81, 0]
base:
  body: rig/plate
  rod_in_body: {position_m: [0.01, 0.02, 0.03], rpy_deg: [90, 0, 90]}
  hold_last: false
segments:
  - name: lower
    length_m: 0.2
    length_range_m: [0.1, 0.4]
    mass_per_length_kg_m: 1.5
    diameter_m: 0.05
    bending_stiffness:
      base_nm2: 0.05
      per_min_pressure_nm2_per_pa: 3e-7
      per_jamming_pressure_nm2_per_pa: 1.3e-6
      range_nm2: [0.01, 0.5]
      profile: [{fraction: 0, factor: 1.2}, {fraction: 1, factor: 0.8}]
    torsional_stiffness_nm2: 0.02
    axial_stiffness_n: 150
    shear_stiffness_n: 45
    rest_curvature_per_m: [0.1, -0.2, 0.3]
    jamming_input: vacuum
    chambers:
      - input: left
        bending_direction_deg: -30
        moment_gain_nm_per_pa: 1e-6
        near_elongation_m_per_pa: 2e-8
        far_elongation_m_per_pa: -1e-8
  - name: upper
    length_m: 0.1
    mass_per_length_kg_m: 0.5
    diameter_m: 0.03
    bending_stiffness: {base_nm2: 0.02}
tip_mass_kg: 0.015
payload: {arclength_m: 0.28, offset_m: [0.02, 0, 0.01], default_kg: 0.1, range_kg: [0, 0.5]}
noise: {position_sd_m: 0.001, orientation_sd_rad: 0.05}
bodies:
  - {name: skin_1, kind: skin_marker, arclength_m: 0.15, angle_deg: 60, radius_m: 0.025}
  - {name: skin_2, kind: skin_marker, arclength_m: 0.15, angle_deg: 120, radius_m: 0.025, position_sd_m: 0.002}
  - name: end
    arclength_m: tip
    orientation_usable: true
    section_in_body: {position_m: [0, 0, -0.01], quaternion_xyzw: [0, 1, 0, 0]}
    orientation_sd_rad: 0.1
inputs:
  bodies: {topic: /vicon/<body>/pose, unit: mm, sync_tolerance_s: 0.004}
  pressures:
    - {name: left, topic: valves, type: std_msgs/Float32MultiArray, element: 2, unit: kPa, reference: gauge}
    - {name: vacuum, topic: valves, type: std_msgs/Float32MultiArray, element: 3, unit: mbar, vacuum: true}
  ambient_pressure_pa: 98000
  input_max_age_s: 2
  payload_topic: scale
estimator:
  method: end_orientation
  unknown: payload
  objective: sum_of_distances
  weights: noise
  robust: false
  identifiable_relative_sd: 0.5
  window_s: 0.5
  prior:
    enabled: true
    moment_sd_nm: 0.05
    moment_sd_rel: 0.1
    bending_stiffness_sd_rel: 0.3
    length_sd_m: 0.004
    moment_jitter_sd_nm: 0.001
    length_jitter_sd_m: 0.0002
)";

TEST(ArmYaml, APathIsSaidWhole) {
  const std::string path = "/" + std::string(120, 'd') + "/arm.yaml";
  try {
    arm::parse_arm("format: 7\n", path);
    FAIL();
  } catch (const arm::ArmError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path + ":", 0), 0u) << error.what();
  }
}

TEST(ArmYaml, EverySegmentKey) {
  const arm::Arm arm = arm::parse_arm(kFullArm, "arm.yaml");
  ASSERT_EQ(arm.segments.size(), 2u);
  EXPECT_NEAR(arm.total_length_m(), 0.3, 1e-15);
  const arm::Segment& lower = arm.segments[0];
  EXPECT_EQ(lower.length_range_m.high, 0.4);
  EXPECT_EQ(lower.mass_per_length_kg_m, 1.5);
  EXPECT_EQ(lower.diameter_m, 0.05);
  EXPECT_EQ(lower.bending_stiffness.base_nm2, 0.05);
  EXPECT_EQ(lower.bending_stiffness.per_min_pressure_nm2_per_pa, 3e-7);
  EXPECT_EQ(lower.bending_stiffness.per_jamming_pressure_nm2_per_pa, 1.3e-6);
  EXPECT_EQ(lower.bending_stiffness_range_nm2.low, 0.01);
  ASSERT_EQ(lower.stiffness_profile.size(), 2u);
  EXPECT_EQ(lower.stiffness_profile[1].fraction, 1.0);
  EXPECT_EQ(lower.stiffness_profile[1].factor, 0.8);
  EXPECT_EQ(lower.torsional_stiffness_nm2, 0.02);
  EXPECT_EQ(lower.axial_stiffness_n, 150);
  EXPECT_EQ(lower.shear_stiffness_n, 45);
  EXPECT_EQ(lower.rest_curvature_per_m, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(lower.jamming_input, "vacuum");
  EXPECT_EQ(lower.chambers[0].near_elongation_m_per_pa, 2e-8);
  EXPECT_EQ(lower.chambers[0].far_elongation_m_per_pa, -1e-8);
  EXPECT_TRUE(arm.segments[1].chambers.empty());
}

TEST(ArmYaml, EveryBodyAndPayloadKey) {
  const arm::Arm arm = arm::parse_arm(kFullArm, "arm.yaml");
  EXPECT_EQ(arm.tip_mass_kg, 0.015);
  EXPECT_EQ(arm.payload.arclength_m, 0.28);
  EXPECT_EQ(arm.payload.offset_m, Eigen::Vector3d(0.02, 0, 0.01));
  EXPECT_EQ(arm.payload.default_kg, 0.1);
  EXPECT_EQ(arm.payload.range_kg.high, 0.5);
  ASSERT_EQ(arm.bodies.size(), 3u);
  EXPECT_EQ(arm.bodies[0].kind, arm::BodyKind::kSkinMarker);
  EXPECT_DOUBLE_EQ(arm.bodies[0].angle_rad, 60 * kDeg);
  EXPECT_EQ(arm.bodies[0].radius_m, 0.025);
  EXPECT_EQ(arm.bodies[0].position_sd_m, 0.001);
  EXPECT_EQ(arm.bodies[1].position_sd_m, 0.002);
  const arm::MeasuredBody& end = arm.bodies[2];
  EXPECT_EQ(end.kind, arm::BodyKind::kRing);
  EXPECT_EQ(end.orientation_sd_rad, 0.1);
  EXPECT_EQ(end.section_in_body.translation(), Eigen::Vector3d(0, 0, -0.01));
  EXPECT_NEAR((end.section_in_body.linear() * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(), 0,
              1e-15);
}

TEST(ArmYaml, EveryInputAndEstimatorKey) {
  const arm::Arm arm = arm::parse_arm(kFullArm, "arm.yaml");
  EXPECT_EQ(arm.inputs.bodies.topic, "/vicon/<body>/pose");
  EXPECT_EQ(arm.inputs.bodies.scale_to_m, 1e-3);
  EXPECT_EQ(arm.inputs.body_sync_tolerance_s, 0.004);
  ASSERT_EQ(arm.inputs.scalars.size(), 2u);
  EXPECT_EQ(arm.inputs.scalars[0].topic, "valves");
  EXPECT_EQ(arm.inputs.scalars[0].element, 2);
  EXPECT_EQ(arm.inputs.scalars[0].scale_to_si, 1e3);
  EXPECT_EQ(arm.inputs.scalars[0].reference, arm::PressureReference::kGauge);
  EXPECT_EQ(arm.inputs.scalars[1].scale_to_si, 100);
  EXPECT_EQ(arm.inputs.scalars[1].kind, arm::InputKind::kVacuum);
  EXPECT_EQ(arm.inputs.ambient_pressure_pa, 98000);
  EXPECT_EQ(arm.inputs.input_max_age_s, 2);
  EXPECT_EQ(arm.inputs.payload_topic, "scale");
  EXPECT_EQ(arm.estimator.method, arm::Method::kEndOrientation);
  EXPECT_EQ(arm.estimator.unknown, arm::Unknown::kPayload);
  EXPECT_EQ(arm.estimator.objective, arm::Objective::kSumOfDistances);
  EXPECT_EQ(arm.estimator.weights, arm::Weights::kNoise);
  EXPECT_FALSE(arm.estimator.robust);
  EXPECT_EQ(arm.estimator.identifiable_relative_sd, 0.5);
  EXPECT_TRUE(arm.estimator.prior.enabled);
  EXPECT_EQ(arm.estimator.prior.moment_sd_nm, 0.05);
  EXPECT_EQ(arm.estimator.prior.moment_sd_rel, 0.1);
  EXPECT_EQ(arm.estimator.prior.bending_stiffness_sd_rel, 0.3);
  EXPECT_EQ(arm.estimator.prior.length_sd_m, 0.004);
  EXPECT_EQ(arm.estimator.prior.moment_jitter_sd_nm, 0.001);
  EXPECT_EQ(arm.estimator.prior.length_jitter_sd_m, 0.0002);
  EXPECT_EQ(arm.estimator.window_s, 0.5);
}

TEST(ArmYaml, MeasuredBase) {
  const arm::Arm arm = arm::parse_arm(kFullArm, "arm.yaml");
  EXPECT_EQ(arm.gravity_m_s2, Eigen::Vector3d(0, -9.81, 0));
  EXPECT_EQ(arm.base.body, "rig/plate");
  EXPECT_FALSE(arm.base.hold_last);
  EXPECT_EQ(arm.base.rod_in_body.translation(), Eigen::Vector3d(0.01, 0.02, 0.03));
  // Roll 90 deg takes z to -y, then yaw 90 deg takes -y to x.
  EXPECT_NEAR((arm.base.rod_in_body.linear() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 0,
              1e-12);
}

TEST(ArmYaml, UnitsOfPressure) {
  const std::pair<const char*, double> units[] = {{"Pa", 1},    {"kPa", 1e3},  {"MPa", 1e6},
                                                  {"bar", 1e5}, {"mbar", 100}, {"psi", 6894.757293168}};
  for (const auto& [word, scale] : units) {
    const arm::Arm arm = arm::parse_arm(
        edited("topic: /pressure/chamber_1", std::string("topic: /pressure/chamber_1, unit: ") + word),
        "arm.yaml");
    EXPECT_DOUBLE_EQ(arm.inputs.scalars[0].scale_to_si, scale) << word;
  }
}

Eigen::Isometry3d fixed_pose(const std::string& fixed, const std::string& gravity = "[0, 0, -9.81]") {
  const arm::Arm arm = arm::parse_arm(
      edited("base: {body: base}", "gravity_m_s2: " + gravity + "\nbase: {fixed: " + fixed + "}"),
      "arm.yaml");
  EXPECT_FALSE(arm.base.body);
  return arm.base.fixed_pose;
}

TEST(ArmYaml, FixedBaseByAttitude) {
  const Eigen::Isometry3d hanging = fixed_pose("{attitude: hanging, position_m: [1, 2, 3]}");
  EXPECT_EQ(hanging.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR((hanging.linear().col(2) + Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((hanging.linear().col(0) - Eigen::Vector3d::UnitX()).norm(), 0, 1e-12);
  EXPECT_NEAR((fixed_pose("{attitude: standing}").linear() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  const Eigen::Isometry3d horizontal = fixed_pose("{attitude: horizontal}");
  EXPECT_NEAR((horizontal.linear().col(2) - Eigen::Vector3d::UnitX()).norm(), 0, 1e-12);
  EXPECT_NEAR((horizontal.linear().col(0) - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  for (const char* const gravity : {"[0, 0, -9.81]", "[0, -9.81, 0]", "[9.81, 0, 0]", "[3, 4, -5]"}) {
    for (const char* const attitude : {"hanging", "standing", "horizontal"}) {
      const Eigen::Matrix3d r = fixed_pose(std::string("{attitude: ") + attitude + "}", gravity).linear();
      EXPECT_NEAR((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
      EXPECT_NEAR(r.determinant(), 1, 1e-12);
    }
  }
}

TEST(ArmYaml, FixedBaseByQuaternion) {
  // Four decimals are close enough to a unit quaternion, and the result is an exact rotation.
  const Eigen::Matrix3d r = fixed_pose("{quaternion_xyzw: [0.7071, 0, 0, 0.7071]}").linear();
  EXPECT_NEAR((r * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-9);
  EXPECT_NEAR((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
}

TEST(ArmYaml, SectionWhoseKeysAreAllCommentedOutIsDefault) {
  EXPECT_EQ(
      arm::parse_arm(edited("estimator: {method: full_points}", "estimator:\n  # method: x\n"), "arm.yaml")
          .estimator.method,
      arm::Method::kFullPoints);
}

TEST(ArmYaml, NumbersDoNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // where it is installed, its decimal comma must not matter
  const arm::Arm arm = arm::parse_arm(edited("length_m: 0.2", "length_m: +2.5e-1"), "arm.yaml");
  std::setlocale(LC_NUMERIC, before.c_str());
  EXPECT_EQ(arm.segments[0].length_m, 0.25);
}

TEST(ArmWords, RoundTripAndRefuse) {
  for (const arm::Method m : {arm::Method::kFullPoints, arm::Method::kEndOrientation, arm::Method::kCcPoints,
                              arm::Method::kCcEndpoint}) {
    EXPECT_EQ(arm::parse_method(to_string(m)), m);
  }
  for (const arm::Unknown u : {arm::Unknown::kStiffness, arm::Unknown::kPayload, arm::Unknown::kBoth})
    EXPECT_EQ(arm::parse_unknown(to_string(u)), u);
  for (const arm::Objective o : {arm::Objective::kLeastSquares, arm::Objective::kSumOfDistances}) {
    EXPECT_EQ(arm::parse_objective(to_string(o)), o);
  }
  EXPECT_EQ(to_string(arm::Method::kCcEndpoint), "cc_endpoint");
  try {
    arm::parse_method("full_point");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "method 'full_point' is none of: full_points, end_orientation, cc_points, cc_endpoint");
  }
  EXPECT_THROW(arm::parse_unknown("EI"), std::invalid_argument);
  EXPECT_THROW(arm::parse_objective(""), std::invalid_argument);
  for (const arm::Dynamics d : {arm::Dynamics::kStatic, arm::Dynamics::kModal})
    EXPECT_EQ(arm::parse_dynamics(to_string(d)), d);
  EXPECT_THROW(arm::parse_dynamics("modes"), std::invalid_argument);
}

}  // namespace
}  // namespace softarm
