// A protocol as a list of what is done one after the other.
#pragma once

#include <optional>
#include <vector>

namespace softarm::rig {

/// One part of a programme, done to all inputs of a kind; values in their unit, one per input. All inputs
/// move together. How fast a move is: over_s, or rates (of the input that has the longest way), or the
/// drive's ramp_s.
struct ProgrammePart {
  enum class Kind {
    kHold,        ///< hold_s
    kRamp,        ///< to `to`
    kCycle,       ///< to `to`, hold_s, back to where it began, hold_s; `times` times at each of the rates
    kStaircase,   ///< to `to` in `levels` equal steps with hold_s after each and, if `back`, down again
    kRandomHolds  ///< `times` moves to random values, each with one of the rates, and hold_s after each
  };
  Kind kind = Kind::kHold;
  double hold_s = 0.0;
  std::vector<double> to;
  std::optional<double> over_s;
  std::vector<double> rates;  ///< unit per second
  int times = 1, levels = 1;
  bool back = true;
  std::vector<double> min, max;  ///< limits of the random values
  double off_probability = 0.0;  ///< that an input is at rest instead
};

/// The programme begins after the drive's settle_s and ends with a move to rest over its ramp_s.
struct Programme {
  std::vector<ProgrammePart> parts;  ///< none: no programme
  bool repeat = false;               ///< from the start for ever

  bool empty() const { return parts.empty(); }
};

}  // namespace softarm::rig
