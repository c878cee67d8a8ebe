#include <string>

#include "rig/scenario.h"
#include "targets.h"

namespace softarm::fuzz {

void scenario(const std::uint8_t* data, std::size_t size) {
  try {
    rig::parse_scenario(std::string(reinterpret_cast<const char*>(data), size), "scenario.yaml");
  } catch (const rig::ScenarioError&) {
  }
}

}  // namespace softarm::fuzz
