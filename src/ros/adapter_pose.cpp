// One topic per body: poses (PoseStamped of vrpn_client_ros, mocap_optitrack, natnet, mocap_qualisys;
// TransformStamped of vicon_bridge; Odometry of mocap_optitrack, mocap_qualisys) and points (PointStamped of
// natnet).
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>

#include "adapters.h"
#include "body_reader.h"

namespace softarm {
namespace {

/// What a message says, as the driver says it.
struct Sample {
  Eigen::Vector3d p;
  std::optional<Eigen::Quaterniond> q;
};

template <class Vector>
Eigen::Vector3d vector_of(const Vector& v) {
  return {v.x, v.y, v.z};
}

Eigen::Quaterniond quaternion_of(const geometry_msgs::Quaternion& q) {
  return {q.w, q.x, q.y, q.z};
}

Sample sample_of(const geometry_msgs::PoseStamped& message) {
  return {vector_of(message.pose.position), quaternion_of(message.pose.orientation)};
}

Sample sample_of(const geometry_msgs::TransformStamped& message) {
  return {vector_of(message.transform.translation), quaternion_of(message.transform.rotation)};
}

/// The covariance is that of the driver's own filter, correlated in time: the arm file's noise stands.
Sample sample_of(const nav_msgs::Odometry& message) {
  return {vector_of(message.pose.pose.position), quaternion_of(message.pose.pose.orientation)};
}

Sample sample_of(const geometry_msgs::PointStamped& message) {
  return {vector_of(message.point), std::nullopt};
}

template <class Message>
std::vector<InputTopic> topic_per_body(const arm::BodySource& source, const Bodies& bodies) {
  std::vector<InputTopic> topics;
  for (const auto& [body_name, body] : bodies) {
    const std::string name = body_name;
    const int index = body;
    const auto convert = [reader = BodyReader(source), name, index](const Message& message, double receipt_s,
                                                                    trial::FrameAssembler& assembler) {
      if (!reader.reads(message.header.frame_id)) return assembler.count_rejected("other_frame", name);
      const Sample sample = sample_of(message);
      std::optional<Eigen::Quaterniond> q;
      if (sample.q) q = reader.orientation(*sample.q);
      assembler.add_body(index, reader.stamp_s(message.header.stamp.toSec(), receipt_s),
                         reader.position(sample.p.x(), sample.p.y(), sample.p.z()), q);
    };
    topics.push_back(make_input_topic<Message>(with_body(source.topic, name), name, convert));
  }
  return topics;
}

}  // namespace

std::vector<InputTopic> pose_stamped_topics(const arm::Arm&, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return topic_per_body<geometry_msgs::PoseStamped>(source, bodies);
}

std::vector<InputTopic> transform_stamped_topics(const arm::Arm&, const arm::BodySource& source,
                                                 const Bodies& bodies) {
  return topic_per_body<geometry_msgs::TransformStamped>(source, bodies);
}

std::vector<InputTopic> odometry_topics(const arm::Arm&, const arm::BodySource& source,
                                        const Bodies& bodies) {
  return topic_per_body<nav_msgs::Odometry>(source, bodies);
}

std::vector<InputTopic> point_stamped_topics(const arm::Arm&, const arm::BodySource& source,
                                             const Bodies& bodies) {
  return topic_per_body<geometry_msgs::PointStamped>(source, bodies);
}

}  // namespace softarm
