#include "bag_writer.h"

#include <ros/message_traits.h>
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/String.h>

#include <boost/make_shared.hpp>

#include "conversions.h"
#include "open_bag.h"

namespace softarm {

TrialBagWriter::TrialBagWriter(const std::string& file, const std::string& called)
    : path_(called.empty() ? file : called) {
  written(path_, [&] {
    bag_ = new_bag(file);
    bag_->setCompression(rosbag::compression::LZ4);
  });
}

void TrialBagWriter::close() {
  written(path_, [&] { bag_->close(); });
}

std_msgs::Header TrialBagWriter::header(const std::string& topic, trial::Stamp stamp,
                                        const std::string& frame) {
  std_msgs::Header h;
  h.seq = sequence_[topic]++;
  h.stamp = to_time(stamp.ns);
  h.frame_id = frame;
  return h;
}

template <typename Message>
void TrialBagWriter::write(const std::string& topic, trial::Stamp receipt, const Message& message,
                           bool latched) {
  // The connection header that roscpp would send; `latching` makes rosbag play latch the topic again.
  const auto connection = boost::make_shared<ros::M_string>();
  (*connection)["topic"] = topic;
  (*connection)["type"] = ros::message_traits::datatype<Message>();
  (*connection)["md5sum"] = ros::message_traits::md5sum<Message>();
  (*connection)["message_definition"] = ros::message_traits::definition<Message>();
  if (latched) (*connection)["latching"] = "1";
  written(path_, [&] { bag_->write(topic, to_time(receipt.ns), message, connection); });
  ++messages_;
}

void TrialBagWriter::pose(const std::string& body, trial::Stamp stamp, const Eigen::Vector3d& p_mocap,
                          const Eigen::Quaterniond& q_mocap, std::optional<trial::Stamp> receipt) {
  const std::string topic = "/mocap/" + body + "/pose";
  geometry_msgs::PoseStamped m;
  m.header = header(topic, stamp, "mocap");
  m.pose.position.x = p_mocap.x();
  m.pose.position.y = p_mocap.y();
  m.pose.position.z = p_mocap.z();
  m.pose.orientation.x = q_mocap.x();
  m.pose.orientation.y = q_mocap.y();
  m.pose.orientation.z = q_mocap.z();
  m.pose.orientation.w = q_mocap.w();
  write(topic, receipt.value_or(stamp), m);
}

void TrialBagWriter::pressure(const std::string& topic, trial::Stamp stamp, double absolute_pa,
                              std::optional<trial::Stamp> receipt) {
  sensor_msgs::FluidPressure m;
  m.header = header(topic, stamp, "");
  m.fluid_pressure = absolute_pa;
  m.variance = 0.0;  // unknown, by the message's definition
  write(topic, receipt.value_or(stamp), m);
}

void TrialBagWriter::scalar(const std::string& topic, trial::Stamp receipt, double value) {
  std_msgs::Float64 m;
  m.data = value;
  write(topic, receipt, m);
}

void TrialBagWriter::payload(trial::Stamp stamp, double kg) {
  std_msgs::Float64 m;
  m.data = kg;
  // Readers order messages by their times, in no certain order where these are equal: recorded a microsecond
  // before the poses of its stamp, it is known when they come.
  write("/payload", stamp.earlier(1e-6), m, true);
}

namespace {

template <class Message, class = decltype(Message::header)>
std_msgs::Header* header_in(Message& message, int) {
  return &message.header;
}
template <class Message>
std_msgs::Header* header_in(Message&, long) {
  return nullptr;
}

}  // namespace

void TrialBagWriter::message(const LabMessage& message, trial::Stamp receipt) {
  std::visit(
      [&](auto content) {
        if (std_msgs::Header* stamped = header_in(content, 0)) stamped->seq = sequence_[message.topic]++;
        write(message.topic, message.latched ? receipt.earlier(1e-6) : receipt, content, message.latched);
      },
      message.content);
}

void TrialBagWriter::import_layout(trial::Stamp stamp, const std::string& text) {
  std_msgs::String m;
  m.data = text;
  write(kImportLayoutTopic, stamp, m, true);
}

void TrialBagWriter::left_out(double from_s, double to_s) {
  std_msgs::Float64MultiArray m;
  m.data = {from_s, to_s};
  write(kImportLeftOutTopic, to_s, m);
}

}  // namespace softarm
