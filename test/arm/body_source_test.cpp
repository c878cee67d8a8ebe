// How drivers are described, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "arm/body_types.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

const std::string kHead = R"(format: 1
name: any_driver
segments:
  - {name: s, length_m: 0.2, mass_per_length_kg_m: 0, diameter_m: 0.04, bending_stiffness: {base_nm2: 0.03}}
)";
const std::string kFixed = "base: {fixed: {attitude: hanging}}\n";
const std::string kRings = "bodies:\n  - {name: ring_1, arclength_m: tip}\n";

arm::Arm parse(const std::string& parts) {
  return arm::parse_arm(kHead + parts, "arm.yaml");
}

TEST(BodySource, DefaultsOfEachType) {
  const arm::Arm vicon =
      parse(kFixed + kRings + "inputs: {bodies: {topic: /vicon/markers, type: vicon_bridge/Markers}}\n");
  EXPECT_EQ(vicon.inputs.bodies.scale_to_m, 1e-3);
  EXPECT_TRUE(vicon.inputs.bodies.labelled);
  const arm::Arm tf =
      parse("base: {body: b}\n" + kRings +
            "inputs: {bodies: {type: tf2_msgs/TFMessage, frame: /world, child_frame: /v/<body>}}\n");
  EXPECT_EQ(tf.inputs.bodies.topic, "/tf");
  EXPECT_EQ(tf.inputs.bodies.frame, "world");
  EXPECT_EQ(tf.inputs.bodies.child_frame, "v/<body>");
  const arm::Arm cloud =
      parse(kFixed + kRings + "inputs: {bodies: {topic: /cloud, type: sensor_msgs/PointCloud, unit: cm}}\n");
  EXPECT_FALSE(cloud.inputs.bodies.labelled);
  EXPECT_EQ(cloud.inputs.bodies.scale_to_m, 1e-2);
}

TEST(BodySource, ThePageOfKeysNamesEveryTypeAndItsUnit) {
  std::ifstream file(SOFTARM_SOURCE_DIR "/config/arms/README.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  for (const arm::yaml::BodyType& row : arm::yaml::body_types()) {
    EXPECT_THAT(page, ::testing::HasSubstr(row.type));
    if (row.unit != "m") {
      EXPECT_THAT(page, ::testing::HasSubstr(row.unit + " for " + row.type));
    }
  }
}

TEST(BodySource, AxesAreTheDriversAlongOurs) {
  const arm::Arm arm = parse(kFixed + kRings + "inputs: {bodies: {axes: x -z y}}\n");
  // The driver's y is up: what it calls (1, 2, 3) is at (1, -3, 2).
  EXPECT_EQ(arm.inputs.bodies.mocap_from_driver * Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, -3, 2));
  EXPECT_EQ(arm.inputs.bodies.mocap_from_driver.determinant(), 1.0);
  EXPECT_EQ(parse(kFixed + kRings + "inputs: {bodies: {axes: x z y}}\n")
                .inputs.bodies.mocap_from_driver.determinant(),
            -1.0);
}

TEST(BodySource, EveryPlaceholderOfATopicIsAllowed) {
  EXPECT_EQ(parse(kFixed + kRings + "inputs: {bodies: {topic: /vicon/<body>/<body>}}\n").inputs.bodies.topic,
            "/vicon/<body>/<body>");
}

TEST(BodySource, FieldsOfOtherMessages) {
  const arm::Arm arm =
      parse(kFixed + kRings +
            "inputs: {pressures: [{name: p, topic: /a, type: my/State, field: \"c[2].p\", stamp: receipt}, "
            "{name: q, topic: /a, type: my/State, field: \"c[3].p\"}]}\n");
  EXPECT_EQ(arm.inputs.scalars[0].field, "c[2].p");
  EXPECT_EQ(arm.inputs.scalars[0].stamp, arm::StampSource::kReceipt);
  EXPECT_EQ(arm.inputs.scalars[1].stamp, arm::StampSource::kHeader);
}

