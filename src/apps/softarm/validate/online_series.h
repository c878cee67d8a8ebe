// The online paper's experiment as numbers for plots.
#pragma once

#include <vector>

#include "online_statistics.h"

namespace softarm::app::validate {

/// Every loaded and unloaded frame: pressures, error of each method, EI.
Series online_frames_series(const std::vector<OnlineSetting>& settings,
                            const std::vector<OnlineExperiment>& experiments);
/// Every unseen weight and its estimates.
Series online_payload_series(const std::vector<OnlineSetting>& settings,
                             const std::vector<OnlineExperiment>& experiments);

}  // namespace softarm::app::validate
