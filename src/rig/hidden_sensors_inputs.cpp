// Effects of the sensors of pressures, tensions and angles. They act on what is published, not on the arm.
#include "hidden_sensors.h"

namespace softarm::rig {
namespace {

InputError error_of(const HiddenChoice& choice, InputKind kind, double size, const Scenario& scenario) {
  return {kind, number_of(choice, kind, scenario), size};
}

/// The size of a choice whose parameters are <quantity>_pa, _n and _rad, in the unit of its form.
InputError error_in_unit(const HiddenChoice& choice, const std::string& quantity, const Scenario& scenario) {
  const InputKind kind = kind_of(choice);
  const char* unit = kind == InputKind::kTendon ? "_n" : kind == InputKind::kServo ? "_rad" : "_pa";
  return error_of(choice, kind, choice.values.at(quantity + unit), scenario);
}

void add_pressure_offset(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_offsets.push_back(
      error_of(choice, kind_of(choice), choice.values.at("offset_pa"), scenario));
}

void add_tension_offset(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_offsets.push_back(
      error_of(choice, InputKind::kTendon, choice.values.at("offset_n"), scenario));
}

void add_angle_offset(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_offsets.push_back(
      error_of(choice, InputKind::kServo, choice.values.at("offset_rad"), scenario));
}

void add_gain(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_gains.push_back(
      error_of(choice, kind_of(choice), choice.values.at("share"), scenario));
}

void add_noise(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_noises.push_back(error_in_unit(choice, "sd", scenario));
}

void add_quantisation(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.input_steps.push_back(error_in_unit(choice, "step", scenario));
}

void add_stuck(const HiddenChoice& choice, Scenario& scenario) {
  const InputKind kind = kind_of(choice);
  scenario.sensors.input_stuck.push_back({kind, number_of(choice, kind, scenario), times_of(choice)});
}

void add_dead(const HiddenChoice& choice, Scenario& scenario) {
  const InputKind kind = kind_of(choice);
  scenario.sensors.input_dead.push_back({kind, number_of(choice, kind, scenario), times_of(choice)});
}

}  // namespace

std::vector<HiddenEffect> input_sensor_effects() {
  return {
      {"pressure_offset",
       true,
       "the zero of a pressure sensor is off: published values are off by a constant",
       {"pressure", "vacuum"},
       {number_parameter(), {"offset_pa", -2e5, 2e5, -2e3, 2e3, "published less true value"}},
       add_pressure_offset},
      {"tension_offset",
       false,
       "the zero of a tendon's load cell is off",
       {},
       {number_parameter(), {"offset_n", -1e4, 1e4, -0.1, 0.1, "published less true value"}},
       add_tension_offset},
      {"angle_offset",
       false,
       "the zero of a servo's encoder is off",
       {},
       {number_parameter(), {"offset_rad", -1e3, 1e3, -0.05, 0.05, "published less true value"}},
       add_angle_offset},
      {"sensor_gain",
       false,
       "the scale of an input's sensor is off: published values (pressures as gauge) are too large by a "
       "share",
       input_forms(),
       {number_parameter(), {"share", -0.9, 10.0, -0.05, 0.05, "0.01: 1 % too large"}},
       add_gain,
       "chamber_mismatch"},
      {"sensor_noise",
       false,
       "white noise of an input's sensor",
       input_forms(),
       {number_parameter(),
        {"sd_pa", 0.0, 1e5, 50.0, 500.0, "standard deviation", std::nullopt, false, {"pressure", "vacuum"}},
        {"sd_n", 0.0, 1e3, 0.005, 0.05, "standard deviation", std::nullopt, false, {"tension"}},
        {"sd_rad", 0.0, 10.0, 0.001, 0.01, "standard deviation", std::nullopt, false, {"angle"}}},
       add_noise},
      {"sensor_quantisation",
       false,
       "an input's values (pressures as gauge) are rounded to multiples of a step",
       input_forms(),
       {number_parameter(),
        {"step_pa", 0.0, 1e5, 50.0, 1000.0, "0: none", std::nullopt, false, {"pressure", "vacuum"}},
        {"step_n", 0.0, 1e3, 0.005, 0.1, "0: none", std::nullopt, false, {"tension"}},
        {"step_rad", 0.0, 10.0, 0.001, 0.02, "0: none", std::nullopt, false, {"angle"}}},
       add_quantisation},
      {"sensor_stuck", false, "an input's sensor repeats its last value", input_forms(),
       with_times({number_parameter()}), add_stuck},
      {"sensor_dead", false, "an input's sensor publishes nothing", input_forms(),
       with_times({number_parameter()}), add_dead},
  };
}

}  // namespace softarm::rig
