// The messages of motion-capture drivers, as far as an arm file must know them.
#pragma once

#include <string>
#include <vector>

namespace softarm::arm::yaml {

enum class BodyMessage {
  kPose,     ///< a pose of one body per topic
  kPoint,    ///< a position of one body per topic
  kFrames,   ///< tf: poses of all bodies on one topic
  kMarkers,  ///< labelled points on one topic
  kCloud,    ///< points without labels on one topic
};

struct BodyType {
  std::string type;
  BodyMessage message;
  std::string unit;  ///< in which drivers send it
  bool server_time;  ///< carries the time of the motion capture itself
};

// The table of the drivers' messages: row(name, type, message, unit, server_time). Arm files are checked
// against these rows; ros/ makes its table of converters of the same ones, <name> by driver_<name>() of a
// file there.
// clang-format off
#define SOFTARM_BODY_TYPES(row)                                                                  \
  row(pose_stamped,       "geometry_msgs/PoseStamped",      BodyMessage::kPose,    "m",  false) \
  row(transform_stamped,  "geometry_msgs/TransformStamped", BodyMessage::kPose,    "m",  false) \
  row(odometry,           "nav_msgs/Odometry",              BodyMessage::kPose,    "m",  false) \
  row(point_stamped,      "geometry_msgs/PointStamped",     BodyMessage::kPoint,   "m",  false) \
  row(tf,                 "tf2_msgs/TFMessage",             BodyMessage::kFrames,  "m",  false) \
  row(vicon_markers,      "vicon_bridge/Markers",           BodyMessage::kMarkers, "mm", false) \
  row(mocap_markers,      "mocap_base/MarkerList",          BodyMessage::kMarkers, "m",  false) \
  row(phasespace,         "phasespace_msgs/Markers",        BodyMessage::kMarkers, "m",  true)  \
  row(phasespace_stamped, "phasespace_msgs/MarkersStamped", BodyMessage::kMarkers, "m",  true)  \
  row(point_cloud,        "sensor_msgs/PointCloud",         BodyMessage::kCloud,   "m",  false) \
  row(point_cloud2,       "sensor_msgs/PointCloud2",        BodyMessage::kCloud,   "m",  false) \
  row(drawn_points,       "visualization_msgs/Marker",      BodyMessage::kCloud,   "m",  false)
// clang-format on

/// Every type that Inputs::bodies may have, in the table's order.
const std::vector<BodyType>& body_types();
const BodyType& body_type(const std::string& type);

}  // namespace softarm::arm::yaml
