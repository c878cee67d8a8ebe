// The papers, one function each: runs its experiments, returns its tables.
#pragma once

#include "table.h"

namespace softarm::app::validate {

Result semi_physical(const Settings& settings, Progress& progress);
Result online(const Settings& settings, Progress& progress);
Result single_chamber(const Settings& settings, Progress& progress);
Result hybrid(const Settings& settings, Progress& progress);
Result cable(const Settings& settings, Progress& progress);

}  // namespace softarm::app::validate
