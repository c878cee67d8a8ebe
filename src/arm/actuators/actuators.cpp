// The table of the kinds of actuators.
#include <algorithm>
#include <cmath>

#include "actuator.h"

namespace softarm::arm {

using Kind = const ActuatorKind&();
Kind chambers_kind, jamming_kind, central_chamber_kind, tendons_kind, cables_kind;  // each in its own file

const std::vector<const ActuatorKind*>& actuator_kinds() {
  static const std::vector<const ActuatorKind*> table{
      &chambers_kind(), &jamming_kind(), &central_chamber_kind(), &tendons_kind(), &cables_kind(),
  };
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
