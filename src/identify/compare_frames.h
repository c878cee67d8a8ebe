#pragma once

#include <vector>

#include "trial/static_frame.h"

namespace softarm::identify {

/// compare() of frames that are chosen already; bodies set aside are left out.
std::vector<FrameComparison> compare_frames(const arm::Arm& arm,
                                            const std::vector<trial::StaticFrame>& frames);

}  // namespace softarm::identify
