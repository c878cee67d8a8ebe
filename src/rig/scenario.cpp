#include "scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "protocol.h"
#include "scenario_parts.h"

namespace softarm::rig {
namespace {

constexpr std::size_t kMaxRings = 64;

/// Absent: none.
std::optional<Eigen::Quaterniond> parse_quaternion(YamlMap& map) {
  if (!map.has("quaternion_xyzw")) return std::nullopt;
  const std::vector<double> q = map.numbers("quaternion_xyzw", {-1.001, 1.001}, 4, 4);
  const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
  if (std::abs(quaternion.norm() - 1.0) > 1e-3)
    map.fail("quaternion_xyzw", fmt::format("norm {:.6g}, allowed 0.999 ... 1.001", quaternion.norm()));
  return quaternion.normalized();
}

MountSpec parse_mount(YamlMap map) {
  MountSpec mount;
  if (map.has("position_m")) {
    const std::vector<double> p = map.numbers("position_m", {-100.0, 100.0}, 3, 3);
    mount.p_mocap_base = {p[0], p[1], p[2]};
  }
  const bool named = map.has("attitude");
  if (const auto quaternion = parse_quaternion(map)) {
    if (named) map.fail("quaternion_xyzw", "given together with attitude; give one of them only");
    mount.q_mocap_base = *quaternion;
  } else if (named) {
    const std::string word = map.word("attitude");
    const std::optional<Eigen::Quaterniond> q = attitude_named(word);
    if (!q)
      map.fail("attitude",
               fmt::format("value {}, allowed hanging, standing, horizontal", word.substr(0, 60)));
    mount.q_mocap_base = *q;
  }
  const double turn = kRadPerDeg * map.number("rotation_deg", {-360.0, 360.0}, 0.0);
  mount.q_mocap_base =
      mount.q_mocap_base * Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  map.finish();
  return mount;
}

VacuumSpec parse_vacuum(YamlMap map) {
  VacuumSpec spec;
  spec.ramp_s = map.number("ramp_s", {0.01, 1e4}, spec.ramp_s);
  spec.schedule = parse_schedule(map, "vacuum_pa", {0.0, 101325.0}, std::nullopt, spec.ramp_s, true);
  map.finish();
  return spec;
}

PayloadSpec parse_payload(YamlMap map) {
  PayloadSpec spec;
  spec.fraction = map.number("fraction", {0.01, 1.0}, spec.fraction);
  spec.ramp_s = map.number("ramp_s", {0.01, 1e3}, spec.ramp_s);
  spec.steady_s = map.number("steady_s", {0.0, 1e3}, spec.steady_s);
  spec.hand_damping_n_s_m = map.number("hand_damping_n_s_m", {0.0, 1e4}, spec.hand_damping_n_s_m);
  spec.publish = map.boolean("publish", spec.publish);
  const double change_s = std::max(spec.ramp_s, spec.steady_s);
  spec.schedule = parse_schedule(map, "kg", {0.0, 100.0}, std::nullopt, change_s, false);
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

TrackedBody parse_tracked(YamlMap& map, TrackedBody body) {
  if (map.has("name")) body.name = map.word("name");
  if (map.has("position_m")) {
    const std::vector<double> p = map.numbers("position_m", {-100.0, 100.0}, 3, 3);
    body.p_section = {p[0], p[1], p[2]};
  }
  body.q_section = parse_quaternion(map).value_or(body.q_section);
  return body;
}

/// The list `rings`: bodies with names of their own, which may sit beside their section.
void parse_rings(YamlMap& map, MocapSpec& spec) {
  if (map.has("ring_fractions"))
    map.fail("rings", "given together with ring_fractions; give one of them only");
  spec.ring_fractions.clear();
  std::set<std::string> names{spec.base.name};
  for (YamlMap& entry : map.maps("rings")) {
    const double fraction = entry.number("fraction", {0.0, 1.0});
    if (!spec.ring_fractions.empty() && fraction < spec.ring_fractions.back())
      entry.fail("fraction",
                 fmt::format("value {} after {}, must not decrease", fraction, spec.ring_fractions.back()));
    spec.ring_fractions.push_back(fraction);
    spec.rings.push_back(parse_tracked(entry, {fmt::format("ring_{}", spec.ring_fractions.size())}));
    if (!names.insert(spec.rings.back().name).second)
      entry.fail("name", fmt::format("value {}, is that of another body", spec.rings.back().name));
    entry.finish();
  }
  if (spec.rings.empty() || spec.rings.size() > kMaxRings)
    map.fail("rings", fmt::format("{} rings, allowed 1 ... {}", spec.rings.size(), kMaxRings));
}

MocapSpec parse_mocap(YamlMap map) {
  MocapSpec spec;
  spec.rate_hz = map.number("rate_hz", {1.0, 2000.0}, spec.rate_hz);
  YamlMap base = map.map("base");
  spec.base = parse_tracked(base, spec.base);
  if (map.has("rings")) {
    parse_rings(map, spec);
  } else if (map.has("ring_fractions")) {
    spec.ring_fractions = map.numbers("ring_fractions", {0.0, 1.0}, 1, kMaxRings);
    for (std::size_t i = 1; i < spec.ring_fractions.size(); ++i)
      if (!(spec.ring_fractions[i] > spec.ring_fractions[i - 1]))
        map.fail("ring_fractions", fmt::format("value {} after {}, must increase from base to tip",
                                               spec.ring_fractions[i], spec.ring_fractions[i - 1]));
  }
  spec.ring_noise = parse_noise(map, spec.ring_noise);
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

std::optional<Eigen::Quaterniond> attitude_named(const std::string& word) {
  // Half a turn about x, or a quarter about y: x of the base stays in the vertical plane of x.
  if (word == "hanging") return Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  if (word == "horizontal")
    return Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
  if (word == "standing") return Eigen::Quaterniond::Identity();
  return std::nullopt;
}

std::pair<double, std::string> least_duration(const Scenario& scenario) {
  std::pair<double, std::string> least{0.0, ""};
  const ProgrammeTimes times = Protocol(scenario).programme_times();
  const std::tuple<const char*, const DriveSpec&, bool, double> drives[] = {
      {"pressures", scenario.pressures, true, times.pressures_s},
      {"tensions", scenario.tensions, scenario.arm.tendons > 0, times.tensions_s},
      {"angles", scenario.angles, scenario.arm.servos > 0, times.angles_s}};
  for (const auto& [name, drive, used, programme_s] : drives) {
    const double whole_s = 2.0 * drive.settle_s + programme_s;
    if (programme_s > 0.0 && !drive.programme.repeat && whole_s > least.first)
      least = {whole_s, fmt::format("{}.programme, and settle_s", name)};
    const double needed_s = 2.0 * (drive.settle_s + drive.ramp_s);
    if (used && needed_s > least.first) least = {needed_s, fmt::format("{}.settle_s and ramp_s", name)};
  }
  return least;
}

Scenario parse_scenario(const std::string& text, const std::string& source) {
  YamlMap map = load_document(text, source, "a scenario");
  Scenario scenario;
  if (map.integer("format", {1, 1}, 0) == 0) map.fail("format", "missing, required (1)");
  scenario.name = map.plain_name("name");
  scenario.seed = map.seed("seed", scenario.seed);
  scenario.duration_s = map.number("duration_s", {0.0, 1e6}, scenario.duration_s);
  scenario.session_s = map.number("session_s", {0.0, 1e6}, scenario.session_s);
  scenario.gravity_m_s2 = map.number("gravity_m_s2", {0.0, 30.0}, scenario.gravity_m_s2);
  constexpr double kLeastGravity_m_s2 = 1e-3;  // as of an arm file
  if (scenario.gravity_m_s2 != 0.0 && scenario.gravity_m_s2 < kLeastGravity_m_s2)
    map.fail("gravity_m_s2",
             fmt::format("value {:g}, allowed 0, or {} and more", scenario.gravity_m_s2, kLeastGravity_m_s2));
  scenario.arm = parse_arm_spec(map.required_map("arm"));
  scenario.mount = parse_mount(map.map("mount"));
  scenario.pressures = parse_pressures(map.map("pressures"), scenario.arm);
  scenario.tensions = parse_tensions(map.map("tensions"), scenario.arm);
  scenario.angles = parse_angles(map.map("angles"), scenario.arm);
  scenario.vacuum = parse_vacuum(map.map("vacuum"));
  scenario.payload = parse_payload(map.map("payload"));
  scenario.mocap = parse_mocap(map.map("mocap"));
  scenario.numerics = parse_numerics(map.map("numerics"));
  parse_hidden(map, scenario);  // last: it builds on all of the above
  map.finish();
  const auto [needed_s, what] = least_duration(scenario);
  if (scenario.duration_s > 0.0 && scenario.duration_s < needed_s - 1e-9)
    map.fail("duration_s", fmt::format("value {}, allowed 0 (endless) or from {:.6g} ({} at both ends)",
                                       scenario.duration_s, needed_s, what));
  return scenario;
}

}  // namespace softarm::rig
