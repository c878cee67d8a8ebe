// What the online paper's tables say of an experiment.
#pragma once

#include <functional>
#include <vector>

#include "online_data.h"

namespace softarm::app::validate {

using OnlineExperiment = std::vector<OnlineSet>;
/// One of the fits of a frame.
using OnlinePick = std::function<const OnlineFit&(const OnlineFrame&)>;
OnlinePick online_fit(std::size_t method, std::size_t objective);

enum class Load { kLoaded, kNone };

/// One value of every frame; the largest is that of one repeat of the experiment, averaged over the repeats.
struct OnlineSummary {
  Statistics all;
  double maximum = 0.0;
};
OnlineSummary summarise(const OnlineExperiment& sets, Load load, const OnlinePick& pick,
                        const std::function<double(const OnlineFit&)>& value);

/// Spread of EI over the payloads at equal pressures.
struct OnlineSpread {
  Statistics sd_nm2, relative;
  double maximum_nm2 = 0.0;  ///< of one repeat, averaged over the repeats
  Statistics bias;           ///< EI / true EI - 1
};
OnlineSpread spread(const OnlineExperiment& sets, const OnlinePick& pick);

/// Errors of the unseen weights.
struct OnlineWeighing {
  OnlineSummary grams;
  double percent = 0.0;
};
OnlineWeighing weighing(const OnlineExperiment& sets, std::size_t objective);

}  // namespace softarm::app::validate
