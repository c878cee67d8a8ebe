#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/PointCloud.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "ros/body_driver.h"
#include "ros/drivers_support.h"
#include "ros/input_topics.h"
#include "softarm/arm/arm_file.h"
#include "targets.h"
#include "trial/frame_assembler.h"

namespace softarm::fuzz {
namespace {

/// An arm per source of bodies, and one with all kinds of inputs.
const std::vector<arm::Arm>& arms() {
  static const std::vector<arm::Arm> list = [] {
    const std::string fixed = drivers::kFixedBase;
    const std::string labelled = R"(bodies:
  - {name: ring_1, arclength_m: 0.1, labelled_markers: [{label: "7"}, {label: "9"}]}
  - {name: ring_2, arclength_m: tip, labelled_markers: [{label: "8"}]}
)";
    const auto bodies = [](const std::string& more) { return "inputs: {bodies: {" + more + "}}\n"; };
    std::vector<arm::Arm> made;
    for (const std::string& parts : {
             bodies("topic: /b/<body>, frame: world, axes: x -z y"),
             bodies("topic: /b/<body>, type: geometry_msgs/TransformStamped"),
             bodies("topic: /b/<body>, type: nav_msgs/Odometry"),
             fixed + bodies("topic: /b/<body>, type: geometry_msgs/PointStamped"),
             bodies("topic: /tf, type: tf2_msgs/TFMessage, child_frame: \"v/<body>\""),
             fixed + labelled + bodies("topic: /m, type: vicon_bridge/Markers"),
             fixed + labelled + bodies("topic: /m, type: mocap_base/MarkerList"),
             fixed + labelled + bodies("topic: /m, type: phasespace_msgs/Markers, stamp: server"),
             fixed + labelled + bodies("topic: /m, type: phasespace_msgs/MarkersStamped"),
             fixed + bodies("topic: /c, type: sensor_msgs/PointCloud"),
             fixed + bodies("topic: /c, type: sensor_msgs/PointCloud2"),
             fixed + bodies("topic: /c, type: visualization_msgs/Marker"),
             fixed + std::string(R"(inputs:
  bodies: {topic: /b/<body>}
  pressures:
    - {name: chamber_1, topic: /p1}
    - {name: chamber_2, topic: /p2, type: std_msgs/Float32MultiArray, element: 1, unit: kPa, reference: gauge}
    - {name: chamber_3, topic: /p3, type: std_msgs/Float64MultiArray, element: 3}
    - {name: chamber_4, topic: /p4, type: std_msgs/Float64, unit: mbar}
    - {name: core, topic: /p5, type: my_rig_msgs/State, field: "channels[2].pressure", unit: bar, vacuum: true}
  tensions:
    - {name: tendon_1, topic: /p6, type: sensor_msgs/JointState, field: "effort[0]", stamp: header}
)"),
         })
      made.push_back(drivers::arm_with(parts));
    return made;
  }();
  return list;
}

template <class... Messages>
std::map<std::string, Mirror> definitions_of() {
  return {{ros::message_traits::DataType<Messages>::value(), mirror<Messages>()}...};
}

/// Of the types that are built in.
const std::map<std::string, Mirror>& built_in_definitions() {
  static const auto list =
      definitions_of<geometry_msgs::PoseStamped, geometry_msgs::TransformStamped, nav_msgs::Odometry,
                     geometry_msgs::PointStamped, tf2_msgs::TFMessage, sensor_msgs::PointCloud,
                     sensor_msgs::PointCloud2, visualization_msgs::Marker, sensor_msgs::FluidPressure,
                     std_msgs::Float32MultiArray, std_msgs::Float64MultiArray, std_msgs::Float64>();
  return list;
}

/// What is said of a type that is not built in: a definition, or none, as if by a publisher of the mirror.
Mirror said_definition(const std::string& type, const std::string& definition) {
  const auto driver = body_drivers().find(type);
  if (definition.empty() && driver != body_drivers().end() && driver->second.mirror)
    return {driver->second.mirror->md5, ""};
  return {"0123456789abcdef0123456789abcdef", definition};
}

void feed(const arm::Arm& arm, const InputTopic& topic, const Mirror& type, const char* bytes,
          std::size_t size) {
  trial::FrameAssembler assembler(arm);
  topic.read({topic.topic, topic.type, type.md5, type.definition, ros::Time(1000.0), {bytes, bytes + size}},
             assembler);
  assembler.flush();
  assembler.take();
}

}  // namespace

void message(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return;
  const arm::Arm& arm = arms()[data[0] % arms().size()];
  static const std::vector<std::vector<InputTopic>> topics = [] {
    std::vector<std::vector<InputTopic>> list;
    for (const arm::Arm& a : arms()) list.push_back(input_topics(a));
    return list;
  }();
  const std::vector<InputTopic>& all = topics[data[0] % arms().size()];
  InputTopic topic = all[data[1] % all.size()];
  const char* bytes = reinterpret_cast<const char*>(data) + 2;
  std::size_t left = size - 2;
  const auto built_in = built_in_definitions().find(topic.type);
  const bool is_built_in = built_in != built_in_definitions().end();
  Mirror type = is_built_in ? built_in->second : Mirror();
  if (!is_built_in) {
    const char* end = std::find(bytes, bytes + left, '\0');
    type = said_definition(topic.type, std::string(bytes, end));
    left -= static_cast<std::size_t>(end - bytes);
    bytes = end;
    if (left > 0) ++bytes, --left;
    topic = input_topics(arm)[data[1] % all.size()];  // a topic keeps definitions by their MD5 sums
  }
  feed(arm, topic, type, bytes, left);
}

}  // namespace softarm::fuzz
