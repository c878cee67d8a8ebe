// Effects of the sensors.
#include "hidden_tables.h"

namespace softarm::rig {

std::vector<HiddenEffect> sensor_effects() {
  return {};
}

}  // namespace softarm::rig
