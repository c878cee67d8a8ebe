// A mismatch in one line for people.
#pragma once

#include <string>

#include "softarm/diagnose/mismatch_monitor.h"

namespace softarm::diagnose {

std::string describe(const Mismatch& mismatch, const Arm& arm);

}  // namespace softarm::diagnose
