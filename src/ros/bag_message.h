// A message of a bag, once its lengths have been looked at.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <rosbag/message_instance.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "message_schema.h"

namespace softarm {

/// What a bag holds of a message: its bytes as they were published, and what is said of them. The strings are
/// the bag's, which must outlive it.
struct BagMessage {
  const std::string &topic, &type, &md5, &definition;
  ros::Time time;  ///< of the record
  std::vector<std::uint8_t> bytes;
};

/// @throws ros::Exception if the bag is damaged there
BagMessage bag_message(const rosbag::MessageInstance& instance);

/// @param message one of roscpp or of a bag: both write their bytes to a stream
template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.write(stream);
  return bytes;
}

/// @throws ros::Exception if a length in the message says more than its bytes hold
void check_message_lengths(const BagMessage& message, const MessageSchema& schema);

/// Reads a message. roscpp makes room for as many elements as a damaged length says, gigabytes of them,
/// before it looks for them: hence the lengths are held against the bytes before.
/// @return null if it is of another type, or its type was defined otherwise where it was recorded
/// @throws ros::Exception if it is damaged
template <class Message>
std::unique_ptr<Message> read_message(const BagMessage& message) {
  namespace traits = ros::message_traits;
  static const MessageSchema schema(traits::DataType<Message>::value(), traits::Definition<Message>::value());
  static const bool has_lengths = schema.has_lengths();
  if (message.md5 != traits::MD5Sum<Message>::value()) return nullptr;
  if (has_lengths || message.bytes.empty()) check_message_lengths(message, schema);
  auto* const bytes = const_cast<std::uint8_t*>(message.bytes.data());  // IStream only reads them
  ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(message.bytes.size()));
  auto read = std::make_unique<Message>();
  ros::serialization::deserialize(stream, *read);
  return read;
}

}  // namespace softarm
