// One topic per body, each message one pose or point of it.
#pragma once

#include <geometry_msgs/Quaternion.h>

#include <optional>
#include <vector>

#include "body_driver.h"
#include "body_reader.h"
#include "conversions.h"

namespace softarm {

/// What a message says, as the driver says it.
struct BodySample {
  Eigen::Vector3d p;
  std::optional<Eigen::Quaterniond> q;
};

template <class Vector>
Eigen::Vector3d vector_of(const Vector& v) {
  return {v.x, v.y, v.z};
}

inline Eigen::Quaterniond quaternion_of(const geometry_msgs::Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

/// @tparam sample_of reads a message, which has a header
template <class Message, BodySample (*sample_of)(const Message&)>
std::vector<InputTopic> topic_per_body(const arm::Arm&, const arm::BodySource& source, const Bodies& bodies) {
  std::vector<InputTopic> topics;
  for (const auto& [body_name, body] : bodies) {
    const std::string name = body_name;
    const int index = body;
    const auto convert = [reader = BodyReader(source), name, index](
                             const Message& message, trial::Stamp receipt, trial::FrameAssembler& assembler) {
      if (!reader.reads(message.header.frame_id)) return assembler.count_rejected("other_frame", name);
      const BodySample sample = sample_of(message);
      std::optional<Eigen::Quaterniond> q;
      if (sample.q) q = reader.orientation(*sample.q);
      assembler.add_body(index, reader.stamp(to_stamp(message.header.stamp), receipt),
                         reader.position(sample.p.x(), sample.p.y(), sample.p.z()), q);
    };
    topics.push_back(make_input_topic<Message>(with_body(source.topic, name), name, convert));
  }
  return topics;
}

}  // namespace softarm
