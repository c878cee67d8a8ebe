#include <fmt/format.h>

#include "scenario_parts.h"

namespace softarm::rig {
namespace {

using Kind = ProgrammePart::Kind;

constexpr Allowed kRate{1e-9, 1e12}, kHold{0.0, 1e5};

/// How fast the part moves; `several` rates for those that move several times.
void parse_speed(YamlMap& map, const InputKindKeys& keys, bool several, ProgrammePart& part) {
  const std::string key = (several ? "rates_" : "rate_") + keys.unit + "_per_s";
  if (map.has(key)) {
    if (several)
      part.rates = map.numbers(key, kRate, 1, 100);
    else
      part.rates.assign(1, map.number(key, kRate));
  }
  if (!map.has("over_s")) return;
  if (!part.rates.empty())
    map.fail("over_s", fmt::format("given together with {}; give one of them only", key));
  part.over_s = map.number("over_s", {0.001, 1e5});
}

ProgrammePart parse_part(YamlMap& map, const InputKindKeys& keys) {
  const std::string ramp = "ramp_to_" + keys.unit, cycle = "cycle_to_" + keys.unit,
                    staircase = "staircase_to_" + keys.unit, random = "random_holds";
  const auto count = static_cast<std::size_t>(keys.inputs);
  ProgrammePart part;
  std::string kind;
  for (const std::string& key : {ramp, cycle, staircase, random}) {
    if (!map.has(key)) continue;
    if (!kind.empty()) map.fail(key, fmt::format("given together with {}; give one of them only", kind));
    kind = key;
  }
  if (kind.empty()) {
    if (!map.has("hold_s"))
      map.fail("hold_s", fmt::format("missing; expected this or one of {}, {}, {}, {}", ramp, cycle,
                                     staircase, random));
    part.hold_s = map.number("hold_s", kHold);
    return part;
  }
  if (kind != ramp) part.hold_s = map.number("hold_s", kHold, 0.0);
  if (kind != random) part.to = map.numbers(kind, keys.allowed, count, count);
  parse_speed(map, keys, kind == cycle || kind == random, part);
  if (kind == ramp) {
    part.kind = Kind::kRamp;
  } else if (kind == cycle) {
    part.kind = Kind::kCycle;
    part.times = map.integer("times", {1, 1000}, 1);
  } else if (kind == staircase) {
    part.kind = Kind::kStaircase;
    part.levels = map.integer("levels", {1, 1000}, 5);
    part.back = map.boolean("back", true);
  } else {
    part.kind = Kind::kRandomHolds;
    part.times = map.integer(random, {1, 10000}, 1);
    parse_limits(map, keys, part.min, part.max);
    part.off_probability = map.number("off_probability", {0.0, 1.0}, 0.0);
  }
  return part;
}

}  // namespace

Programme parse_programme(YamlMap& map, const InputKindKeys& keys) {
  Programme programme;
  for (YamlMap& entry : map.maps("programme")) {
    programme.parts.push_back(parse_part(entry, keys));
    entry.finish();
  }
  if (map.has("repeat_programme")) {
    if (programme.empty()) map.fail("repeat_programme", "given without a programme");
    programme.repeat = map.boolean("repeat_programme", false);
  }
  return programme;
}

}  // namespace softarm::rig
