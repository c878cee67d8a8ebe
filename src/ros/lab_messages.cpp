#include "lab_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "arm/body_types.h"
#include "body_reader.h"
#include "conversions.h"

namespace softarm {
namespace {

using arm::yaml::BodyMessage;

const char* const kMocapFrame = "mocap";

bool is_array(const arm::ScalarInput& input) {
  return input.type.find("MultiArray") != std::string::npos;
}

void refuse_bodies(const arm::BodySource& source, double latency_s, const std::string& key) {
  const BodyMessage message = arm::yaml::body_type(source.type).message;
  if (message == BodyMessage::kMarkers || message == BodyMessage::kCloud)
    throw std::invalid_argument(fmt::format(
        "key '{}.type': value {} has no counterpart in the virtual rig, which sends poses and points of "
        "bodies; geometry_msgs/PoseStamped has",
        key, source.type));
  if (source.stamp == arm::StampSource::kReceipt && latency_s != 0.0)
    throw std::invalid_argument(fmt::format(
        "key '{}.latency_s': value {} beside stamp: receipt has no counterpart in the virtual rig; 0 has",
        key, latency_s));
}

void refuse_scalar(const arm::ScalarInput& input) {
  if (!input.field.empty())
    throw std::invalid_argument(fmt::format(
        "key 'inputs', input '{}': a field of {} has no counterpart in the virtual rig, which sends "
        "messages that are numbers; std_msgs/Float64 has",
        input.name, input.type));
  const bool stamped = input.type == "sensor_msgs/FluidPressure" && input.stamp == arm::StampSource::kHeader;
  if (input.latency_s != 0.0 && !stamped)
    throw std::invalid_argument(fmt::format(
        "key 'inputs', input '{}': latency_s {} of what has no stamp has no counterpart in the virtual "
        "rig; 0 has",
        input.name, input.latency_s));
}

std_msgs::Header header_of(ros::Time stamp, double latency_s, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = latency_s == 0.0 ? stamp : stamp + ros::Duration(latency_s);
  header.frame_id = frame;
  return header;
}

/// A body's pose as the driver says it: what BodyReader undoes.
geometry_msgs::Pose driver_pose(const arm::BodySource& source, const Eigen::Vector3d& p,
                                const Eigen::Quaterniond& q) {
  const Eigen::Matrix3d& axes = source.mocap_from_driver;
  const bool mirrored = axes.determinant() < 0.0;
  const Eigen::Quaterniond turn(Eigen::Matrix3d(mirrored ? Eigen::Matrix3d(-axes) : axes));
  const Eigen::Vector3d p_driver = axes.transpose() * p / source.scale_to_m;
  const Eigen::Quaterniond q_driver = mirrored ? turn.conjugate() * q * turn : turn.conjugate() * q;
  return to_pose(p_driver, q_driver);
}

geometry_msgs::TransformStamped transform_of(const std_msgs::Header& header, const std::string& child,
                                             const geometry_msgs::Pose& pose) {
  geometry_msgs::TransformStamped message;
  message.header = header;
  message.child_frame_id = child;
  message.transform.translation.x = pose.position.x;
  message.transform.translation.y = pose.position.y;
  message.transform.translation.z = pose.position.z;
  message.transform.rotation = pose.orientation;
  return message;
}

template <class Message>
Message array_of(const std::vector<double>& values) {
  Message message;
  for (double value : values)
    message.data.push_back(static_cast<typename decltype(message.data)::value_type>(value));
  return message;
}

}  // namespace

LabMessages::LabMessages(const arm::Inputs& inputs, std::vector<std::size_t> driven)
    : inputs_(inputs), driven_(std::move(driven)) {
  refuse_bodies(inputs_.bodies, inputs_.body_latency_s, "inputs.bodies");
  if (inputs_.base) refuse_bodies(*inputs_.base, inputs_.body_latency_s, "inputs.base");
  for (std::size_t i : driven_) {
    const arm::ScalarInput& input = inputs_.scalars.at(i);
    refuse_scalar(input);
    if (!is_array(input)) continue;
    Array& array = arrays_[input.topic];
    array.last_input = i;
    array.values.resize(std::max(array.values.size(), static_cast<std::size_t>(input.element) + 1), 0.0);
  }
}

LabMessage LabMessages::body(const std::string& name, bool is_base, ros::Time stamp,
                             const Eigen::Vector3d& p_mocap, const Eigen::Quaterniond& q_mocap) const {
  const arm::BodySource& source = is_base && inputs_.base ? *inputs_.base : inputs_.bodies;
  const std_msgs::Header header =
      header_of(stamp, inputs_.body_latency_s, source.frame.empty() ? kMocapFrame : source.frame);
  const geometry_msgs::Pose pose = driver_pose(source, p_mocap, q_mocap);
  LabMessage message{with_body(source.topic, name), {}};
  if (source.type == "geometry_msgs/TransformStamped") {
    message.content = transform_of(header, name, pose);
  } else if (source.type == "tf2_msgs/TFMessage") {
    tf2_msgs::TFMessage tf;
    tf.transforms.push_back(transform_of(header, with_body(source.child_frame, name), pose));
    message.content = tf;
  } else if (source.type == "nav_msgs/Odometry") {
    nav_msgs::Odometry odometry;
    odometry.header = header;
    odometry.child_frame_id = name;
    odometry.pose.pose = pose;
    message.content = odometry;
  } else if (source.type == "geometry_msgs/PointStamped") {
    geometry_msgs::PointStamped point;
    point.header = header;
    point.point = pose.position;
    message.content = point;
  } else {
    geometry_msgs::PoseStamped stamped;
    stamped.header = header;
    stamped.pose = pose;
    message.content = stamped;
  }
  return message;
}

std::optional<LabMessage> LabMessages::scalar(std::size_t input, ros::Time stamp, double value) {
  const arm::ScalarInput& source = inputs_.scalars.at(input);
  const bool pressure = source.kind == arm::InputKind::kPressure || source.kind == arm::InputKind::kVacuum;
  if (pressure && source.reference == arm::PressureReference::kGauge) value -= inputs_.ambient_pressure_pa;
  value = (value + source.zero_si) / source.scale_to_si;
  LabMessage message{source.topic, {}};
  if (source.type == "sensor_msgs/FluidPressure") {
    sensor_msgs::FluidPressure fluid;
    fluid.header = header_of(stamp, source.latency_s, "");
    fluid.fluid_pressure = value;
    fluid.variance = 0.0;  // unknown, by the message's definition
    message.content = fluid;
  } else if (is_array(source)) {
    Array& array = arrays_.at(source.topic);
    array.values.at(static_cast<std::size_t>(source.element)) = value;
    if (array.last_input != input) return std::nullopt;
    if (source.type == "std_msgs/Float32MultiArray")
      message.content = array_of<std_msgs::Float32MultiArray>(array.values);
    else
      message.content = array_of<std_msgs::Float64MultiArray>(array.values);
  } else {
    std_msgs::Float64 number;
    number.data = value;
    message.content = number;
  }
  return message;
}

std::vector<LabMessage> LabMessages::blank_scalars() const {
  std::vector<LabMessage> messages;
  LabMessages copy = *this;
  for (std::size_t input : driven_)
    if (auto message = copy.scalar(input, ros::Time(), 0.0)) messages.push_back(std::move(*message));
  return messages;
}

LabMessage LabMessages::payload(double kg) const {
  std_msgs::Float64 number;
  number.data = kg;
  return {inputs_.payload_topic, number, true};
}

}  // namespace softarm
