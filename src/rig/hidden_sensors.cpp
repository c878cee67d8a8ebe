// Effects of the sensors.
#include "hidden_sensors.h"

#include <fmt/format.h>

#include <stdexcept>

#include "hidden_tables.h"

namespace softarm::rig {

std::vector<HiddenEffect> sensor_effects() {
  std::vector<HiddenEffect> effects;
  for (const auto& part :
       {pose_effects(), camera_effects(), tracking_effects(), timing_effects(), input_sensor_effects()})
    effects.insert(effects.end(), part.begin(), part.end());
  return effects;
}

HiddenParameter body_parameter() {
  return {"body", -1.0, 64.0, 1.0, 4.0, "0: base, 1: ring_1, ...; -1: all bodies", -1.0, true};
}

HiddenParameter one_body_parameter() {
  HiddenParameter parameter = body_parameter();
  parameter.otherwise.reset();
  return parameter;
}

std::vector<HiddenParameter> with_times(std::vector<HiddenParameter> parameters) {
  parameters.push_back({"from_s", 0.0, 1e6, 1.0, 8.0, "time at which it begins", 0.0});
  parameters.push_back({"for_s", 0.0, 1e6, 0.2, 3.0, "how long it lasts; default: for ever", 1e6});
  parameters.push_back({"repeat_s", 0.0, 1e6, 5.0, 20.0, "period with which it comes again; 0: never", 0.0});
  return parameters;
}

HiddenParameter number_parameter() {
  return {"number", -1.0, 64.0, 1.0, 3.0, "1: chamber_1, tendon_1 or servo_1, ...; -1: all of them",
          -1.0,     true};
}

std::vector<std::string> input_forms() {
  return {"pressure", "vacuum", "tension", "angle"};
}

std::vector<std::string> stream_forms() {
  return {"mocap", "inputs"};
}

int body_of(const HiddenChoice& choice, const Scenario& scenario, const std::string& key) {
  const int body = static_cast<int>(choice.values.at(key));
  const int rings = static_cast<int>(scenario.mocap.ring_fractions.size());
  if (body > rings)
    throw std::invalid_argument(
        fmt::format("effect {}: {} is {}, allowed are the rings up to {}", choice.effect, key, body, rings));
  if (body == 0 && !scenario.mocap.base_measured)
    throw std::invalid_argument(fmt::format(
        "effect {}: {} is 0, allowed only where mocap.base.measured is true", choice.effect, key));
  return body;
}

FaultTimes times_of(const HiddenChoice& choice) {
  const FaultTimes times{choice.values.at("from_s"), choice.values.at("for_s"), choice.values.at("repeat_s")};
  if (times.repeat_s > 0.0 && times.repeat_s < times.for_s)
    throw std::invalid_argument(fmt::format("effect {}: repeat_s is {}, allowed 0, or for_s ({}) and more",
                                            choice.effect, times.repeat_s, times.for_s));
  return times;
}

MessageStream stream_of(const HiddenChoice& choice) {
  return choice.form == "mocap" ? MessageStream::kMocap : MessageStream::kInputs;
}

InputKind kind_of(const HiddenChoice& choice) {
  if (choice.form == "pressure") return InputKind::kChamber;
  if (choice.form == "vacuum") return InputKind::kVacuum;
  return choice.form == "tension" ? InputKind::kTendon : InputKind::kServo;
}

int number_of(const HiddenChoice& choice, InputKind kind, const Scenario& scenario) {
  const auto [inputs, words] = [&]() -> std::pair<int, const char*> {
    switch (kind) {
      case InputKind::kChamber:
        return {scenario.arm.chambers, "pressures"};
      case InputKind::kTendon:
        return {scenario.arm.tendons, "tensions"};
      case InputKind::kServo:
        return {scenario.arm.servos, "servo angles"};
      case InputKind::kVacuum:
        break;
    }
    return {scenario.vacuum.schedule.empty() ? 0 : 1, "vacuum"};
  }();
  if (inputs == 0)
    throw std::invalid_argument(fmt::format("effect {}: the scenario has no {}", choice.effect, words));
  const int number = static_cast<int>(choice.values.at("number"));
  if (number == 0 || number > inputs)
    throw std::invalid_argument(fmt::format("effect {}: number is {}, allowed -1 or 1 ... {} ({})",
                                            choice.effect, number, inputs, words));
  return number < 0 ? kAll : number - 1;
}

}  // namespace softarm::rig
