#include "softarm/arm/arm_file.h"
#include "targets.h"

namespace softarm::fuzz {

void arm(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    arm::parse_arm(text, "arm.yaml");  // the effects and their verdict, too
  } catch (const arm::ArmError&) {
  }
}

}  // namespace softarm::fuzz
