#include "bag_message.h"

namespace softarm {

BagMessage bag_message(const rosbag::MessageInstance& instance) {
  return {instance.getTopic(), instance.getDataType(), instance.getMD5Sum(), instance.getMessageDefinition(),
          instance.getTime(),  bytes_of(instance)};
}

void check_message_lengths(const BagMessage& message, const MessageSchema& schema) {
  try {
    schema.check_lengths(message.bytes.data(), message.bytes.size());
  } catch (const SchemaError& e) {
    throw ros::Exception(message.topic + ": " + e.what());
  }
}

}  // namespace softarm
