#include "experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/statistics.h"
#include "softarm/arm/arm_file.h"
#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/shipped.h"

namespace softarm::app::validate {
namespace {

constexpr double kSettleS = 0.5;
constexpr double kRateHz = 20.0;

double last_time_s(std::size_t holds, const HoldTiming& timing) {
  return kSettleS + static_cast<double>(holds) * timing.dwell_s;
}

void schedule(rig::DriveSpec& drive, const std::vector<Hold>& holds, const HoldTiming& timing,
              std::vector<double> Hold::*values) {
  drive.random.reset();
  drive.programme = {};
  drive.steps.clear();
  drive.repeat_s = 0.0;
  drive.rest = 0.0;
  // The envelope from rest to the protocol is over before the first hold.
  drive.settle_s = 0.0;
  drive.ramp_s = timing.ramp_s;
  drive.schedule.clear();
  if (holds.empty() || (holds.front().*values).empty()) return;
  drive.schedule.push_back({0.0, std::vector<double>((holds.front().*values).size(), 0.0)});
  for (std::size_t i = 0; i < holds.size(); ++i)
    drive.schedule.push_back({last_time_s(i, timing), holds[i].*values});
}

/// In the order of Arm::inputs.scalars.
arm::InputValues input_values(const arm::Arm& arm, const Hold& hold) {
  std::size_t pressure = 0, tension = 0, angle = 0;
  arm::InputValues values;
  for (const arm::ScalarInput& input : arm.inputs.scalars) {
    switch (input.kind) {
      case arm::InputKind::kPressure:
        values.emplace_back(hold.pressures_pa.at(pressure++));
        break;
      case arm::InputKind::kVacuum:
        values.emplace_back(hold.vacuum_pa);
        break;
      case arm::InputKind::kTension:
        values.emplace_back(hold.tensions_n.at(tension++));
        break;
      case arm::InputKind::kAngle:
        values.emplace_back(hold.angles_rad.at(angle++));
        break;
    }
  }
  return values;
}

trial::Frame frame_of(const rig::Sample& sample, const std::vector<std::string>& names, const arm::Arm& arm,
                      const Hold& hold) {
  trial::Frame frame;
  frame.stamp_ns = trial::to_nanoseconds(sample.stamp_s);
  frame.inputs = input_values(arm, hold);
  frame.payload_kg = hold.payload_kg;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!sample.bodies[i]) continue;
    const rig::Pose& pose = *sample.bodies[i];
    if (arm.base.body && names[i] == *arm.base.body) {
      frame.base_body = Eigen::Translation3d(pose.p) * pose.q;
      continue;
    }
    for (std::size_t body = 0; body < arm.bodies.size(); ++body) {
      if (arm.bodies[body].name == names[i]) frame.bodies.push_back({static_cast<int>(body), pose.p, pose.q});
    }
  }
  return frame;
}

}  // namespace

arm::Arm shipped_arm(const std::string& name) {
  return arm::load_arm_file(name, config_folders("arms"));
}

rig::Scenario shipped_scenario(const std::string& name) {
  const auto path = find_config("scenarios", name);
  return rig::parse_scenario(read_text(path), path.string());
}

void make_real_like(rig::Scenario& scenario, double tension_range_n, double angle_range_rad) {
  const rig::SegmentSpec& segment = scenario.arm.segments.front();
  const double stiffness_nm2 = segment.stiffness_by_pressure.empty()
                                   ? segment.stiffness_base_nm2
                                   : segment.stiffness_by_pressure.front().bending_stiffness_nm2;
  // 5 N m/rad at a base that carries an arm of 0.027 N m^2 over 0.2 m.
  scenario.body.base_stiffness_nm_per_rad = 5.0 * (stiffness_nm2 / segment.length_m) / (0.027 / 0.2);
  scenario.input_path.pressure_play_pa = 2500.0;
  scenario.input_path.tension_play_n = 0.05 * tension_range_n;
  scenario.input_path.angle_play_rad = 0.05 * angle_range_rad;
}

