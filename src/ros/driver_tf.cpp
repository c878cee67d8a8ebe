// tf: the bodies are child frames among those of everybody else (vicon_bridge, mocap_optitrack,
// natnet_ros_cpp).
#include <tf2_msgs/TFMessage.h>

#include <map>

#include "body_driver.h"
#include "body_reader.h"
#include "conversions.h"

namespace softarm {
namespace {

std::vector<InputTopic> tf_topics(const arm::Arm&, const arm::BodySource& source, const Bodies& bodies) {
  std::map<std::string, std::pair<std::string, int>> by_frame;
  for (const auto& [name, index] : bodies) by_frame[with_body(source.child_frame, name)] = {name, index};
  const auto convert = [reader = BodyReader(source), by_frame](const tf2_msgs::TFMessage& message,
                                                               trial::Stamp receipt,
                                                               trial::FrameAssembler& assembler) {
    for (const geometry_msgs::TransformStamped& transform : message.transforms) {
      const auto found = by_frame.find(without_slash(transform.child_frame_id));
      if (found == by_frame.end()) continue;
      const auto& [name, index] = found->second;
      if (!reader.reads(transform.header.frame_id)) {
        assembler.count_rejected("other_frame", name);
        continue;
      }
      const auto& p = transform.transform.translation;
      const auto& q = transform.transform.rotation;
      assembler.add_body(index, reader.stamp(to_stamp(transform.header.stamp), receipt),
                         reader.position(p.x, p.y, p.z),
                         reader.orientation(Eigen::Quaterniond(q.w, q.x, q.y, q.z)));
    }
  };
  InputTopic topic = make_input_topic<tf2_msgs::TFMessage>(source.topic, names_of(bodies), convert);
  topic.other_types = {"tf/tfMessage"};  // the same message, in old bags
  topic.many_publish = true;
  return {topic};
}

}  // namespace

BodyDriver driver_tf() {
  return {tf_topics};
}

}  // namespace softarm
