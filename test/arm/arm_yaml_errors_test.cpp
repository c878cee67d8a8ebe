// What parse_arm() refuses, and how it says so: one line with source, line, key, value and what is allowed.
#include <gtest/gtest.h>

#include <string>

#include "arm_text.h"

namespace softarm {
namespace {

class ArmYamlRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(ArmYamlRefuses, WithOneClearLine) {
  const Refusal& c = GetParam();
  EXPECT_EQ(refusal(edited(c.from, c.to)), c.message);
}

constexpr char kLength[] = "length_m: 0.2";
constexpr char kRing[] = "{name: ring_1, arclength_m: 0.1}";
constexpr char kInput[] = "{name: chamber_1, topic: /pressure/chamber_1}";

INSTANTIATE_TEST_SUITE_P(
    Values, ArmYamlRefuses,
    ::testing::Values(
        Refusal{
            "below_range", kLength, "length_m: -0.2",
            "arm.yaml:6: key 'segments[0].length_m': value -0.2 is outside the allowed range [0.005, 10] m"},
        Refusal{
            "millimetres", kLength, "length_m: 200",
            "arm.yaml:6: key 'segments[0].length_m': value 200 is outside the allowed range [0.005, 10] m"},
        Refusal{
            "gain_per_kpa", "6.0e-6", "0.0061",
            "arm.yaml:11: key 'segments[0].chambers[0].moment_gain_nm_per_pa': value 0.0061 is outside the "
            "allowed range [0, 0.001] N m/Pa"},
        Refusal{"nan", kLength, "length_m: .nan",
                "arm.yaml:6: key 'segments[0].length_m': value .nan is not finite; allowed: [0.005, 10] m"},
        Refusal{"infinity", kLength, "length_m: 1e999",
                "arm.yaml:6: key 'segments[0].length_m': value 1e999 is not finite; allowed: [0.005, 10] m"},
        Refusal{"unit_behind_number", kLength, "length_m: 200 mm",
                "arm.yaml:6: key 'segments[0].length_m': value '200 mm' is not a number in [0.005, 10] m"},
        Refusal{"decimal_comma", kLength, "length_m: 0,2",
                "arm.yaml:6: key 'segments[0].length_m': value '0,2' is not a number in [0.005, 10] m"},
        Refusal{"nothing", kLength, "length_m:",
                "arm.yaml:6: key 'segments[0].length_m': has no value; expected a number in [0.005, 10] m"},
        Refusal{"list_for_number", kLength, "length_m: [0.2, 0.3]",
                "arm.yaml:6: key 'segments[0].length_m': value [0.2, 0.3] is not a number in [0.005, 10] m"},
        Refusal{"number_nor_word", kLength, "length_m: 0.2\n    axial_stiffness_n: stiff",
                "arm.yaml:7: key 'segments[0].axial_stiffness_n': value 'stiff' is not a number in [0.1, "
                "1e+08] N nor "
                "one of: rigid"},
        Refusal{
            "vector_size", "name: small", "name: small\ngravity_m_s2: [0, -9.81]",
            "arm.yaml:3: key 'gravity_m_s2': value [0, -9.81] is not a list of 3 numbers in [-30, 30] m/s^2"},
        Refusal{"gravity_of_nowhere", "name: small", "name: small\ngravity_m_s2: [0, 0, 1e-320]",
                "arm.yaml:3: key 'gravity_m_s2': value [0, 0, 1e-320] must be 0 or 0.001 m/s^2 and more"},
        Refusal{
            "vector_element", "name: small", "name: small\ngravity_m_s2: [0, 0, -9810]",
            "arm.yaml:3: key 'gravity_m_s2[2]': value -9810 is outside the allowed range [-30, 30] m/s^2"},
        Refusal{"flag", "orientation_usable: true", "orientation_usable: yes",
                "arm.yaml:14: key 'bodies[1].orientation_usable': value yes is neither true nor false"},
        Refusal{"fractional_index", kInput,
                "{name: chamber_1, topic: p, type: std_msgs/Float64MultiArray, element: 1.5}",
                "arm.yaml:17: key 'inputs.pressures[0].element': value 1.5 is not an integer; allowed: [0, "
                "1023]"},
        Refusal{"wrong_unit", kInput, "{name: chamber_1, topic: p, unit: torr}",
                "arm.yaml:17: key 'inputs.pressures[0].unit': value 'torr' is none of: Pa, kPa, MPa, bar, "
                "mbar, psi"},
        Refusal{"wrong_length_unit", "inputs:", "inputs:\n  bodies: {unit: inch}",
                "arm.yaml:16: key 'inputs.bodies.unit': value 'inch' is none of: m, cm, mm"},
        Refusal{"wrong_method", "method: full_points", "method: full",
                "arm.yaml:18: key 'estimator.method': value 'full' is none of: full_points, end_orientation, "
                "cc_points, cc_endpoint"},
        Refusal{"wrong_format", "format: 1", "format: 2",
                "arm.yaml:1: key 'format': value 2 is outside the allowed range [1, 1]"},
        Refusal{"illegal_name", "name: small", "name: 2 arms",
                "arm.yaml:2: key 'name': value '2 arms' is not a name: a letter, then letters, digits or any "
                "of '_'"},
        Refusal{"illegal_topic", "topic: /pressure/chamber_1", "topic: /pressure chamber",
                "arm.yaml:17: key 'inputs.pressures[0].topic': value '/pressure chamber' is not a ROS topic: "
                "letters, "
                "digits, '_' and '/'"},
        Refusal{"topic_without_body", "inputs:", "inputs:\n  bodies: {topic: /mocap/pose}",
                "arm.yaml:16: key 'inputs.bodies.topic': value '/mocap/pose' does not contain <body>"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Keys, ArmYamlRefuses,
    ::testing::Values(
        Refusal{"misspelt", kLength, "lenght_m: 0.2",
                "arm.yaml:6: key 'segments[0].lenght_m': unknown key; did you mean 'length_m'?"},
        Refusal{"other_unit", "diameter_m: 0.04", "diameter_mm: 40",
                "arm.yaml:8: key 'segments[0].diameter_mm': unknown key; did you mean 'diameter_m'?"},
        Refusal{
            "unheard_of", "base: {body: base}", "base: {body: base, colour: red}",
            "arm.yaml:3: key 'base.colour': unknown key; allowed here: body, rod_in_body, labelled_markers, "
            "hold_last, fixed"},
        Refusal{"missing", "    diameter_m: 0.04\n", "",
                "arm.yaml:5: key 'segments[0].diameter_m': is missing; outer diameter (pictures, markers on "
                "the skin); "
                "allowed: [0.0005, 1] m"},
        Refusal{"missing_section", "base: {body: base}\n", "",
                "arm.yaml:1: key 'base': is missing; where the arm is mounted; allowed: section"},
        Refusal{"twice", kLength, "length_m: 0.2\n    length_m: 0.3",
                "arm.yaml:7: key 'segments[0].length_m': is given twice, first on line 6"},
        Refusal{"number_for_section", "base: {body: base}", "base: 3",
                "arm.yaml:3: key 'base': value 3 is not a section of keys"},
        Refusal{"text_for_list", "  - {name: ring_1, arclength_m: 0.1}\n", "  - ring_1\n",
                "arm.yaml:13: key 'bodies[0]': value ring_1 is not a section of keys"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Contradictions, ArmYamlRefuses,
    ::testing::Values(
        Refusal{"duplicate_body", kRing, "{name: ring_2, arclength_m: 0.1}",
                "arm.yaml:14: key 'bodies[1].name': value ring_2 is given to another body already; names are "
                "unique"},
        Refusal{"base_as_body", kRing, "{name: base, arclength_m: 0.1}",
                "arm.yaml:13: key 'bodies[0].name': value base is the base's body already; names are unique"},
        Refusal{
            "duplicate_input", kInput, "{name: chamber_1, topic: a}\n    - {name: chamber_1, topic: b}",
            "arm.yaml:18: key 'inputs.pressures[1].name': value chamber_1 is given to another input already; "
            "names are unique"},
        Refusal{
            "input_like_the_payload", kInput, "{name: chamber_1, topic: a}\n    - {name: payload, topic: b}",
            "arm.yaml:18: key 'inputs.pressures[1].name': value payload is taken: reports have the arm's own "
            "payload under it"},
        Refusal{"duplicate_topic", kInput, "{name: chamber_1, topic: a}\n    - {name: chamber_2, topic: a}",
                "arm.yaml:18: key 'inputs.pressures[1].topic': value a with element 0 is read by input "
                "'chamber_1' "
                "already"},
        Refusal{"types_on_one_topic", kInput,
                "{name: chamber_1, topic: a}\n    - {name: c, topic: a, type: std_msgs/Float32MultiArray, "
                "element: 1}",
                "arm.yaml:18: key 'inputs.pressures[1].type': value std_msgs/Float32MultiArray differs from "
                "that of "
                "input 'chamber_1' on the same topic"},
        Refusal{"unknown_input", "input: chamber_1", "input: chamber_9",
                "arm.yaml:11: key 'segments[0].chambers[0].input': value chamber_9 is no input of "
                "inputs.pressures; "
                "declared: chamber_1"},
        Refusal{"vacuum_in_chamber", kInput, "{name: chamber_1, topic: a, vacuum: true}",
                "arm.yaml:11: key 'segments[0].chambers[0].input': value chamber_1 is a vacuum input; a "
                "chamber needs "
                "a pressure"},
        Refusal{"pressure_in_core", kLength, "length_m: 0.2\n    jamming_input: chamber_1",
                "arm.yaml:7: key 'segments[0].jamming_input': value chamber_1 is not a vacuum input; mark it "
                "`vacuum: true` in inputs.pressures"},
        Refusal{"core_without_input", "base_nm2: 0.03",
                "base_nm2: 0.03, per_jamming_pressure_nm2_per_pa: 1e-6",
                "arm.yaml:9: key 'segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa': value 1e-6 "
                "needs the "
                "segment's jamming_input"},
        Refusal{"element_without_array", kInput, "{name: chamber_1, topic: a, element: 1}",
                "arm.yaml:17: key 'inputs.pressures[0].element': value 1 is an index of an array, but type "
                "sensor_msgs/FluidPressure holds one value"},
        Refusal{"body_beyond_tip", "arclength_m: 0.1", "arclength_m: 0.21",
                "arm.yaml:13: key 'bodies[0].arclength_m': value 0.21 lies beyond the arm's length, 0.2 m"},
        Refusal{"payload_beyond_tip", "bodies:", "payload: {arclength_m: 0.3}\nbodies:",
                "arm.yaml:12: key 'payload.arclength_m': value 0.3 lies beyond the arm's length, 0.2 m"},
        Refusal{"order_of_bodies", "arclength_m: tip", "arclength_m: 0.05",
                "arm.yaml:14: key 'bodies[1].arclength_m': value 0.05 lies before that of 'ring_1', 0.1 m; "
                "list bodies "
                "from base to tip"},
        Refusal{"two_rings_at_one_place", "arclength_m: tip", "arclength_m: 0.1",
                "arm.yaml:14: key 'bodies[1].arclength_m': value 0.1 is that of ring 'ring_1' already"},
        Refusal{"ring_key_on_marker", kRing,
                "{name: m, kind: skin_marker, arclength_m: 0.1, angle_deg: 0, radius_m: 0.02, "
                "orientation_usable: true}",
                "arm.yaml:13: key 'bodies[0].orientation_usable': applies to bodies of kind ring only"},
        Refusal{"marker_key_on_ring", kRing, "{name: m, arclength_m: 0.1, angle_deg: 0}",
                "arm.yaml:13: key 'bodies[0].angle_deg': applies to bodies of kind skin_marker only"},
        Refusal{
            "marker_without_radius", kRing, "{name: m, kind: skin_marker, arclength_m: 0.1, angle_deg: 0}",
            "arm.yaml:13: key 'bodies[0].radius_m': is missing; a skin_marker needs it; allowed: [0, 1] m"},
        Refusal{"range_reversed", kLength, "length_m: 0.2\n    length_range_m: [0.3, 0.1]",
                "arm.yaml:7: key 'segments[0].length_range_m': value [0.3, 0.1] is not a range: the first "
                "number must "
                "be below the second"},
        Refusal{"length_outside_own_range", kLength, "length_m: 0.2\n    length_range_m: [0.3, 0.4]",
                "arm.yaml:7: key 'segments[0].length_range_m': value [0.3, 0.4] does not contain length_m, "
                "0.2 m"},
        Refusal{"stiffness_outside_own_range", "base_nm2: 0.03", "base_nm2: 0.03, range_nm2: [0.05, 1]",
                "arm.yaml:9: key 'segments[0].bending_stiffness.base_nm2': value 0.03 is outside the "
                "segment's own "
                "range_nm2 [0.05, 1] N m^2"},
        Refusal{"profile_order", "base_nm2: 0.03",
                "base_nm2: 0.03, profile: [{fraction: 0.5, factor: 1}, {fraction: 0.5, factor: 2}]",
                "arm.yaml:9: key 'segments[0].bending_stiffness.profile[1].fraction': value 0.5 does not lie "
                "beyond "
                "the knot before it, 0.5"},
        Refusal{"default_payload_outside_range", "bodies:", "payload: {default_kg: 6}\nbodies:",
                "arm.yaml:12: key 'payload.default_kg': value 6 is outside the payload's own range_kg [0, 5] "
                "kg"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Bases, ArmYamlRefuses,
    ::testing::Values(
        Refusal{"quaternion_norm", "body: base",
                "body: base, rod_in_body: {quaternion_xyzw: [0, 0, 0.5, 0.5]}",
                "arm.yaml:3: key 'base.rod_in_body.quaternion_xyzw': value [0, 0, 0.5, 0.5] has norm 0.7071, "
                "outside "
                "the allowed range [0.999, 1.001]"},
        Refusal{
            "zero_quaternion", "body: base", "body: base, rod_in_body: {quaternion_xyzw: [0, 0, 0, 0]}",
            "arm.yaml:3: key 'base.rod_in_body.quaternion_xyzw': value [0, 0, 0, 0] has norm 0, outside the "
            "allowed range [0.999, 1.001]"},
        Refusal{"two_rotations", "body: base",
                "body: base, rod_in_body: {quaternion_xyzw: [0, 0, 0, 1], rpy_deg: [0, 0, 0]}",
                "arm.yaml:3: key 'base.rod_in_body.rpy_deg': is given beside quaternion_xyzw; give one "
                "rotation only"},
        Refusal{"measured_and_fixed", "body: base", "body: base, fixed: {attitude: hanging}",
                "arm.yaml:3: key 'base.body': is given beside fixed; a base is either measured or fixed"},
        Refusal{"neither", "body: base", "hold_last: true",
                "arm.yaml:3: key 'base.body': is missing; give the measured body of the base, or fixed"},
        Refusal{"hold_last_of_fixed", "body: base", "fixed: {attitude: hanging}, hold_last: true",
                "arm.yaml:3: key 'base.hold_last': applies to a base with a body only"},
        Refusal{"attitude_word", "body: base", "fixed: {attitude: upside_down}",
                "arm.yaml:3: key 'base.fixed.attitude': value 'upside_down' is none of: hanging, standing, "
                "horizontal"},
        Refusal{"attitude_and_rotation", "body: base", "fixed: {attitude: hanging, rpy_deg: [0, 0, 0]}",
                "arm.yaml:3: key 'base.fixed.attitude': is given beside a rotation; give one of them only"},
        Refusal{"attitude_without_gravity", "base: {body: base}",
                "base: {fixed: {attitude: hanging}}\ngravity_m_s2: [0, 0, 0]",
                "arm.yaml:3: key 'base.fixed.attitude': value hanging has no meaning without gravity; give "
                "quaternion_xyzw or rpy_deg"}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(ArmYamlRefusesDocument, SyntaxError) {
  const std::string message = refusal(edited("length_m: 0.2", "length_m: [0.2"));
  EXPECT_NE(message.find(": not YAML: "), std::string::npos) << message;
  EXPECT_NE(refusal("name: \"never closed\nformat: 1").find("not YAML"), std::string::npos);
}

TEST(ArmYamlRefusesDocument, Empty) {
  EXPECT_EQ(refusal(""), "arm.yaml:1: the document is empty");
  EXPECT_EQ(refusal("# only a comment\n"), "arm.yaml:1: the document is empty");
}

TEST(ArmYamlRefusesDocument, NotAMapOrTwoDocuments) {
  EXPECT_EQ(refusal("- 1\n- 2\n"), "arm.yaml:1: [1, 2] is not a section of keys");
  EXPECT_NE(refusal(kSmallArm + "---\nformat: 1\n").find("a second document begins"), std::string::npos);
}

TEST(ArmYamlRefusesDocument, EmptyOrMissingSegmentsAndBodies) {
  const std::size_t segments = kSmallArm.find("segments:");
  const std::size_t bodies = kSmallArm.find("bodies:");
  const std::size_t inputs = kSmallArm.find("inputs:");
  const std::string head = kSmallArm.substr(0, segments);
  const std::string tail = kSmallArm.substr(bodies);
  EXPECT_EQ(refusal(head + "segments: []\n" + tail),
            "arm.yaml:4: key 'segments': is empty; an arm has at least one segment");
  EXPECT_EQ(refusal(head + "segments:\n" + tail),
            "arm.yaml:4: key 'segments': value (nothing) is not a list");
  EXPECT_EQ(refusal(head + tail),
            "arm.yaml:1: key 'segments': is missing; the arm's segments in series, from base to "
            "tip; at least one; allowed: list of up to 32 sections");
  EXPECT_EQ(refusal(kSmallArm.substr(0, bodies) + "bodies: []\n" + kSmallArm.substr(inputs)),
            "arm.yaml:12: key 'bodies': is empty; an arm needs at least one measured body");
}

/// Entries of a list, each with its number.
std::string entries(int count, const std::string& before, const std::string& after) {
  std::string text;
  for (int i = 0; i < count; ++i) text += before + std::to_string(i) + after;
  return text;
}

TEST(ArmYamlRefusesDocument, MoreEntriesThanAnyArmHas) {
  const std::string rings = "  - {name: ring_1, arclength_m: 0.1}\n";
  const auto with_bodies = [&](int count) {
    return edited(
        rings,
        entries(count, "  - {kind: skin_marker, arclength_m: 0.1, angle_deg: 0, radius_m: 0.02, name: m_",
                "}\n"));
  };
  EXPECT_EQ(refusal(with_bodies(20000)),
            "arm.yaml:12: key 'bodies': has 20001 entries; allowed: list of up to 200 sections");
  EXPECT_EQ(arm::parse_arm(with_bodies(199), "arm.yaml").bodies.size(), 200u);
  const std::string input = "    - {name: chamber_1, topic: /pressure/chamber_1}\n";
  EXPECT_EQ(refusal(edited(input, input + entries(1024, "    - {topic: /p, name: p_", "}\n"))),
            "arm.yaml:16: key 'inputs.pressures': has 1025 entries; allowed: list of up to 1024 sections");
  const std::string chamber =
      "      - {input: chamber_1, bending_direction_deg: 90, moment_gain_nm_per_pa: 6.0e-6}\n";
  EXPECT_EQ(refusal(edited(chamber, entries(65, "      - {input: chamber_", "}\n"))),
            "arm.yaml:10: key 'segments[0].chambers': has 65 entries; allowed: list of up to 64 sections");
  EXPECT_EQ(refusal(edited("bodies:\n", entries(32, "  - {name: s_", "}\n") + "bodies:\n")),
            "arm.yaml:4: key 'segments': has 33 entries; allowed: list of up to 32 sections");
}

TEST(ArmYamlRefusesDocument, DuplicateSegment) {
  const std::string second =
      "  - {name: lower, length_m: 0.1, mass_per_length_kg_m: 1, diameter_m: 0.04, "
      "bending_stiffness: {base_nm2: 0.03}}\nbodies:";
  EXPECT_EQ(refusal(edited("bodies:", second)),
            "arm.yaml:12: key 'segments[1].name': value lower is given to another segment already; names are "
            "unique");
}

TEST(ArmYamlRefusesDocument, EndOrientationWithoutTipOrientation) {
  const std::string end_orientation = edited("method: full_points", "method: end_orientation");
  EXPECT_NO_THROW(arm::parse_arm(end_orientation, "arm.yaml"));
  EXPECT_EQ(refusal(edited(end_orientation, "orientation_usable: true", "orientation_usable: false")),
            "arm.yaml:18: key 'estimator.method': value end_orientation needs a ring at the tip (0.2 m) with "
            "orientation_usable: true");
  // A usable orientation elsewhere is not the tip's.
  EXPECT_NE(refusal(edited(end_orientation, "arclength_m: tip", "arclength_m: 0.19"))
                .find("needs a ring at the tip"),
            std::string::npos);
}

TEST(ArmYamlRefusesDocument, PriorWithoutChambers) {
  const std::string passive = edited(
      "    chambers:\n      - {input: chamber_1, bending_direction_deg: 90, moment_gain_nm_per_pa: 6.0e-6}\n",
      "");
  EXPECT_NO_THROW(arm::parse_arm(passive, "arm.yaml"));
  EXPECT_EQ(refusal(edited(passive, "method: full_points", "prior: {enabled: true}")),
            "arm.yaml:16: key 'estimator.prior.enabled': value true needs segments with chambers, "
            "a central_chamber, tendons or cables");
}

TEST(ArmYamlRefusesDocument, HostileTextStaysOneLine) {
  const std::string folded =
      refusal(edited("length_m: 0.2", "length_m: \"0.2\\n\\tm" + std::string(500, 'x') + "\""));
  EXPECT_LT(folded.size(), 200u);
  EXPECT_NE(folded.find("segments[0].length_m"), std::string::npos);
  refusal(edited("name: small", "\"na\\nme\": small"));
  refusal(edited("name: small", "? [a, b]\n: small"));
  refusal(std::string(5000, '['));
  refusal(std::string("\x00\x01\xff\xfe", 4));
}

TEST(ArmYamlRefusesDocument, EveryTruncationIsRefusedOrRead) {
  // Whatever is cut off, the answer is an arm or one line, never another exception.
  for (std::size_t length = 0; length < kSmallArm.size(); ++length) {
    try {
      arm::parse_arm(kSmallArm.substr(0, length), "arm.yaml");
    } catch (const arm::ArmError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace softarm
