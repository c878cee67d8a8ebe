#pragma once

#include <vector>

#include "softarm/identify/static_frame.h"

namespace softarm::identify {

/// compare() of frames that are chosen already; bodies set aside are left out.
std::vector<FrameComparison> compare_frames(const Arm& arm, const std::vector<StaticFrame>& frames);

}  // namespace softarm::identify
