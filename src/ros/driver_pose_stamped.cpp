// geometry_msgs/PoseStamped of vrpn_client_ros, mocap_optitrack, natnet, mocap_qualisys.
#include <geometry_msgs/PoseStamped.h>

#include "pose_topics.h"

namespace softarm {
namespace {

BodySample pose_sample(const geometry_msgs::PoseStamped& message) {
  return {vector_of(message.pose.position), quaternion_of(message.pose.orientation)};
}

}  // namespace

BodyDriver driver_pose_stamped() {
  return {topic_per_body<geometry_msgs::PoseStamped, pose_sample>};
}

}  // namespace softarm