struct Refusal {
  std::string name, parts, message;
};
class BodySourceRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(BodySourceRefuses, WithOneClearLine) {
  try {
    parse(GetParam().parts);
    ADD_FAILURE() << "was accepted";
  } catch (const arm::ArmError& e) {
    EXPECT_THAT(e.what(), ::testing::StartsWith(GetParam().message));
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

const std::string kMarkers = "inputs: {bodies: {topic: /m, type: mocap_base/MarkerList}}\n";

INSTANTIATE_TEST_SUITE_P(
    Drivers, BodySourceRefuses,
    ::testing::Values(
        Refusal{"axes_twice", kFixed + kRings + "inputs: {bodies: {axes: x y x}}\n",
                "arm.yaml:8: key 'inputs.bodies.axes': value x y x does not name the driver's axis"},
        Refusal{"axes_of_two", kFixed + kRings + "inputs: {bodies: {axes: x y}}\n",
                "arm.yaml:8: key 'inputs.bodies.axes': value x y does not name"},
        Refusal{"axes_unknown", kFixed + kRings + "inputs: {bodies: {axes: x y up}}\n",
                "arm.yaml:8: key 'inputs.bodies.axes': value x y up does not name"},
        Refusal{
            "no_topic", kFixed + kRings + "inputs: {bodies: {type: sensor_msgs/PointCloud}}\n",
            "arm.yaml:8: key 'inputs.bodies.topic': is missing; sensor_msgs/PointCloud has no usual topic"},
        Refusal{"body_in_topic_for_all",
                kFixed + kRings + "inputs: {bodies: {topic: /<body>, type: vicon_bridge/Markers}}\n",
                "arm.yaml:8: key 'inputs.bodies.topic': value /<body> contains <body>, but a message of type "
                "vicon_bridge/Markers holds all bodies"},
        Refusal{
            "server_of_vicon",
            kFixed + kRings + "inputs: {bodies: {topic: /m, type: vicon_bridge/Markers, stamp: server}}\n",
            "arm.yaml:8: key 'inputs.bodies.stamp': value server needs a time of the motion capture, which "
            "vicon_bridge/Markers does not carry"},
        Refusal{"child_frame_of_poses", kFixed + kRings + "inputs: {bodies: {child_frame: <body>}}\n",
                "arm.yaml:8: key 'inputs.bodies.child_frame': applies to tf2_msgs/TFMessage only"},
        Refusal{
            "labels_of_a_cloud",
            kFixed + kRings + "inputs: {bodies: {topic: /c, type: sensor_msgs/PointCloud, labels: true}}\n",
            "arm.yaml:8: key 'inputs.bodies.labels': applies to lists of markers only"},
        Refusal{"base_of_points", "base: {body: b}\n" + kRings + kMarkers,
                "arm.yaml:5: key 'base.body': value b needs a pose, but mocap_base/MarkerList has points "
                "only; give "
                "fixed instead, or inputs.base, or three labelled_markers with position_m"},
        Refusal{"base_source_without_body", kFixed + kRings + "inputs: {base: {topic: /<body>}}\n",
                "arm.yaml:8: key 'inputs.base': is given, but base.body is not"},
        Refusal{"tangent_of_points",
                kFixed + "bodies:\n  - {name: r, arclength_m: tip, orientation_usable: true}\n" + kMarkers,
                "arm.yaml:7: key 'bodies[0].orientation_usable': value true needs a pose"},
        Refusal{"labels_of_poses",
                kFixed + "bodies:\n  - {name: r, arclength_m: tip, labelled_markers: [{label: a}]}\n",
                "arm.yaml:7: key 'bodies[0].labelled_markers': need a list of labelled markers, which "
                "geometry_msgs/PoseStamped is not"},
        Refusal{"label_twice",
                kFixed +
                    "bodies:\n  - {name: r, arclength_m: tip, labelled_markers: [{label: a}, {label: a}]}\n" +
                    kMarkers,
                "arm.yaml:7: key 'bodies[0].labelled_markers[1].label': value a is given to another marker "
                "already"},
        Refusal{"some_places",
                kFixed +
                    "bodies:\n  - {name: r, arclength_m: tip, labelled_markers: [{label: a}, {label: b, "
                    "position_m: "
                    "[0, 0, 1]}]}\n" +
                    kMarkers,
                "arm.yaml:7: key 'bodies[0].labelled_markers': have a position_m for some of them"},
        Refusal{"two_places",
                kFixed +
                    "bodies:\n  - {name: r, arclength_m: tip, labelled_markers: [{label: a, position_m: [0, "
                    "0, 0]}, "
                    "{label: b, position_m: [0, 0, 1]}]}\n" +
                    kMarkers,
                "arm.yaml:7: key 'bodies[0].labelled_markers': have positions, but a pose takes 3 of them or "
                "more"},
        Refusal{"places_on_a_line",
                kFixed +
                    "bodies:\n  - {name: r, arclength_m: tip, labelled_markers: [{label: a, position_m: [0, "
                    "0, 0]}, "
                    "{label: b, position_m: [0, 0, 1]}, {label: c, position_m: [0, 0, 2]}]}\n" +
                    kMarkers,
                "arm.yaml:7: key 'bodies[0].labelled_markers': sit on one line, which gives no orientation"},
        Refusal{"circle_of_labels",
                kFixed +
                    "bodies:\n  - {name: r, arclength_m: tip, markers: 3, marker_cluster_radius_m: 0.03}\n" +
                    kMarkers,
                "arm.yaml:7: key 'bodies[0].markers': value 3 applies to points without labels only"},
        Refusal{"type_without_field",
                kFixed + kRings + "inputs: {pressures: [{name: p, topic: /a, type: my/State}]}\n",
                "arm.yaml:8: key 'inputs.pressures[0].type': value my/State is none of: "
                "sensor_msgs/FluidPressure, "
                "std_msgs/Float64, std_msgs/Float32MultiArray, std_msgs/Float64MultiArray; for a message of "
                "another "
                "type give field"},
        Refusal{
            "no_type",
            kFixed + kRings + "inputs: {pressures: [{name: p, topic: /a, type: State, field: a}]}\n",
            "arm.yaml:8: key 'inputs.pressures[0].type': value State is not a message type, package/Name"},
        Refusal{
            "no_field",
            kFixed + kRings + "inputs: {pressures: [{name: p, topic: /a, type: my/State, field: \"a[\"}]}\n",
            "arm.yaml:8: key 'inputs.pressures[0].field': value a[ is not a field of a message"},
        Refusal{"field_of_a_number",
                kFixed + kRings +
                    "inputs: {pressures: [{name: p, topic: /a, type: std_msgs/Float64, field: data}]}\n",
                "arm.yaml:8: key 'inputs.pressures[0].field': does not apply to std_msgs/Float64"},
        Refusal{"element_and_field",
                kFixed + kRings +
                    "inputs: {pressures: [{name: p, topic: /a, type: my/State, field: a, element: 1}]}\n",
                "arm.yaml:8: key 'inputs.pressures[0].element': value 1 is an index of an array, but type "
                "my/State "
                "has a field"}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(FieldsOfMessages, AreNamesAndIndicesHoweverLong) {
  const auto read = [](const std::string& type, const std::string& field) {
    parse(kFixed + kRings + "inputs: {pressures: [{name: p, topic: /a, type: " + type + ", field: \"" +
          field + "\"}]}\n");
  };
  const std::string word(300000, 'a');
  for (const std::string& field : {std::string("a"), std::string("a_1"), std::string("effort[2]"),
                                   std::string("b.c[0].D2[123456]"), word, word + "." + word + "[1]"})
    EXPECT_NO_THROW(read("my/State", field)) << field.substr(0, 20);
  for (const std::string& field :
       {std::string(""), std::string("."), std::string("a."), std::string(".a"), std::string("1a"),
        std::string("_a"), std::string("a[]"), std::string("a[1"), std::string("a[1234567]"),
        std::string("a[1]b"), std::string("a[1][2]"), std::string("[1]"), std::string("a b"), word + "-"})
    EXPECT_THROW(read("my/State", field), arm::ArmError) << field.substr(0, 20);
  EXPECT_NO_THROW(read("my_msgs/" + word, "a"));
  for (const std::string type : {"my/", "/State", "my/State/More", "my/1a", "my-msgs/State"})
    EXPECT_THROW(read(type, "a"), arm::ArmError) << type;
}

}  // namespace
}  // namespace softarm
