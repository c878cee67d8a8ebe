// Whether recordings and an arm file belong together, and how they would.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/identify/identify.h"

namespace softarm::identify {

/// One way to read the recordings that the arm file does not name.
struct Reading {
  std::string name;     ///< "axes: 'x -z y'", "positions in mm"
  double mean_m = 0.0;  ///< shape error of the arm file's laws under it
  double share = 0.0;   ///< the same over the arm's length under it
};

/// How far the bodies are from where the arm file's laws have them, before any fit.
struct Belonging {
  std::optional<double> mean_m;  ///< absent: no frame can be used
  double length_m = 0.0;
  bool together = true;
  std::size_t better_in = 0;   ///< all trials, where the best other reading is clearly better in each; else 0
  std::vector<Reading> tried;  ///< best first; only where they are not together
};

/// The bodies of an arm whose laws are rough are a bend away from the prediction, not an arm's length. Beyond
/// kFarthest of its length something else is wrong, and where another reading leaves less than kBetter of the
/// error that reading is: of axes, units, lengths, the order of the quaternion, the attitude of the base in
/// its body. Each is tried on some frames. One that leaves clearly less in each of several trials is named,
/// too.
Belonging belonging(const arm::Arm& arm, const std::vector<trial::Trial>& trials);

/// One line for the user; empty where they belong together.
std::string describe(const Belonging& belonging);

}  // namespace softarm::identify
