// sensor_msgs/PointCloud2 of natnet_ros.
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>

#include "cloud_topics.h"

namespace softarm {
namespace {

/// Absent where it has no x, y, z as float32, or fewer bytes than it says.
std::optional<Markers> cloud2_markers(const sensor_msgs::PointCloud2& message, const BodyReader& reader) {
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

}  // namespace

BodyDriver driver_point_cloud2() {
  return {cloud_topic<sensor_msgs::PointCloud2, cloud2_markers>};
}

}  // namespace softarm
