#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "trial/static_frame.h"

namespace softarm::identify {

/// compare() of frames that are chosen already; bodies set aside are left out.
/// @param starts of the walls by trial, see LawModel::set_start(); of the others as the laws have them
std::vector<FrameComparison> compare_frames(const arm::Arm& arm,
                                            const std::vector<trial::StaticFrame>& frames,
                                            const std::map<std::size_t, Eigen::VectorXd>& starts = {});

}  // namespace softarm::identify
