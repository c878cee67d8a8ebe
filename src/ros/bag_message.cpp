#include "bag_message.h"

namespace softarm {

void check_message_lengths(const rosbag::MessageInstance& instance, const MessageSchema& schema) {
  std::vector<std::uint8_t> bytes(instance.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  instance.write(stream);
  try {
    schema.check_lengths(bytes.data(), bytes.size());
  } catch (const SchemaError& e) {
    throw ros::Exception(instance.getTopic() + ": " + e.what());
  }
}

}  // namespace softarm
