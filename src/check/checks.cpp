#include "checks.h"

#include <algorithm>

namespace softarm::check {

// The table of the checks: <name>.cpp has make_<name>(), but for the two of rest.cpp that only make ready
// what others look at. Labels come first, then single poses, then the arm as a whole.
// clang-format off
#define SOFTARM_CHECKS(check) \
  check(topics)               \
  check(strays)               \
  check(timing)               \
  check(receipt)              \
  check(numbers)              \
  check(exchanged)            \
  check(frozen)               \
  check(turned_over)          \
  check(jumps)                \
  check(losses)               \
  check(track_noise)          \
  check(still_spans)          \
  check(rest)                 \
  check(units)                \
  check(order)                \
  check(attitude)             \
  check(base_moves)           \
  check(noise)                \
  check(spacing)              \
  check(places)               \
  check(gravity)              \
  check(input_units)          \
  check(input_levels)         \
  check(input_signals)        \
  check(payload)              \
  check(clocks)               \
  check(dead_inputs)          \
  check(input_directions)
// clang-format on

#define SOFTARM_DECLARE(name) Check make_##name();
SOFTARM_CHECKS(SOFTARM_DECLARE)
#undef SOFTARM_DECLARE

const Statement* Check::statement(const std::string& id) const {
  const auto found =
      std::find_if(states.begin(), states.end(), [&](const Statement& s) { return s.id == id; });
  return found == states.end() ? nullptr : &*found;
}

const std::vector<Check>& checks() {
#define SOFTARM_MAKE(name) make_##name(),
  static const std::vector<Check> table{SOFTARM_CHECKS(SOFTARM_MAKE)};
#undef SOFTARM_MAKE
  return table;
}

#undef SOFTARM_CHECKS

}  // namespace softarm::check
