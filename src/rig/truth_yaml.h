// What was hidden in a trial and what its arm really was, as YAML beside the truth's time series.
#pragma once

#include <string>

#include "scenario.h"

namespace softarm::rig {

/// The scenario's name, seed, mount and noise, every constant of the true arm, and the list `hidden` as a
/// scenario writes it. SI units; ends with a line end.
std::string truth_yaml(const Scenario& scenario);

}  // namespace softarm::rig
