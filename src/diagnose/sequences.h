// Which trials were driven by the same commands: what is tried on one of them is not new on another.
#pragma once

#include <cstddef>
#include <vector>

#include "model/prepared_trial.h"

namespace softarm::diagnose {

/// For each trial the number of its input sequence, from 0 in the order in which they first occur. Trials are
/// one sequence where their inputs are the same but for noise, perhaps begun earlier or later; payload and
/// attitude may differ.
std::vector<std::size_t> sequences_of(const std::vector<model::TrialData>& trials);

/// These trials in at most so many groups of about one size, whole sequences in each. Where all are of one
/// sequence, whole trials.
/// @param sequences of all trials
std::vector<std::vector<std::size_t>> folds_of(const std::vector<std::size_t>& sequences,
                                               const std::vector<std::size_t>& trials, std::size_t most);

}  // namespace softarm::diagnose
