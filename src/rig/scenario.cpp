#include "softarm/rig/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "yaml_reader.h"

namespace softarm::rig {
namespace {

constexpr double kRadPerDeg = M_PI / 180.0;
constexpr std::size_t kMaxChambers = 16, kMaxRings = 64;
constexpr Allowed kGaugePressure{-101325.0, 1e6};

ArmSpec parse_arm_spec(YamlMap map) {
  ArmSpec arm;
  arm.length_m = map.number("length_m", {0.01, 10.0});
  arm.mass_kg = map.number("mass_kg", {1e-4, 100.0});
  arm.tip_mass_kg = map.number("tip_mass_kg", {0.0, 100.0}, arm.tip_mass_kg);
  arm.diameter_m = map.number("diameter_m", {5e-4, 1.0}, arm.diameter_m);
  YamlMap stiffness = map.required_map("bending_stiffness");
  arm.stiffness_base_nm2 = stiffness.number("base_nm2", {1e-6, 1e3});
  arm.stiffness_per_min_nm2_per_pa = stiffness.number("per_min_pressure_nm2_per_pa", {-1e-4, 1e-4}, 0.0);
  arm.stiffness_per_jamming_nm2_per_pa =
      stiffness.number("per_jamming_pressure_nm2_per_pa", {-1e-4, 1e-4}, 0.0);
  stiffness.finish();
  arm.torsional_stiffness_nm2 = map.number("torsional_stiffness_nm2", {1e-7, 1e4}, arm.stiffness_base_nm2);
  arm.retardation_s = map.number("retardation_s", {0.0, 10.0}, arm.retardation_s);
  arm.air_damping_n_s_m2 = map.number("air_damping_n_s_m2", {0.0, 1e3}, arm.air_damping_n_s_m2);
  for (YamlMap& entry : map.maps("chambers")) {
    ChamberSpec chamber;
    chamber.direction_rad = kRadPerDeg * entry.number("bending_direction_deg", {-360.0, 360.0});
    chamber.moment_gain_nm_per_pa = entry.number("moment_gain_nm_per_pa", {0.0, 1e-3});
    chamber.near_elongation_m_per_pa = entry.number("near_elongation_m_per_pa", {-1e-5, 1e-5}, 0.0);
    chamber.far_elongation_m_per_pa = entry.number("far_elongation_m_per_pa", {-1e-5, 1e-5}, 0.0);
    entry.finish();
    arm.chambers.push_back(chamber);
  }
  if (arm.chambers.empty() || arm.chambers.size() > kMaxChambers)
    map.fail("chambers", fmt::format("{} chambers, allowed 1 ... {}", arm.chambers.size(), kMaxChambers));
  map.finish();
  return arm;
}

MountSpec parse_mount(YamlMap map) {
  MountSpec mount;
  if (map.has("position_m")) {
    const std::vector<double> p = map.numbers("position_m", {-100.0, 100.0}, 3, 3);
    mount.p_mocap_base = {p[0], p[1], p[2]};
  }
  const bool named = map.has("attitude");
  if (map.has("quaternion_xyzw")) {
    if (named) map.fail("quaternion_xyzw", "given beside attitude, expected one of them");
    const std::vector<double> q = map.numbers("quaternion_xyzw", {-1.001, 1.001}, 4, 4);
    const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
    if (std::abs(quaternion.norm() - 1.0) > 1e-3)
      map.fail("quaternion_xyzw", fmt::format("norm {:.6g}, allowed 0.999 ... 1.001", quaternion.norm()));
    mount.q_mocap_base = quaternion.normalized();
  } else if (named) {
    // About the mocap frame's y axis: x of the base stays in the vertical plane of x.
    const std::string word = map.word("attitude");
    if (word == "hanging")
      mount.q_mocap_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    else if (word == "horizontal")
      mount.q_mocap_base = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
    else if (word != "standing")
      map.fail("attitude",
               fmt::format("value {}, allowed hanging, standing, horizontal", word.substr(0, 60)));
  }
  map.finish();
  return mount;
}

/// A list of {t_s, <key>: value or values}, from t_s = 0 on, changes at least ramp_s apart.
std::vector<Setpoint> parse_schedule(YamlMap& map, const std::string& value_key, Allowed allowed,
                                     std::optional<std::size_t> count, double ramp_s) {
  std::vector<Setpoint> schedule;
  for (YamlMap& entry : map.maps("schedule")) {
    Setpoint setpoint;
    setpoint.t_s = entry.number("t_s", {0.0, 1e6});
    if (count)
      setpoint.values = entry.numbers(value_key, allowed, *count, *count);
    else
      setpoint.values = {entry.number(value_key, allowed)};
    if (schedule.empty() && setpoint.t_s != 0.0)
      entry.fail("t_s", fmt::format("value {}, the first must be 0", setpoint.t_s));
    if (!schedule.empty() && setpoint.t_s < schedule.back().t_s + ramp_s)
      entry.fail("t_s", fmt::format("value {}, allowed from {} (the last change and its ramp_s)",
                                    setpoint.t_s, schedule.back().t_s + ramp_s));
    entry.finish();
    schedule.push_back(std::move(setpoint));
  }
  return schedule;
}

PressureSpec parse_pressures(YamlMap map, std::size_t chambers) {
  PressureSpec spec;
  spec.rate_hz = map.number("rate_hz", {0.1, 2000.0}, spec.rate_hz);
  spec.ambient_pa = map.number("ambient_pa", {5e4, 1.2e5}, spec.ambient_pa);
  spec.rest_pa = map.number("rest_pa", kGaugePressure, spec.rest_pa);
  spec.settle_s = map.number("settle_s", {0.0, 1e4}, spec.settle_s);
  spec.ramp_s = map.number("ramp_s", {0.01, 1e4}, spec.ramp_s);
  if (map.has("random")) {
    YamlMap entry = map.map("random");
    RandomPressures random;
    random.min_pa = entry.number("min_pa", kGaugePressure, random.min_pa);
    random.max_pa =
        entry.number("max_pa", {random.min_pa, kGaugePressure.high}, std::max(random.min_pa, random.max_pa));
    random.lowest_hz = entry.number("lowest_hz", {0.0, 100.0}, random.lowest_hz);
    random.highest_hz =
        entry.number("highest_hz", {random.lowest_hz, 100.0}, std::max(random.lowest_hz, random.highest_hz));
    random.sinusoids = entry.integer("sinusoids", {1, 100}, random.sinusoids);
    entry.finish();
    spec.random = random;
  }
  spec.schedule = parse_schedule(map, "pressures_pa", kGaugePressure, chambers, spec.ramp_s);
  if (spec.random && !spec.schedule.empty())
    map.fail("schedule", "given beside random, expected one of them");
  map.finish();
  return spec;
}

VacuumSpec parse_vacuum(YamlMap map) {
  VacuumSpec spec;
  spec.ramp_s = map.number("ramp_s", {0.01, 1e4}, spec.ramp_s);
  spec.schedule = parse_schedule(map, "vacuum_pa", {0.0, 101325.0}, std::nullopt, spec.ramp_s);
  map.finish();
  return spec;
}

PayloadSpec parse_payload(YamlMap map) {
  PayloadSpec spec;
  spec.ramp_s = map.number("ramp_s", {0.01, 1e3}, spec.ramp_s);
  spec.steady_s = map.number("steady_s", {0.0, 1e3}, spec.steady_s);
  spec.hand_damping_n_s_m = map.number("hand_damping_n_s_m", {0.0, 1e4}, spec.hand_damping_n_s_m);
  spec.publish = map.boolean("publish", spec.publish);
  const double change_s = std::max(spec.ramp_s, spec.steady_s);
  spec.schedule = parse_schedule(map, "kg", {0.0, 100.0}, std::nullopt, change_s);
  if (map.has("repeat_s")) {
    const double needed = spec.schedule.empty() ? 0.0 : spec.schedule.back().t_s + change_s;
    spec.repeat_s = map.number("repeat_s", {needed, 1e6});
  }
  map.finish();
  return spec;
}

PoseNoise parse_noise(YamlMap& map, const PoseNoise& otherwise) {
  return {map.number("position_sd_m", {0.0, 1.0}, otherwise.position_sd_m),
          map.number("orientation_sd_rad", {0.0, 3.0}, otherwise.orientation_sd_rad)};
}

MocapSpec parse_mocap(YamlMap map) {
  MocapSpec spec;
  spec.rate_hz = map.number("rate_hz", {1.0, 2000.0}, spec.rate_hz);
  if (map.has("ring_fractions")) {
    spec.ring_fractions = map.numbers("ring_fractions", {0.0, 1.0}, 1, kMaxRings);
    for (std::size_t i = 1; i < spec.ring_fractions.size(); ++i)
      if (!(spec.ring_fractions[i] > spec.ring_fractions[i - 1]))
        map.fail("ring_fractions", fmt::format("value {} after {}, must increase from base to tip",
                                               spec.ring_fractions[i], spec.ring_fractions[i - 1]));
  }
  spec.ring_noise = parse_noise(map, spec.ring_noise);
  YamlMap base = map.map("base");
  spec.base_measured = base.boolean("measured", spec.base_measured);
  spec.base_noise = parse_noise(base, spec.base_noise);
  base.finish();
  spec.dropout_probability = map.number("dropout_probability", {0.0, 1.0}, spec.dropout_probability);
  map.finish();
  return spec;
}

NumericsSpec parse_numerics(YamlMap map) {
  NumericsSpec spec;
  spec.elements = map.integer("elements", {2, 60}, spec.elements);
  spec.max_step_s = map.number("max_step_s", {1e-6, 0.05}, spec.max_step_s);
  map.finish();
  return spec;
}

}  // namespace

Scenario parse_scenario(const std::string& text, const std::string& source) {
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw ScenarioError(fmt::format("{}: line {}: {}", source, error.mark.line + 1, error.msg));
  }
  if (!document.IsMap())
    throw ScenarioError(fmt::format("{}: not a scenario: expected a map of keys", source));

