#include "protocol.h"

#include <algorithm>
#include <cmath>

#include "moves.h"
#include "random_stream.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kPressurePurpose = 0x70726573, kTensionPurpose = 0x74656e73,
                        kAnglePurpose = 0x616e676c, kProgramme = 0x10000;

/// Value `index` of a schedule whose changes take ramp_s.
double scheduled(const std::vector<Setpoint>& schedule, std::size_t index, double ramp_s, double t_s) {
  double value = schedule.front().values[index];
  for (std::size_t i = 1; i < schedule.size() && t_s > schedule[i].t_s; ++i)
    value += (schedule[i].values[index] - value) *
             smooth_ramp((t_s - schedule[i].t_s) / schedule[i].over_s.value_or(ramp_s));
  return value;
}

}  // namespace

double smooth_ramp(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

Protocol::Protocol(const Scenario& scenario) : scenario_(scenario) {
  pressures_ = drive(scenario.pressures, scenario.arm.chambers, kPressurePurpose);
  tensions_ = drive(scenario.tensions, scenario.arm.tendons, kTensionPurpose);
  angles_ = drive(scenario.angles, scenario.arm.servos, kAnglePurpose);
}

Protocol::Drive Protocol::drive(const DriveSpec& spec, int inputs, std::uint64_t purpose) const {
  Drive result{spec, std::vector<std::vector<Sinusoid>>(static_cast<std::size_t>(inputs)), nullptr};
  if (!spec.programme.empty())
    result.programme = std::make_shared<Moves>(spec, inputs, scenario_.seed, purpose + kProgramme);
  if (!spec.random) return result;
  const RandomDrive& random = *spec.random;
  for (std::vector<Sinusoid>& sum : result.sinusoids) {
    RandomStream stream(scenario_.seed, purpose++);
    for (int i = 0; i < random.sinusoids; ++i) {
      // One frequency in each part of the band, so that no draw leaves the arm still.
      const double place = (i + stream.uniform()) / random.sinusoids;
      const double hz = random.lowest_hz + (random.highest_hz - random.lowest_hz) * place;
      sum.push_back({hz, stream.uniform(0.0, 2.0 * M_PI)});
    }
  }
  return result;
}

std::vector<double> Protocol::values(const Drive& drive, double t_s) const {
  const DriveSpec& spec = drive.spec;
  double envelope = smooth_ramp((t_s - spec.settle_s) / spec.ramp_s);
  double left_s = scenario_.duration_s - spec.settle_s - t_s;
  if (drive.programme) {
    // It begins and ends at rest by itself; only one that is cut short is brought there.
    envelope = 1.0;
    const double whole_s = spec.settle_s + drive.programme->length_s();
    if (!spec.programme.repeat && whole_s <= scenario_.duration_s - spec.settle_s + 1e-9)
      left_s = spec.ramp_s;
  }
  if (scenario_.duration_s > 0.0) envelope *= smooth_ramp(left_s / spec.ramp_s);
  std::vector<double> result;
  for (std::size_t input = 0; input < drive.sinusoids.size(); ++input) {
    double value = spec.rest;
    if (spec.random) {
      double sum = 0.0;
      for (const Sinusoid& s : drive.sinusoids[input]) sum += std::sin(2.0 * M_PI * s.hz * t_s + s.phase);
      sum *= std::sqrt(2.0 / spec.random->sinusoids);
      const double low = spec.random->min[input], high = spec.random->max[input];
      value = 0.5 * (low + high) + 0.5 * (high - low) * std::tanh(sum);
    } else if (drive.programme) {
      value = drive.programme->value(input, t_s - spec.settle_s);
    } else if (!spec.schedule.empty()) {
      value = scheduled(spec.schedule, input, spec.ramp_s,
                        spec.repeat_s > 0.0 ? std::fmod(t_s, spec.repeat_s) : t_s);
    }
    if (!spec.steps.empty()) value += scheduled(spec.steps, input, spec.step_ramp_s, t_s);
    result.push_back(std::max(spec.lowest, spec.rest + envelope * (value - spec.rest)));
  }
  return result;
}

ProgrammeTimes Protocol::programme_times() const {
  const auto length_s = [](const Drive& drive) {
    return drive.programme ? drive.programme->length_s() : 0.0;
  };
  return {length_s(pressures_), length_s(tensions_), length_s(angles_)};
}

Commands Protocol::at(double t_s) const {
  Commands commands;
  commands.pressures_pa = values(pressures_, t_s);
  commands.tensions_n = values(tensions_, t_s);
  commands.angles_rad = values(angles_, t_s);
  const VacuumSpec& vacuum = scenario_.vacuum;
  if (!vacuum.schedule.empty()) commands.vacuum_pa = scheduled(vacuum.schedule, 0, vacuum.ramp_s, t_s);

  // The payload goes from one setpoint to the next, and in a repeated schedule from the last to the first.
  const PayloadSpec& payload = scenario_.payload;
  if (payload.schedule.empty()) return commands;
  const bool repeated = payload.repeat_s > 0.0 && t_s >= payload.repeat_s;
  const double t = repeated ? std::fmod(t_s, payload.repeat_s) : t_s;
  std::size_t current = 0;
  while (current + 1 < payload.schedule.size() && payload.schedule[current + 1].t_s <= t) ++current;
  const Setpoint& to = payload.schedule[current];
  commands.payload_kg = to.values[0];
  if (current == 0 && !repeated) return commands;
  const double from = (current == 0 ? payload.schedule.back() : payload.schedule[current - 1]).values[0];
  const double since = t - to.t_s;
  if (from == to.values[0]) return commands;
  commands.payload_kg = from + (to.values[0] - from) * smooth_ramp(since / payload.ramp_s);
  // The hand takes hold at once, right after the instant: a step of the integration that ends there is still
  // free. It lets go over the last quarter.
  if (since > 0.0 && since < payload.steady_s)
    commands.hand_damping_n_s_m =
        payload.hand_damping_n_s_m * (1.0 - smooth_ramp((since / payload.steady_s - 0.75) / 0.25));
  return commands;
}

PayloadChange Protocol::payload_known_at(double t_s) const {
  const PayloadSpec& payload = scenario_.payload;
  if (payload.schedule.empty()) return {};
  const double shifted = t_s - 0.5 * payload.ramp_s;
  double cycle = 0.0;
  if (payload.repeat_s > 0.0 && shifted > 0.0)
    cycle = payload.repeat_s * std::floor(shifted / payload.repeat_s);
  const double t = shifted - cycle;
  std::size_t current = 0;
  while (current + 1 < payload.schedule.size() && payload.schedule[current + 1].t_s <= t) ++current;
  const bool from_the_start = current == 0 && cycle == 0.0;
  return {from_the_start ? 0.0 : cycle + payload.schedule[current].t_s + 0.5 * payload.ramp_s,
          payload.schedule[current].values[0] * (1.0 + scenario_.input_path.payload_scale_share)};
}

}  // namespace softarm::rig
