// What a motion-capture driver is to us: a converter of its message, and a mirror where its package is
// foreign.
#pragma once

#include <ros/message_traits.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "input_topics.h"

namespace softarm {

/// Our definition of a foreign message, for publishers that send none.
struct Mirror {
  std::string md5, definition;
};

template <class Message>
Mirror mirror() {
  return {ros::message_traits::md5sum<Message>(), ros::message_traits::definition<Message>()};
}

/// A driver_<name>() of each row of SOFTARM_BODY_TYPES returns it.
struct BodyDriver {
  /// The topics that feed these bodies of an arm from one source.
  std::vector<InputTopic> (*topics)(const arm::Arm& arm, const arm::BodySource& source, const Bodies& bodies);
  std::optional<Mirror> mirror = std::nullopt;
};

/// By BodySource::type: the rows of SOFTARM_BODY_TYPES (arm/body_types.h) with their converters.
const std::map<std::string, BodyDriver>& body_drivers();

/// "base, ring_1": what a topic that holds all of them feeds.
std::string names_of(const Bodies& bodies);

}  // namespace softarm
