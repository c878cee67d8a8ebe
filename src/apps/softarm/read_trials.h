// Bags as trials.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"

namespace softarm::app {

/// All frames of each bag and the series of its inputs, named after the bag, with progress.
/// @param use_payload whether the payload's topic is read
/// @param jobs bags at a time; 0: one per core
/// @throws BagError for the first bag that is missing, unreadable, without a frame, or named like another
std::vector<trial::Trial> read_trials(const std::vector<std::string>& bags, const arm::Arm& arm,
                                      bool use_payload, unsigned jobs);

}  // namespace softarm::app
