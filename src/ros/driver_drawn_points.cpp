// visualization_msgs/Marker: the spheres that natnet_ros draws of its markers.
#include <visualization_msgs/Marker.h>

#include "cloud_topics.h"

namespace softarm {
namespace {

/// Absent where it draws something else than points.
std::optional<Markers> drawn_markers(const visualization_msgs::Marker& message, const BodyReader& reader) {
  using visualization_msgs::Marker;
  const bool has_points = message.type == Marker::SPHERE_LIST || message.type == Marker::CUBE_LIST ||
                          message.type == Marker::POINTS;
  if (!has_points || message.action != Marker::ADD) return std::nullopt;
  return markers_at(message.points, reader);
}

}  // namespace

BodyDriver driver_drawn_points() {
  return {cloud_topic<visualization_msgs::Marker, drawn_markers>};
}

}  // namespace softarm
