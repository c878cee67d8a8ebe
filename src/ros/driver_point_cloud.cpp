// sensor_msgs/PointCloud of natnet_ros_cpp.
#include <sensor_msgs/PointCloud.h>

#include "cloud_topics.h"

namespace softarm {
namespace {

std::optional<Markers> cloud_markers(const sensor_msgs::PointCloud& message, const BodyReader& reader) {
  return markers_at(message.points, reader);
}

}  // namespace

BodyDriver driver_point_cloud() {
  return {cloud_topic<sensor_msgs::PointCloud, cloud_markers>};
}

}  // namespace softarm
