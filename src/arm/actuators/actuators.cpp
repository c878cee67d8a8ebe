// The table of the kinds of actuators.
#include <algorithm>
#include <cmath>

#include "actuator.h"

namespace softarm::arm {

// One line per kind, <name>_kind() in the file of that name. Laws are summed in this order, keys are
// documented in it.
// clang-format off
#define SOFTARM_ACTUATORS(ACTUATOR) \
  ACTUATOR(chambers) \
  ACTUATOR(jamming) \
  ACTUATOR(central_chamber) \
  ACTUATOR(tendons) \
  ACTUATOR(cables)
// clang-format on

#define SOFTARM_DECLARE(name) const ActuatorKind& name##_kind();
SOFTARM_ACTUATORS(SOFTARM_DECLARE)
#undef SOFTARM_DECLARE

const std::vector<const ActuatorKind*>& actuator_kinds() {
#define SOFTARM_ROW(name) &name##_kind(),
  static const std::vector<const ActuatorKind*> table{SOFTARM_ACTUATORS(SOFTARM_ROW)};
#undef SOFTARM_ROW
  return table;
}

namespace {

template <typename Wanted>
bool has_some(const Segment& segment, const Wanted& wanted) {
  const auto& kinds = actuator_kinds();
  return std::any_of(kinds.begin(), kinds.end(),
                     [&](const ActuatorKind* kind) { return kind->count(segment) > 0 && wanted(*kind); });
}

}  // namespace

bool is_driven(const Segment& segment) {
  return has_some(segment, [](const ActuatorKind& kind) { return kind.traits().drives; });
}

bool is_bent(const Segment& segment) {
  return has_some(
      segment, [&](const ActuatorKind& kind) { return kind.bending_direction_rad(segment, 0).has_value(); });
}

bool strained_by_inputs(const Segment& segment) {
  return has_some(segment, [](const ActuatorKind& kind) { return kind.traits().strains; });
}

}  // namespace softarm::arm
