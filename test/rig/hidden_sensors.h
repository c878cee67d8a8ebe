// Scenarios with hidden faults of the sensors, on an arm that hardly costs time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rig/hidden.h"
#include "rig/receipt_queue.h"
#include "rig/scenario_text.h"
#include "rig/simulator.h"

namespace softarm::rig {

/// Three rings, all input kinds' messages of kScenarioText, no noise, nothing lost.
inline Scenario quiet(double duration_s = 10.0) {
  Scenario s = parse_scenario(kScenarioText, "case.yaml");
  s.seed = 11;
  s.duration_s = duration_s;
  s.mocap.rate_hz = 100.0;
  s.mocap.ring_fractions = {0.3, 0.6, 1.0};
  s.mocap.ring_noise = s.mocap.base_noise = PoseNoise{};
  s.mocap.dropout_probability = 0.0;
  s.numerics.elements = 3;
  s.numerics.max_step_s = 0.01;
  return s;
}

/// An arm that rests: its ideal poses are the same in all frames.
inline Scenario resting(double duration_s) {
  Scenario s = quiet(duration_s);
  s.pressures.random.reset();
  s.pressures.schedule = {{0.0, {20e3, 0.0, 0.0}}};
  s.pressures.rest = 0.0;
  s.pressures.settle_s = 1e6;
  s.payload.schedule.clear();
  return s;
}

/// Hides an effect; what `values` does not say is the parameter's default.
inline void hide(const std::string& effect, std::map<std::string, double> values, Scenario& scenario,
                 const std::string& form = "") {
  const HiddenEffect& known = *find_hidden_effect(effect);
  const std::string full = form.empty() && !known.forms.empty() ? known.forms.front() : form;
  for (const HiddenParameter& parameter : known.parameters)
    if (parameter.is_of(full) && parameter.otherwise) values.try_emplace(parameter.key, *parameter.otherwise);
  hide(HiddenChoice{effect, full, values}, scenario);
}

inline std::vector<Sample> samples_of(const Scenario& scenario) {
  Simulator simulator(scenario);
  std::vector<Sample> samples;
  while (std::optional<Sample> sample = simulator.next()) samples.push_back(std::move(*sample));
  return samples;
}

/// All messages in the order of receipt.
inline std::vector<Received> received_of(const std::vector<Sample>& samples) {
  ReceiptQueue queue;
  std::vector<Received> received;
  const auto take = [&](double until_s) {
    while (std::optional<Received> one = queue.take(until_s)) received.push_back(*one);
  };
  for (const Sample& sample : samples) {
    queue.add(sample);
    take(sample.stamp_s);
  }
  take(1e9);
  return received;
}

/// Where a body really is: 0 is the base.
inline Pose true_pose(const Scenario& s, const Sample& sample, std::size_t body) {
  const Pose base = body == 0 ? Pose{} : sample.truth.rings_base[body - 1];
  return {s.mount.p_mocap_base + s.mount.q_mocap_base * base.p, s.mount.q_mocap_base * base.q};
}

/// Measured less true, as a rotation vector in the body's frame.
inline Eigen::Vector3d turn_between(const Pose& truth, const Pose& measured) {
  const Eigen::AngleAxisd turn(truth.q.conjugate() * measured.q);
  return turn.angle() * turn.axis();
}

/// Input messages of one kind and number.
inline std::vector<InputSample> inputs_of(const std::vector<Sample>& samples, InputKind kind, int number) {
  std::vector<InputSample> inputs;
  for (const Sample& sample : samples)
    for (const InputSample& input : sample.inputs)
      if (input.kind == kind && input.number == number) inputs.push_back(input);
  return inputs;
}

inline std::vector<double> values_of(const std::vector<InputSample>& inputs) {
  std::vector<double> values;
  for (const InputSample& input : inputs) values.push_back(input.value);
  return values;
}

}  // namespace softarm::rig
