// One topic that an arm listens to: the same conversion serves the live node and the reader of bags.
#pragma once

#include <ros/message_event.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bag_message.h"
#include "checked_message.h"
#include "conversions.h"
#include "trial/frame_assembler.h"

namespace softarm {

/// How many messages of a topic may wait: 4 s at 240 Hz.
constexpr std::uint32_t kSubscriberQueue = 1000;

/// Called after a live message has been added or rejected, with its header (null if the type has none, or the
/// message cannot be read) and the name of the node that published it.
using OnMessage = std::function<void(const std_msgs::Header*, const std::string&)>;

/// What became of a message of a bag.
enum class BagReading {
  kAdded,            ///< it was read; samples that are none are counted as rejected
  kOtherDefinition,  ///< it was not: it has another type, or its type another definition
  kUndecodable       ///< its bytes do not fit its definition: counted as rejected, "undecodable <feeds>"
};

/// A topic, its type, and what to do with its messages.
struct InputTopic {
  std::string topic;
  std::string type;                      ///< ROS type, "geometry_msgs/PoseStamped"
  std::string md5 = {};                  ///< of the definition that is read; empty: the one that comes along
  std::string feeds;                     ///< for people: "ring_1", "chamber_1, chamber_2", "payload"
  std::vector<std::string> other_types;  ///< that old recordings have for the same message
  bool feeds_base = false;               ///< the base's body
  bool feeds_bodies = false;             ///< measured bodies
  bool many_publish = false;             ///< several publishers are usual on it
  bool has_type(const std::string& name) const {
    return name == type || std::find(other_types.begin(), other_types.end(), name) != other_types.end();
  }
  /// Adds one message of a bag to the assembler.
  std::function<BagReading(const BagMessage&, trial::FrameAssembler&)> read;
  /// Subscribes; the assembler must outlive the subscriber.
  std::function<ros::Subscriber(ros::NodeHandle&, trial::FrameAssembler&, OnMessage)> subscribe;
};

/// Stamp of a message without a header: when it was received (ROS time, or the time of the bag's record).
/// Where the bodies' stamps are of another clock (a bag replayed without simulated time, a driver with its
/// own epoch), it is the newest of theirs. Zero (no clock yet) stays zero.
trial::Stamp headerless_stamp(trial::Stamp receipt, const trial::FrameAssembler& assembler);

template <class Message>
using LiveEvent = ros::MessageEvent<CheckedMessage<Message> const>;

/// What roscpp calls with each message of a live topic. One that cannot be read is counted as rejected:
/// "undecodable <feeds>". The assembler must outlive it.
template <class Message>
boost::function<void(const LiveEvent<Message>&)> live_reader(
    const std::string& topic, const std::string& feeds,
    const std::function<void(const Message&, trial::Stamp, trial::FrameAssembler&)>& convert,
    trial::FrameAssembler& assembler, const OnMessage& on_message) {
  return [topic, feeds, convert, &assembler, on_message](const LiveEvent<Message>& event) {
    const CheckedMessage<Message>& checked = *event.getConstMessage();
    assembler.begin_message(topic, feeds);
    if (!checked.fault.empty()) {
      ROS_WARN_THROTTLE(10.0, "%s: a message cannot be read: %s", topic.c_str(), checked.fault.c_str());
      assembler.count_rejected("undecodable", feeds);
      on_message(nullptr, event.getPublisherName());
      return;
    }
    // The time of receipt, not of this call: a node that is busy must not shift what has no stamp of its own.
    convert(checked.message, to_stamp(event.getReceiptTime()), assembler);
    on_message(ros::message_traits::header(checked.message), event.getPublisherName());
  };
}

/// Makes an InputTopic of a conversion.
/// @param convert adds the samples of one message: (message, time of receipt, assembler)
template <class Message>
InputTopic make_input_topic(
    const std::string& topic, const std::string& feeds,
    std::function<void(const Message&, trial::Stamp, trial::FrameAssembler&)> convert) {
  InputTopic input;
  input.topic = topic;
  input.type = ros::message_traits::DataType<Message>::value();
  input.md5 = ros::message_traits::MD5Sum<Message>::value();
  input.feeds = feeds;
  input.read = [topic, feeds, convert](const BagMessage& in_bag, trial::FrameAssembler& assembler) {
    std::unique_ptr<Message> message;
    try {
      message = read_message<Message>(in_bag);
    } catch (const ros::Exception&) {
      assembler.begin_message(topic, feeds);
      assembler.count_rejected("undecodable", feeds);
      return BagReading::kUndecodable;
    }
    if (!message) return BagReading::kOtherDefinition;
    assembler.begin_message(topic, feeds);
    convert(*message, to_stamp(in_bag.time), assembler);
    return BagReading::kAdded;
  };
  input.subscribe = [topic, feeds, convert](ros::NodeHandle& nh, trial::FrameAssembler& assembler,
                                            OnMessage on_message) {
    return nh.subscribe<CheckedMessage<Message>, const LiveEvent<Message>&>(
        topic, kSubscriberQueue, live_reader<Message>(topic, feeds, convert, assembler, on_message),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  };
  return input;
}

}  // namespace softarm
