#include "any_input_topic.h"

#include <topic_tools/shape_shifter.h>

#include <map>
#include <memory>
#include <vector>

#include "body_driver.h"
#include "message_schema.h"

namespace softarm {
namespace {

std::string mirrored_definition(const std::string& md5) {
  for (const auto& [type, driver] : body_drivers()) {
    if (driver.mirror && driver.mirror->md5 == md5) return driver.mirror->definition;
  }
  throw SchemaError("its publisher sends no definition");
}

/// Decodes the messages of one topic; publishers of several versions may share it.
class Decoder {
 public:
  explicit Decoder(std::string type) : type_(std::move(type)) {}

  nlohmann::json decode(const std::vector<std::uint8_t>& bytes, const std::string& md5,
                        const std::string& definition) {
    auto known = schemas_.find(md5);
    if (known == schemas_.end()) {
      const std::string text = definition.empty() ? mirrored_definition(md5) : definition;
      known = schemas_.emplace(md5, MessageSchema(type_, text)).first;
    }
    return known->second.decode(bytes.data(), bytes.size());
  }

 private:
  std::string type_;
  std::map<std::string, MessageSchema> schemas_;
};

/// Absent where the definition makes something else of it.
std::optional<std_msgs::Header> header_of(const nlohmann::json& message) {
  const nlohmann::json* const seq = find_field(message, "header.seq");
  const nlohmann::json* const sec = find_field(message, "header.stamp.sec");
  const nlohmann::json* const nsec = find_field(message, "header.stamp.nsec");
  for (const nlohmann::json* number : {seq, sec, nsec})
    if (!number || !number->is_number_unsigned()) return std::nullopt;
  std_msgs::Header header;
  seq->get_to(header.seq);
  sec->get_to(header.stamp.sec);  // not through ros::Time's constructor, which refuses some nanoseconds
  nsec->get_to(header.stamp.nsec);
  return header;
}

}  // namespace

std::optional<trial::Stamp> header_stamp(const nlohmann::json& message) {
  const std::optional<std_msgs::Header> header = header_of(message);
  if (!header || header->stamp.isZero()) return std::nullopt;
  return to_stamp(header->stamp);
}

InputTopic make_any_input_topic(const std::string& topic, const std::string& type, const std::string& feeds,
                                ConvertAny convert) {
  InputTopic input;
  input.topic = topic;
  input.type = type;
  input.feeds = feeds;
  const auto decoder = std::make_shared<Decoder>(type);
  input.read = [=](const BagMessage& message, trial::FrameAssembler& assembler) {
    if (message.type != type) return BagReading::kOtherDefinition;
    assembler.begin_message(topic, feeds);
    try {
      convert(decoder->decode(message.bytes, message.md5, message.definition), to_stamp(message.time),
              assembler);
    } catch (const SchemaError&) {
      assembler.count_rejected("undecodable", feeds);
      return BagReading::kUndecodable;
    }
    return BagReading::kAdded;
  };
  input.subscribe = [=](ros::NodeHandle& nh, trial::FrameAssembler& assembler, OnMessage on_message) {
    using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;
    const boost::function<void(const Event&)> callback = [=, &assembler](const Event& event) {
      const topic_tools::ShapeShifter& message = *event.getConstMessage();
      if (message.getDataType() != type) return;  // the diagnostics say of what type the silent topic is
      std::optional<std_msgs::Header> header;
      assembler.begin_message(topic, feeds);
      try {
        const nlohmann::json decoded =
            decoder->decode(bytes_of(message), message.getMD5Sum(), message.getMessageDefinition());
        convert(decoded, to_stamp(event.getReceiptTime()), assembler);
        header = header_of(decoded);
      } catch (const SchemaError& e) {
        ROS_WARN_THROTTLE(10.0, "%s: a message cannot be read: %s", topic.c_str(), e.what());
        assembler.count_rejected("undecodable", feeds);
      }
      on_message(header ? &*header : nullptr, event.getPublisherName());
    };
    return nh.subscribe<topic_tools::ShapeShifter, const Event&>(
        topic, kSubscriberQueue, callback, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  };
  return input;
}

}  // namespace softarm
