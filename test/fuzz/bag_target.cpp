#include "ros/bag_frames.h"
#include "ros/bag_recording.h"
#include "ros/open_bag.h"
#include "scratch_file.h"
#include "softarm/arm/arm_file.h"
#include "targets.h"

namespace softarm::fuzz {

void bag(const std::uint8_t* data, std::size_t size) {
  static const arm::Arm kArm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const ScratchFile file("bag", reinterpret_cast<const char*>(data), size);
  try {
    read_recording(
        file.path(), kArm, [](std::uint64_t) {}, [](std::uint64_t) {});
    BagFrames frames(file.path(), kArm);
    BagFrames::Callbacks callbacks;
    callbacks.on_frame = [](const trial::Frame&) {};
    callbacks.on_time_jump = [] {};
    callbacks.on_messages = [](std::uint64_t) {};
    frames.read(callbacks);
  } catch (const BagError&) {
  }
}

}  // namespace softarm::fuzz
