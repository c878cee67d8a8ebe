// A message of a bag, once its lengths have been looked at.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <rosbag/message_instance.h>

#include <cstdint>
#include <vector>

#include "message_schema.h"

namespace softarm {

/// @throws ros::Exception if a length in the message says more than its bytes hold
void check_message_lengths(const rosbag::MessageInstance& instance, const MessageSchema& schema);

/// Reads a message. roscpp makes room for as many elements as a damaged length says, gigabytes of them,
/// before it looks for them: hence the lengths are held against the bytes before.
/// @return null if it is of another type
/// @throws ros::Exception if it is damaged
template <class Message>
boost::shared_ptr<Message> read_message(const rosbag::MessageInstance& instance) {
  namespace traits = ros::message_traits;
  static const MessageSchema schema(traits::DataType<Message>::value(), traits::Definition<Message>::value());
  static const bool has_lengths = schema.has_lengths();
  if (has_lengths && instance.isType<Message>()) check_message_lengths(instance, schema);
  return instance.instantiate<Message>();
}

}  // namespace softarm
