#include <fmt/format.h>

#include <algorithm>

#include "scenario_parts.h"

namespace softarm::rig {
namespace {

constexpr Allowed kTension{0.0, 1e4}, kAngle{-1e3, 1e3};

/// One limit of the random inputs: a number for all, or one for each.
std::vector<double> limit(YamlMap& map, const std::string& key, const InputKindKeys& kind,
                          std::optional<double> otherwise) {
  const auto count = static_cast<std::size_t>(kind.inputs);
  if (map.has(key) && map.is_list(key)) return map.numbers(key, kind.allowed, count, count);
  const double value = otherwise ? map.number(key, kind.allowed, *otherwise) : map.number(key, kind.allowed);
  return std::vector<double>(count, value);
}

RandomDrive parse_random(YamlMap map, const InputKindKeys& kind) {
  RandomDrive random;
  parse_limits(map, kind, random.min, random.max);
  random.lowest_hz = map.number("lowest_hz", {0.0, 100.0}, random.lowest_hz);
  random.highest_hz =
      map.number("highest_hz", {random.lowest_hz, 100.0}, std::max(random.lowest_hz, random.highest_hz));
  random.sinusoids = map.integer("sinusoids", {1, 100}, random.sinusoids);
  map.finish();
  return random;
}

void parse_drive(YamlMap& map, const InputKindKeys& kind, DriveSpec& spec) {
  for (const char* key : {"random", "schedule", "programme", "steps"})
    if (kind.inputs == 0 && map.has(key)) map.fail(key, "given, but no segment takes such an input");
  const auto count = static_cast<std::size_t>(kind.inputs);
  spec.lowest = kind.allowed.low;
  spec.rate_hz = map.number("rate_hz", {0.1, 2000.0}, spec.rate_hz);
  spec.rest = map.number("rest_" + kind.unit, kind.allowed, spec.rest);
  spec.settle_s = map.number("settle_s", {0.0, 1e4}, spec.settle_s);
  spec.ramp_s = map.number("ramp_s", {0.01, 1e4}, spec.ramp_s);
  if (map.has("random")) spec.random = parse_random(map.map("random"), kind);
  spec.schedule = parse_schedule(map, kind.values, kind.allowed, count, spec.ramp_s, true);
  if (spec.random && !spec.schedule.empty())
    map.fail("schedule", "given together with random; give one of them only");
  spec.programme = parse_programme(map, kind);
  for (const char* other : {"random", "schedule", "steps"})
    if (!spec.programme.empty() && map.has(other))
      map.fail("programme", fmt::format("given together with {}; give one of them only", other));
  if (map.has("repeat_s")) {
    if (spec.schedule.empty()) map.fail("repeat_s", "given without a schedule");
    spec.repeat_s = map.number("repeat_s", {spec.schedule.back().end_s(spec.ramp_s), 1e6});
    if (spec.schedule.back().values != spec.schedule.front().values)
      map.fail("repeat_s", "the schedule must end with the values that it starts with");
  }
  YamlMap steps = map.map("steps");
  spec.step_ramp_s = steps.number("ramp_s", {0.001, 1e4}, spec.step_ramp_s);
  const double reach = kind.allowed.high;
  spec.steps = parse_schedule(steps, kind.values, {-reach, reach}, count, spec.step_ramp_s, true);
  steps.finish();
}

}  // namespace

void parse_limits(YamlMap& map, const InputKindKeys& kind, std::vector<double>& min,
                  std::vector<double>& max) {
  const std::string low = "min_" + kind.unit, high = "max_" + kind.unit;
  min = limit(map, low, kind, 0.0);
  max = limit(map, high, kind, kind.most);
  for (std::size_t i = 0; i < min.size(); ++i)
    if (!(min[i] <= max[i]))
      map.fail(high, fmt::format("value {}, allowed from {} ({})", max[i], min[i], low));
}

std::vector<Setpoint> parse_schedule(YamlMap& map, const std::string& value_key, Allowed allowed,
                                     std::optional<std::size_t> count, double ramp_s, bool own_ramps) {
  std::vector<Setpoint> schedule;
  for (YamlMap& entry : map.maps("schedule")) {
    Setpoint setpoint;
    setpoint.t_s = entry.number("t_s", {0.0, 1e6});
    if (count)
      setpoint.values = entry.numbers(value_key, allowed, *count, *count);
    else
      setpoint.values.assign(1, entry.number(value_key, allowed));
    if (schedule.empty() && setpoint.t_s != 0.0)
      entry.fail("t_s", fmt::format("value {}, the first must be 0", setpoint.t_s));
    // A billionth: sums of decimal numbers are not exact.
    if (!schedule.empty() && setpoint.t_s < schedule.back().end_s(ramp_s) - 1e-9)
      entry.fail("t_s", fmt::format("value {}, allowed from {} (the last change and its ramp_s)",
                                    setpoint.t_s, schedule.back().end_s(ramp_s)));
    if (own_ramps && entry.has("over_s")) setpoint.over_s = entry.number("over_s", {0.001, 1e5});
    entry.finish();
    schedule.push_back(std::move(setpoint));
  }
  return schedule;
}

PressureSpec parse_pressures(YamlMap map, const ArmSpec& arm) {
  PressureSpec spec;
  spec.ambient_pa = map.number("ambient_pa", {5e4, 1.2e5}, spec.ambient_pa);
  parse_drive(map, {"pa", "pressures_pa", kGaugePressure, 50e3, arm.chambers}, spec);
  map.finish();
  return spec;
}

DriveSpec parse_tensions(YamlMap map, const ArmSpec& arm) {
  DriveSpec spec;
  parse_drive(map, {"n", "tensions_n", kTension, std::nullopt, arm.tendons}, spec);
  map.finish();
  return spec;
}

DriveSpec parse_angles(YamlMap map, const ArmSpec& arm) {
  DriveSpec spec;
  parse_drive(map, {"rad", "angles_rad", kAngle, std::nullopt, arm.servos}, spec);
  map.finish();
  return spec;
}

}  // namespace softarm::rig
