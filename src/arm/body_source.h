// What the messages of motion-capture drivers are, as far as an arm file must know it.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/inputs.h"
#include "yaml_section.h"

namespace softarm::arm::yaml {

enum class BodyMessage {
  kPose,     ///< a pose of one body per topic
  kPoint,    ///< a position of one body per topic
  kFrames,   ///< tf: poses of all bodies on one topic
  kMarkers,  ///< labelled points on one topic
  kCloud,    ///< points without labels on one topic
};

struct BodyType {
  std::string type;
  BodyMessage message;
  std::string unit;  ///< in which drivers send it
  bool server_time;  ///< carries the time of the motion capture itself
};

/// Every type that Inputs::bodies may have.
const std::vector<BodyType>& body_types();
const BodyType& body_type(const std::string& type);

BodySource read_body_source(const Section& section);

}  // namespace softarm::arm::yaml
