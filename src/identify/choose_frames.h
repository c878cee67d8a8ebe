// Which frames of trials are compared or fitted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"
#include "trial/static_frame.h"

namespace softarm::identify {

/// Chosen frames of all trials, trial by trial, in the order of their stamps, and why the others were not.
struct FrameSet {
  std::vector<trial::StaticFrame> frames;
  std::map<std::string, std::uint64_t> left_out;
};

FrameSet choose_frames(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                       const FrameChoice& choice);

}  // namespace softarm::identify
