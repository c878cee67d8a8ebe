// geometry_msgs/PointStamped of natnet.
#include <geometry_msgs/PointStamped.h>

#include "pose_topics.h"

namespace softarm {
namespace {

BodySample point_sample(const geometry_msgs::PointStamped& message) {
  return {vector_of(message.point), std::nullopt};
}

}  // namespace

BodyDriver driver_point_stamped() {
  return {topic_per_body<geometry_msgs::PointStamped, point_sample>};
}

}  // namespace softarm