std::vector<Held> run_holds(rig::Scenario scenario, const arm::Arm& arm, const std::vector<Hold>& holds,
                            std::uint64_t seed, const HoldTiming& timing) {
  scenario.seed = seed;
  scenario.duration_s = 0.0;
  scenario.mocap.rate_hz = kRateHz;
  scenario.mocap.dropout_probability = 0.0;
  scenario.numerics.max_step_s = 0.01;
  for (rig::SegmentSpec& segment : scenario.arm.segments) segment.retardation_s = timing.viscoelastic_lag_s;
  schedule(scenario.pressures, holds, timing, &Hold::pressures_pa);
  schedule(scenario.tensions, holds, timing, &Hold::tensions_n);
  schedule(scenario.angles, holds, timing, &Hold::angles_rad);
  scenario.vacuum.schedule.clear();
  scenario.vacuum.ramp_s = timing.ramp_s;
  scenario.payload.schedule = {{0.0, {0.0}}};
  scenario.payload.ramp_s = timing.ramp_s;
  scenario.payload.steady_s = timing.ramp_s;
  scenario.payload.repeat_s = 0.0;
  const bool vacuum =
      std::any_of(arm.inputs.scalars.begin(), arm.inputs.scalars.end(),
                  [](const arm::ScalarInput& i) { return i.kind == arm::InputKind::kVacuum; });
  if (vacuum) scenario.vacuum.schedule.push_back({0.0, {0.0}});
  for (std::size_t i = 0; i < holds.size(); ++i) {
    const double t_s = last_time_s(i, timing);
    if (vacuum) scenario.vacuum.schedule.push_back({t_s, {holds[i].vacuum_pa}});
    scenario.payload.schedule.push_back({t_s, {holds[i].payload_kg}});
  }

  rig::Simulator simulator(scenario);
  std::vector<Held> result(holds.size());
  const auto first = [&](std::size_t hold) {
    return std::lround(last_time_s(hold + 1, timing) * kRateHz) - timing.frames;
  };
  std::vector<rig::Pose> rings;
  std::size_t hold = 0;
  for (long k = 0; hold < holds.size(); ++k) {
    const std::optional<rig::Sample> sample = simulator.next();
    if (k < first(hold)) continue;
    Held& held = result[hold];
    if (k == first(hold)) rings = sample->truth.rings_base;
    held.frames.push_back(frame_of(*sample, simulator.body_names(), arm, holds[hold]));
    held.truth = sample->truth;
    if (held.frames.size() < static_cast<std::size_t>(timing.frames)) continue;
    for (std::size_t i = 0; i < rings.size(); ++i)
      held.moving_m = std::max(held.moving_m, (held.truth.rings_base[i].p - rings[i].p).norm());
    ++hold;
  }
  return result;
}

std::uint64_t seed_of(std::uint64_t run, std::uint64_t paper, std::uint64_t part) {
  // Mixing of SplitMix64 (Steele, Lea, Flood 2014).
  std::uint64_t z = run * 0x9e3779b97f4a7c15ull + paper * 0xd1342543de82ef95ull + part;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

Statistics statistics(std::vector<double> values) {
  Statistics s;
  s.count = values.size();
  if (values.empty()) {
    s.mean = s.median = s.maximum = s.minimum = s.sd = std::numeric_limits<double>::quiet_NaN();
    return s;
  }
  const double n = static_cast<double>(values.size());
  s.minimum = *std::min_element(values.begin(), values.end());
  s.maximum = *std::max_element(values.begin(), values.end());
  s.median = math::median(values);
  s.mean = math::mean(values);
  double squares = 0.0;
  for (double v : values) squares += (v - s.mean) * (v - s.mean);
  s.sd = values.size() > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0;
  return s;
}

}  // namespace softarm::app::validate