  YamlMap map(document, source, "");
  Scenario scenario;
  if (map.integer("format", {1, 1}, 0) == 0) map.fail("format", "missing, required (1)");
  scenario.name = map.word("name");
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  if (scenario.name.size() > 100 || !std::all_of(scenario.name.begin(), scenario.name.end(), is_plain))
    map.fail("name", "allowed are up to 100 letters, digits, _ and -");
  scenario.seed = map.seed("seed", scenario.seed);
  scenario.duration_s = map.number("duration_s", {0.0, 1e6}, scenario.duration_s);
  scenario.gravity_m_s2 = map.number("gravity_m_s2", {0.0, 30.0}, scenario.gravity_m_s2);
  scenario.arm = parse_arm_spec(map.required_map("arm"));
  scenario.mount = parse_mount(map.map("mount"));
  scenario.pressures = parse_pressures(map.map("pressures"), scenario.arm.chambers.size());
  scenario.vacuum = parse_vacuum(map.map("vacuum"));
  scenario.payload = parse_payload(map.map("payload"));
  scenario.mocap = parse_mocap(map.map("mocap"));
  scenario.numerics = parse_numerics(map.map("numerics"));
  map.finish();
  const double needed = 2.0 * (scenario.pressures.settle_s + scenario.pressures.ramp_s);
  if (scenario.duration_s > 0.0 && scenario.duration_s < needed)
    map.fail(
        "duration_s",
        fmt::format("value {}, allowed 0 (endless) or from {} (pressures.settle_s and ramp_s at both ends)",
                    scenario.duration_s, needed));
  return scenario;
}

}  // namespace softarm::rig
