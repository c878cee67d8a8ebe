// A mismatch in one line for people.
#pragma once

#include <string>

#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::monitor {

std::string describe(const Mismatch& mismatch, const arm::Arm& arm);

}  // namespace softarm::monitor
