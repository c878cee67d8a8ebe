// How far the motion of the arm lags behind its inputs.
#pragma once

#include <optional>

#include "context.h"

namespace softarm::check {

struct ClockShift {
  double shift_s = 0.0;  ///< the arm answers so much after its inputs; a clock or a lag
  double sd_s = 0.0;
  double explained = 0.0;  ///< share of the motion's variance
  bool at_edge = false;    ///< no shift within a second fits better than its neighbours
  bool too_short = false;  ///< nothing else holds then
};

/// @param centre_s shifts within a second of it are looked for
/// @return nothing where no input changes while a body is seen
std::optional<ClockShift> clock_shift(const Context& context, double centre_s = 0.0);

}  // namespace softarm::check
