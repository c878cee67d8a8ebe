// What stands in front of an identified arm file.
#pragma once

#include <string>
#include <vector>

#include "softarm/identify/identify.h"

namespace softarm::identify {

/// Lines for arm::update_arm_text(): the trials, the errors before and after, what they do not determine.
std::vector<std::string> arm_file_header(const Result& result);

}  // namespace softarm::identify
