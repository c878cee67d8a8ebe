// What an input is, in words.
#pragma once

#include <string>

#include "softarm/arm/arm.h"

namespace softarm::arm {

/// "pressure", "vacuum", "tension", "angle".
std::string to_string(InputKind kind);
/// SI: "Pa", "N", "rad".
std::string unit_of(InputKind kind);

}  // namespace softarm::arm
