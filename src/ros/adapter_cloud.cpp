// Points without identity: sensor_msgs/PointCloud (natnet_ros_cpp), PointCloud2, and the spheres that
// natnet_ros draws of its markers.
#include <sensor_msgs/PointCloud.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "adapters.h"
#include "body_reader.h"
#include "marker_bodies.h"

namespace softarm {
namespace {

using Markers = std::vector<ReportedMarker>;

template <class Points>
std::optional<Markers> markers_at(const Points& points, const BodyReader& reader) {
  Markers markers;
  for (const auto& p : points) markers.push_back({{}, reader.position(p.x, p.y, p.z)});
  return markers;
}

std::optional<Markers> markers_of(const sensor_msgs::PointCloud& message, const BodyReader& reader) {
  return markers_at(message.points, reader);
}

/// Absent where it draws something else than points.
std::optional<Markers> markers_of(const visualization_msgs::Marker& message, const BodyReader& reader) {
  using visualization_msgs::Marker;
  const bool has_points = message.type == Marker::SPHERE_LIST || message.type == Marker::CUBE_LIST ||
                          message.type == Marker::POINTS;
  if (!has_points || message.action != Marker::ADD) return std::nullopt;
  return markers_at(message.points, reader);
}

/// Absent where it has no x, y, z as float32, or fewer bytes than it says.
std::optional<Markers> markers_of(const sensor_msgs::PointCloud2& message, const BodyReader& reader) {
  for (const char* const axis : {"x", "y", "z"}) {
    const bool has = std::any_of(message.fields.begin(), message.fields.end(), [&](const auto& field) {
      return field.name == axis && field.datatype == sensor_msgs::PointField::FLOAT32 &&
             field.offset + sizeof(float) <= message.point_step;
    });
    if (!has) return std::nullopt;
  }
  const std::size_t count = static_cast<std::size_t>(message.width) * message.height;
  if (message.data.size() < count * message.point_step || message.is_bigendian) return std::nullopt;
  Markers markers;
  if (count == 0) return markers;
  sensor_msgs::PointCloud2ConstIterator<float> x(message, "x"), y(message, "y"), z(message, "z");
  for (std::size_t i = 0; i < count; ++i, ++x, ++y, ++z) markers.push_back({{}, reader.position(*x, *y, *z)});
  return markers;
}

template <class Message>
std::vector<InputTopic> cloud_topic(const arm::Arm& arm, const arm::BodySource& source,
                                    const Bodies& bodies) {
  const auto convert = [reader = BodyReader(source), sink = associated_bodies(arm)](
                           const Message& message, double receipt_s, trial::FrameAssembler& assembler) {
    if (!reader.reads(message.header.frame_id)) return assembler.count_rejected("other_frame", "markers");
    const std::optional<Markers> markers = markers_of(message, reader);
    if (!markers) return assembler.count_rejected("no_points", "markers");
    sink(reader.stamp_s(message.header.stamp.toSec(), receipt_s), *markers, assembler);
  };
  return {make_input_topic<Message>(source.topic, names_of(bodies), convert)};
}

}  // namespace

std::vector<InputTopic> point_cloud_topics(const arm::Arm& arm, const arm::BodySource& source,
                                           const Bodies& bodies) {
  return cloud_topic<sensor_msgs::PointCloud>(arm, source, bodies);
}

std::vector<InputTopic> point_cloud2_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return cloud_topic<sensor_msgs::PointCloud2>(arm, source, bodies);
}

std::vector<InputTopic> drawn_points_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return cloud_topic<visualization_msgs::Marker>(arm, source, bodies);
}

}  // namespace softarm
