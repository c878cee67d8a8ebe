// Faults of the sensors: of no size they change nothing, and one leaves the random numbers of the others
// alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "rig/hidden_sensors.h"

namespace softarm::rig {
namespace {

/// Those of the sensors: the table ends with them.
std::vector<HiddenEffect> sensor_effects() {
  const std::vector<HiddenEffect>& all = hidden_effects();
  const HiddenEffect* first = find_hidden_effect("correlated_noise");
  return {all.begin() + (first - all.data()), all.end()};
}

/// All that is published, to the last digit.
std::string published(const Scenario& scenario) {
  std::ostringstream out;
  out.precision(17);
  for (const Received& one : received_of(samples_of(scenario))) {
    out << one.receipt_s << ' ';
    if (const auto* payload = std::get_if<PayloadSample>(&one.message))
      out << payload->stamp_s << ' ' << payload->kg << '\n';
    else if (const auto* input = std::get_if<InputSample>(&one.message))
      out << input->stamp_s << ' ' << topic_of(input->kind, input->number) << ' ' << input->value << '\n';
    else {
      const auto& pose = std::get<PoseSample>(one.message);
      out << pose.stamp_s << ' ' << pose.body << ' ' << pose.pose.p.transpose() << ' '
          << pose.pose.q.coeffs().transpose() << '\n';
    }
  }
  return out.str();
}

/// A scenario with every kind of input, noise and dropouts.
Scenario everything() {
  Scenario s = quiet(1.0);
  s.mocap.ring_noise = {0.5e-3, 0.01};
  s.mocap.base_noise = {0.05e-3, 0.001};
  s.mocap.dropout_probability = 0.1;
  s.pressures.settle_s = s.pressures.ramp_s = 0.1;
  s.vacuum.ramp_s = 0.3;
  s.vacuum.schedule = {{0.0, {10.3e3}}, {0.2, {30.7e3}}};
  s.arm.segments[0].tendons = {{0, 0.3, 0.005}};
  s.arm.tendons = 1;
  s.tensions.schedule = {{0.0, {1.0}}};
  s.tensions.settle_s = s.tensions.ramp_s = 0.2;
  s.arm.segments[0].cables = {{0, 1.0, 0.01, 0.01}};
  s.arm.servos = 1;
  s.angles.schedule = {{0.0, {0.2}}};
  s.angles.settle_s = s.angles.ramp_s = 0.2;
  return s;
}

/// The value at which a parameter does nothing; absent: it has none.
std::optional<double> nothing(const HiddenParameter& parameter) {
  if (parameter.key == "beyond_deg") return 180.0;
  if (parameter.key == "for_s") return 0.0;
  for (const char* size : {"position_sd_m", "orientation_sd_rad",
                           "x_m",           "y_m",
                           "z_m",           "along_m",
                           "sideways_m",    "tilt_deg_per_g",
                           "shift_m_per_g", "turn_x_deg",
                           "turn_y_deg",    "turn_z_deg",
                           "share",         "probability",
                           "delay_s",       "jitter_s",
                           "sd_s",          "offset_s",
                           "drift_ppm",     "offset_pa",
                           "offset_n",      "offset_rad",
                           "sd_pa",         "sd_n",
                           "sd_rad",        "step_pa",
                           "step_n",        "step_rad",
                           "off",           "way_m2",
                           "tilt_rad_m"})
    if (parameter.key == size) return 0.0;
  return std::nullopt;
}

/// Some value for what is no size.
double any_value(const HiddenParameter& parameter) {
  if (parameter.whole) return parameter.key == "other_body" || parameter.key == "cameras" ? 2.0 : 1.0;
  return 0.5 * (parameter.usual_low + parameter.usual_high);
}

TEST(HiddenSensors, OfNoSizeNothingChanges) {
  const Scenario ideal = everything();
  const std::string without = published(ideal);
  for (const HiddenEffect& effect : sensor_effects()) {
    for (const std::string& form : effect.forms.empty() ? std::vector<std::string>{""} : effect.forms) {
      Scenario s = ideal;
      HiddenChoice choice{effect.id, form, {}};
      bool has_size = false;
      for (const HiddenParameter& parameter : effect.parameters) {
        if (!parameter.is_of(form)) continue;
        const std::optional<double> none = nothing(parameter);
        has_size = has_size || none;
        choice.values[parameter.key] = none.value_or(any_value(parameter));
      }
      EXPECT_TRUE(has_size) << effect.id;
      hide(choice, s);
      EXPECT_TRUE(published(s) == without) << effect.id << " " << form;
    }
  }
}

TEST(HiddenSensors, OfUsualSizeSomethingChanges) {
  const Scenario ideal = everything();
  const std::string without = published(ideal);
  for (const HiddenEffect& effect : sensor_effects()) {
    for (const std::string& form : effect.forms.empty() ? std::vector<std::string>{""} : effect.forms) {
      Scenario s = ideal;
      HiddenChoice choice{effect.id, form, {}};
      for (const HiddenParameter& parameter : effect.parameters) {
        if (!parameter.is_of(form)) continue;
        double value = parameter.whole ? any_value(parameter) : parameter.usual_high;
        if (parameter.key == "from_s") value = 0.3;
        if (parameter.key == "probability") value = 0.2;
        if (parameter.key == "share" && effect.id == "dropout_bursts") value = 0.5;
        if (parameter.key == "beyond_deg") value = 1e-3;
        if (parameter.key == "within_deg") value = 180.0;
        choice.values[parameter.key] = value;
      }
      hide(choice, s);
      EXPECT_FALSE(published(s) == without) << effect.id << " " << form;
    }
  }
}

TEST(HiddenSensors, OneLeavesTheRandomNumbersOfTheOthersAlone) {
  // Alone and with all others that draw numbers: the same jumps in the same frames.
  Scenario alone = resting(4.0);
  hide("jumps", {{"probability", 0.05}, {"size_m", 0.02}}, alone);
  Scenario among = alone;
  hide("dropout_bursts", {{"share", 0.2}, {"mean_length_s", 0.05}}, among);
  hide("latency", {{"delay_s", 0.01}, {"jitter_s", 0.003}}, among);
  hide("stamp_jitter", {{"sd_s", 0.001}}, among);
  hide("duplicated_frames", {{"probability", 0.1}}, among);
  hide("sensor_noise", {{"sd_pa", 100.0}}, among, "pressure");
  hide("dropout_bursts", {{"share", 0.1}, {"mean_length_s", 0.1}}, among);
  const std::vector<Sample> one = samples_of(alone), other = samples_of(among);
  ASSERT_EQ(one.size(), other.size());
  std::size_t compared = 0;
  for (std::size_t k = 0; k < one.size(); ++k)
    for (std::size_t i = 0; i < one[k].bodies.size(); ++i)
      if (other[k].bodies[i]) {
        EXPECT_EQ(one[k].bodies[i]->p, other[k].bodies[i]->p);
        ++compared;
      }
  EXPECT_GT(compared, 800u);

  // Two entries and two bodies of the same fault have numbers of their own.
  Scenario twice = resting(4.0);
  hide("marker_bias", {{"position_sd_m", 1e-3}}, twice);
  const Sample first = samples_of(twice)[0];
  hide("marker_bias", {{"position_sd_m", 1e-3}}, twice);
  const Sample both = samples_of(twice)[0];
  for (std::size_t i = 0; i < 4; ++i) {
    const Pose truth = true_pose(twice, first, i);
    const Eigen::Vector3d a = truth.q.conjugate() * (first.bodies[i]->p - truth.p);
    const Eigen::Vector3d b = truth.q.conjugate() * (both.bodies[i]->p - truth.p) - a;
    EXPECT_GT((a - b).norm(), 1e-5);
    EXPECT_GT(
        (a - truth.q.conjugate() * (first.bodies[(i + 1) % 4]->p - true_pose(twice, first, (i + 1) % 4).p))
            .norm(),
        1e-5);
  }
}

TEST(HiddenSensors, WhatDoesNotFitIsRefusedInALine) {
  const auto error_of = [](const std::string& item) -> std::string {
    try {
      parse_scenario(std::string(kScenarioText) + "hidden:\n  - " + item + "\n", "case.yaml");
    } catch (const ScenarioError& error) {
      return error.what();
    }
    return "no error";
  };
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_EQ(error_of("{effect: marker_slip, body: 2, along_m: 0.002}"), "no error");
  EXPECT_EQ(error_of("{effect: sensor_noise, form: pressure, sd_pa: 100}"), "no error");
  EXPECT_THAT(error_of("{effect: marker_slip, body: 3}"),
              AllOf(HasSubstr("body is 3"), HasSubstr("up to 2")));
  EXPECT_THAT(error_of("{effect: marker_slip, body: 1.5}"), HasSubstr("whole numbers"));
  EXPECT_THAT(error_of("{effect: marker_slip}"), HasSubstr("body: missing"));
  EXPECT_THAT(error_of("{effect: swapped_bodies, body: 1, other_body: 1}"), HasSubstr("any other"));
  EXPECT_THAT(error_of("{effect: frozen_body, body: 1, for_s: 3, repeat_s: 2}"),
              AllOf(HasSubstr("repeat_s is 2"), HasSubstr("for_s (3)")));
  EXPECT_THAT(error_of("{effect: sensor_gain, form: tension, share: 0.1}"), HasSubstr("no tensions"));
  EXPECT_THAT(error_of("{effect: sensor_gain, number: 4, share: 0.1}"), HasSubstr("1 ... 3"));
  EXPECT_THAT(error_of("{effect: sensor_noise, form: pressure, sd_n: 1}"),
              AllOf(HasSubstr("sd_n"), HasSubstr("not of form pressure"), HasSubstr("tension")));
  EXPECT_THAT(error_of("{effect: dropout_bursts, share: 0.6, mean_length_s: 1}"), HasSubstr("0 ... 0.5"));
}

}  // namespace
}  // namespace softarm::rig
