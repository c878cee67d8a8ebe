#include "sensors_inputs.h"

#include <algorithm>
#include <cmath>

#include "sensors_poses.h"

namespace softarm::rig {

InputSensors::InputSensors(const Scenario& scenario, const Protocol& protocol)
    : scenario_(scenario),
      protocol_(protocol),
      pressures_{&scenario.pressures, MessageClock(scenario, MessageStream::kInputs, 0)},
      tensions_{&scenario.tensions, MessageClock(scenario, MessageStream::kInputs, 1)},
      angles_{&scenario.angles, MessageClock(scenario, MessageStream::kInputs, 2)} {}

InputSensors::Sensor& InputSensors::sensor(InputKind kind, int number) {
  const auto [place, is_new] = sensors_.try_emplace({kind, number});
  Sensor& one = place->second;
  if (!is_new) return one;
  const SensorSpec& spec = scenario_.sensors;
  const auto concerns_it = [&](const auto& fault) {
    return fault.kind == kind && concerns(fault.number, number);
  };
  for (const InputError& error : spec.input_gains)
    if (concerns_it(error)) one.gain *= 1.0 + error.size;
  for (const InputError& error : spec.input_offsets)
    if (concerns_it(error)) one.offset += error.size;
  for (const InputError& error : spec.input_clocks)
    if (concerns_it(error)) one.clock_s += error.size;
  for (std::size_t i = 0; i < spec.input_noises.size(); ++i)
    if (concerns_it(spec.input_noises[i])) {
      const std::size_t part = 256 * static_cast<std::size_t>(kind) + static_cast<std::size_t>(number);
      one.noises.emplace_back(spec.input_noises[i].size,
                              stream_of(scenario_.seed, SensorPurpose::kInputNoise, i, part));
    }
  for (const InputError& error : spec.input_steps)
    if (concerns_it(error) && error.size > 0.0) one.steps.push_back(error.size);
  for (const InputFault& fault : spec.input_stuck)
    if (concerns_it(fault)) one.stuck.push_back(fault.times);
  for (const InputFault& fault : spec.input_dead)
    if (concerns_it(fault)) one.dead.push_back(fault.times);
  return one;
}

std::optional<double> InputSensors::measure(InputKind kind, int number, double t_s, double value) {
  Sensor& one = sensor(kind, number);
  value = value * one.gain + one.offset;
  for (auto& [sd, random] : one.noises) value += sd * random.normal();
  for (double step : one.steps) value = step * std::round(value / step);
  const auto now = [t_s](const FaultTimes& times) { return times.has(t_s); };
  if (one.last && std::any_of(one.stuck.begin(), one.stuck.end(), now)) value = *one.last;
  one.last = value;
  if (std::any_of(one.dead.begin(), one.dead.end(), now)) return std::nullopt;
  return value;
}

bool InputSensors::is_in_gap(double t_s) const {
  const std::vector<Gap>& gaps = scenario_.sensors.gaps;
  return std::any_of(gaps.begin(), gaps.end(), [t_s](const Gap& gap) {
    return gap.stream == MessageStream::kInputs && gap.times.has(t_s);
  });
}

template <typename Add>
void InputSensors::send(Sender& sender, double until_s, const Add& add) {
  for (;; ++sender.sent) {
    const double sent_s = static_cast<double>(sender.sent) / sender.drive->rate_hz;
    if (sent_s > until_s) return;
    add(sent_s, sender.clock.time(sent_s), protocol_.at(sent_s));
  }
}

std::vector<InputSample> InputSensors::messages_until(double until_s) {
  std::vector<InputSample> messages;
  const auto add = [&](double sent_s, const Timing& timing, InputKind kind, int number, double value,
                       double zero) {
    const std::optional<double> measured = measure(kind, number, sent_s, value);
    if (measured && !is_in_gap(sent_s))
      messages.push_back(
          {timing.stamp_s + sensor(kind, number).clock_s, kind, number, zero + *measured, timing.receipt_s});
  };
  const auto add_all = [&](double sent_s, const Timing& timing, InputKind kind,
                           const std::vector<double>& values, double zero) {
    for (std::size_t i = 0; i < values.size(); ++i)
      add(sent_s, timing, kind, static_cast<int>(i), values[i], zero);
  };
  const double ambient_pa = scenario_.pressures.ambient_pa;
  send(pressures_, until_s, [&](double t_s, const Timing& timing, const Commands& commands) {
    add_all(t_s, timing, InputKind::kChamber, commands.pressures_pa, ambient_pa);
    if (!scenario_.vacuum.schedule.empty())
      add(t_s, timing, InputKind::kVacuum, 0, -commands.vacuum_pa, ambient_pa);
  });
  if (scenario_.arm.tendons > 0)
    send(tensions_, until_s, [&](double t_s, const Timing& timing, const Commands& commands) {
      add_all(t_s, timing, InputKind::kTendon, commands.tensions_n, 0.0);
    });
  if (scenario_.arm.servos > 0)
    send(angles_, until_s, [&](double t_s, const Timing& timing, const Commands& commands) {
      add_all(t_s, timing, InputKind::kServo, commands.angles_rad, 0.0);
    });
  std::stable_sort(messages.begin(), messages.end(),
                   [](const InputSample& a, const InputSample& b) { return a.receipt_s < b.receipt_s; });
  return messages;
}

}  // namespace softarm::rig
