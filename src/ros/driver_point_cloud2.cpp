// sensor_msgs/PointCloud2 of natnet_ros.
#include <sensor_msgs/PointCloud2.h>

#include <algorithm>
#include <cstring>

#include "cloud_topics.h"

namespace softarm {
namespace {

/// Where in a point a coordinate begins; absent where it is no float32, or not in the point.
std::optional<std::size_t> place_of(const char* axis, const sensor_msgs::PointCloud2& message) {
  const auto field = std::find_if(message.fields.begin(), message.fields.end(),
                                  [&](const sensor_msgs::PointField& f) { return f.name == axis; });
  if (field == message.fields.end() || field->datatype != sensor_msgs::PointField::FLOAT32 ||
      field->offset + sizeof(float) > message.point_step)
    return std::nullopt;
  return field->offset;
}

/// Absent where it has no x, y, z as float32, or fewer bytes than it says.
std::optional<Markers> cloud2_markers(const sensor_msgs::PointCloud2& message, const BodyReader& reader) {
  const auto x = place_of("x", message), y = place_of("y", message), z = place_of("z", message);
  if (!x || !y || !z || message.is_bigendian) return std::nullopt;
  const std::uint64_t count = std::uint64_t{message.width} * message.height;
  if (count > message.data.size() / message.point_step) return std::nullopt;
  Markers markers;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* const point = message.data.data() + i * message.point_step;
    const auto at = [&](std::size_t place) {
      float value;
      std::memcpy(&value, point + place, sizeof(value));  // points may be packed
      return value;
    };
    markers.push_back({{}, reader.position(at(*x), at(*y), at(*z))});
  }
  return markers;
}

}  // namespace

BodyDriver driver_point_cloud2() {
  return {cloud_topic<sensor_msgs::PointCloud2, cloud2_markers>};
}

}  // namespace softarm
