// geometry_msgs/TransformStamped of vicon_bridge.
#include <geometry_msgs/TransformStamped.h>

#include "pose_topics.h"

namespace softarm {
namespace {

BodySample transform_sample(const geometry_msgs::TransformStamped& message) {
  return {vector_of(message.transform.translation), quaternion_of(message.transform.rotation)};
}

}  // namespace

BodyDriver driver_transform_stamped() {
  return {topic_per_body<geometry_msgs::TransformStamped, transform_sample>};
}

}  // namespace softarm
