// The papers, one function each: runs its experiments, returns its tables.
#pragma once

#include "table.h"

namespace softarm::app::validate {

/// Seconds of each on two processors, by which it advances: for the time left.
constexpr double kSemiPhysical_s = 1.4, kOnline_s = 28.0, kSingleChamber_s = 0.3, kHybrid_s = 9.0,
                 kCable_s = 0.7;

Result semi_physical(const Settings& settings, Progress& progress);
Result online(const Settings& settings, Progress& progress);
Result single_chamber(const Settings& settings, Progress& progress);
Result hybrid(const Settings& settings, Progress& progress);
Result cable(const Settings& settings, Progress& progress);

}  // namespace softarm::app::validate
