#include "bag_message.h"

namespace softarm {

BagMessage bag_message(const rosbag::MessageInstance& instance) {
  return {instance.getTopic(), instance.getDataType(), instance.getMD5Sum(), instance.getMessageDefinition(),
          instance.getTime(),  bytes_of(instance)};
}

}  // namespace softarm
