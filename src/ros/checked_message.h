// A message read of its bytes, once its lengths have been looked at.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include "message_schema.h"

namespace softarm {

/// roscpp makes room for as many elements as a damaged length says, gigabytes of them, before it looks for
/// them, and may take 8 bytes for 4 GB of numbers, as it multiplies in 32 bits: hence the lengths are held
/// against the bytes before.
/// @throws SchemaError if a length says more than the bytes hold, ros::Exception if they are damaged
/// otherwise
template <class Message>
void read_bytes(const std::uint8_t* data, std::size_t size, Message& message) {
  namespace traits = ros::message_traits;
  static const MessageSchema schema(traits::DataType<Message>::value(), traits::Definition<Message>::value());
  static const bool has_lengths = schema.has_lengths();
  if (has_lengths || size == 0) schema.check_lengths(data, size);
  auto* const bytes = const_cast<std::uint8_t*>(data);  // IStream only reads them
  ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(size));
  ros::serialization::deserialize(stream, message);
}

/// What a subscriber asks roscpp for in place of the message, so that read_bytes() reads it.
template <class Message>
struct CheckedMessage {
  Message message;
  std::string fault;  ///< why it cannot be read; empty: it has been
};

}  // namespace softarm

/// To its publisher a CheckedMessage is the message.
namespace ros {
namespace message_traits {

template <class Message>
struct MD5Sum<softarm::CheckedMessage<Message>> : MD5Sum<Message> {};
template <class Message>
struct DataType<softarm::CheckedMessage<Message>> : DataType<Message> {};
template <class Message>
struct Definition<softarm::CheckedMessage<Message>> : Definition<Message> {};
template <class Message>
struct HasHeader<softarm::CheckedMessage<Message>> : HasHeader<Message> {};
template <class Message>
struct IsMessage<softarm::CheckedMessage<Message>> : TrueType {};

}  // namespace message_traits

namespace serialization {

template <class Message>
struct Serializer<softarm::CheckedMessage<Message>> {
  /// Throws nothing: roscpp would say it for every message, and nobody would count it.
  template <class Stream>
  static void read(Stream& stream, softarm::CheckedMessage<Message>& checked) {
    try {
      softarm::read_bytes(stream.getData(), stream.getLength(), checked.message);
    } catch (const std::exception& e) {
      checked.fault = e.what();
    }
  }
};

}  // namespace serialization
}  // namespace ros
