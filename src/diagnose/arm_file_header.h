// What stands in front of the extended arm file.
#pragma once

#include <string>
#include <vector>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Lines for arm::update_arm_text(): the trials, the verdict, the effects.
std::vector<std::string> arm_file_header(const Diagnosis& diagnosis, const std::vector<trial::Trial>& trials);

}  // namespace softarm::diagnose
