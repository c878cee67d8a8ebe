// A bag as a trial.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm {

/// A trial, and what is worth knowing of how it was read.
struct BagTrial {
  trial::Trial trial;
  std::vector<std::string> warnings;              ///< BagFrames::warnings()
  std::vector<std::size_t> after_jumps;           ///< frames before which the time jumped, increasing
  std::map<std::string, std::uint64_t> rejected;  ///< FrameAssembler::rejected()
  std::uint64_t samples = 0;                      ///< all that were offered
};

struct BagTrialHooks {
  std::function<void(std::uint64_t)> on_total;  ///< messages that will be read
  /// Messages read, and frames that came of them, since the last call.
  std::function<void(std::uint64_t, std::uint64_t)> on_progress;
};

/// The name of a bag's trial: the file's, without folder and ".bag".
std::string trial_name(const std::string& path);
/// @throws BagError for a path that is no file, and for two bags whose trials would have the same name
void check_bag_names(const std::vector<std::string>& paths);

/// All frames of a bag and the series of its inputs.
/// @param use_payload whether the payload's topic is read
/// @throws BagError if it is missing, unreadable or without a frame
BagTrial read_bag_trial(const std::string& path, const arm::Arm& arm, bool use_payload,
                        const BagTrialHooks& hooks);

}  // namespace softarm
