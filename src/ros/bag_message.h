// A message of a bag, once its lengths have been looked at.
#pragma once

#include <ros/exception.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <rosbag/message_instance.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "checked_message.h"

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

/// Reads a message.
/// @return null if it is of another type, or its type was defined otherwise where it was recorded
/// @throws ros::Exception if it is damaged
template <class Message>
std::unique_ptr<Message> read_message(const BagMessage& message) {
  if (message.md5 != ros::message_traits::MD5Sum<Message>::value()) return nullptr;
  auto read = std::make_unique<Message>();
  try {
    read_bytes(message.bytes.data(), message.bytes.size(), *read);
  } catch (const SchemaError& e) {
    throw ros::Exception(message.topic + ": " + e.what());
  }
  return read;
}

}  // namespace softarm
