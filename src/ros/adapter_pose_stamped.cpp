// geometry_msgs/PoseStamped, one topic per body: vrpn_client_ros, mocap_optitrack, natnet, mocap_qualisys.
#include <geometry_msgs/PoseStamped.h>

#include "adapters.h"

namespace softarm {

std::vector<InputTopic> pose_stamped_topics(const Arm& arm) {
  std::vector<InputTopic> topics;
  const double scale = arm.inputs.body_scale_to_m;
  for (const auto& [name, body] : body_indices(arm)) {
    const int index = body;
    const auto convert = [scale, index](const geometry_msgs::PoseStamped& message, double,
                                        FrameAssembler& assembler) {
      const auto& p = message.pose.position;
      const auto& q = message.pose.orientation;
      assembler.add_body(index, message.header.stamp.toSec(), scale * Eigen::Vector3d(p.x, p.y, p.z),
                         Eigen::Quaterniond(q.w, q.x, q.y, q.z));
    };
    topics.push_back(make_input_topic<geometry_msgs::PoseStamped>(body_topic(arm, name), name, convert));
  }
  return topics;
}

}  // namespace softarm
