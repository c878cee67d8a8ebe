// What the scripts of report.html read.
#pragma once

#include "json.h"

namespace softarm::report {

/// `report`: report_json() with sentences; `units`: how SI is shown; `trials`, `along`, `snapshots`,
/// `parameter_variation`: the pictures' numbers, SI, to five significant digits; what was not seen is null.
Json page_data(const diagnose::Diagnosis& diagnosis, const Origin& origin);

}  // namespace softarm::report
