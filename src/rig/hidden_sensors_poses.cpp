// Effects of what the cameras see: noise, bias, rings that are not where they should be.
#include "hidden_sensors.h"

namespace softarm::rig {
namespace {

void add_correlated_noise(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.correlated_noise.push_back({body_of(choice, scenario),
                                               {value.at("position_sd_m"), value.at("orientation_sd_rad")},
                                               value.at("correlation_s")});
}

void add_bias(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  MarkerBias bias;
  bias.body = body_of(choice, scenario);
  if (choice.form == "drawn")
    bias.drawn = {value.at("position_sd_m"), value.at("orientation_sd_rad")};
  else
    bias.given_m = {value.at("x_m"), value.at("y_m"), value.at("z_m")};
  scenario.sensors.biases.push_back(bias);
}

void add_slip(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.slips.push_back({body_of(choice, scenario), value.at("along_m"), value.at("sideways_m"),
                                    kRadPerDeg * value.at("direction_deg"), value.at("from_s")});
}

void add_wobble(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.wobbling.push_back({body_of(choice, scenario), kRadPerDeg * value.at("tilt_deg_per_g"),
                                       value.at("shift_m_per_g"), value.at("lag_s")});
}

void add_bump(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.bumps.push_back(
      {{value.at("x_m"), value.at("y_m"), value.at("z_m")},
       kRadPerDeg * Eigen::Vector3d(value.at("turn_x_deg"), value.at("turn_y_deg"), value.at("turn_z_deg")),
       value.at("from_s")});
}

}  // namespace

std::vector<HiddenEffect> pose_effects() {
  return {
      {"correlated_noise",
       false,
       "slowly varying noise of the mocap poses (first-order Gauss-Markov), in addition to the white noise",
       {},
       {body_parameter(),
        {"position_sd_m", 0.0, 1.0, 0.5e-4, 5e-4, "standard deviation of each coordinate", 0.0},
        {"orientation_sd_rad", 0.0, 1.0, 1e-3, 1e-2, "standard deviation about each axis", 0.0},
        {"correlation_s", 1e-4, 1e5, 0.1, 5.0, "time in which the correlation falls to 1/e"}},
       add_correlated_noise},
      {"marker_bias",
       false,
       "constant error of a body's pose in its own frame; drawn: normal, from the seed, separately for each "
       "body; given: x, y, z",
       {"drawn", "given"},
       {body_parameter(),
        {"position_sd_m",
         0.0,
         0.1,
         1e-4,
         8e-4,
         "standard deviation of each coordinate",
         0.0,
         false,
         {"drawn"}},
        {"orientation_sd_rad",
         0.0,
         0.5,
         2e-3,
         2e-2,
         "standard deviation about each axis",
         0.0,
         false,
         {"drawn"}},
        {"x_m", -0.1, 0.1, -1e-3, 1e-3, "across the arm", 0.0, false, {"given"}},
        {"y_m", -0.1, 0.1, -1e-3, 1e-3, "across the arm", 0.0, false, {"given"}},
        {"z_m", -0.1, 0.1, -1e-3, 1e-3, "along the arm", 0.0, false, {"given"}}},
       add_bias,
       "marker_slip"},
      {"marker_slip",
       true,
       "one ring (or the base's markers) has moved from where it was mounted",
       {},
       {{"body", 0.0, 64.0, 1.0, 4.0, "0: base, 1: ring_1, ...", std::nullopt, true},
        {"along_m", -0.5, 0.5, -4e-3, 4e-3, "distance along the arm at rest, towards the tip", 0.0},
        {"sideways_m", 0.0, 0.1, 0.5e-3, 3e-3, "distance across the arm", 0.0},
        {"direction_deg", -360.0, 360.0, -180.0, 180.0,
         "direction across the arm, about the ring's z axis from its x", 0.0},
        {"from_s", 0.0, 1e6, 0.0, 8.0, "time at which it moves; 0: before the trial", 0.0}},
       add_slip},
      {"wobbling_ring",
       false,
       "a loosely mounted ring tilts and shifts towards the apparent weight (gravity less acceleration) "
       "across "
       "the arm",
       {},
       {one_body_parameter(),
        {"tilt_deg_per_g", -180.0, 180.0, 0.5, 5.0, "tilt of its z axis per g across the arm", 0.0},
        {"shift_m_per_g", -0.1, 0.1, 2e-4, 2e-3, "shift of its centre per g across the arm", 0.0},
        {"lag_s", 0.0, 1e3, 0.0, 0.1, "time constant with which it follows, first order", 0.0}},
       add_wobble},
      {"bumped_cameras",
       false,
       "the cameras' tripod was bumped: from then on all bodies are shifted and turned about the mocap "
       "origin",
       {},
       {{"x_m", -10.0, 10.0, -0.01, 0.01, "shift along x", 0.0},
        {"y_m", -10.0, 10.0, -0.01, 0.01, "shift along y", 0.0},
        {"z_m", -10.0, 10.0, -0.01, 0.01, "shift along z", 0.0},
        {"turn_x_deg", -180.0, 180.0, -0.5, 0.5, "x of the rotation vector", 0.0},
        {"turn_y_deg", -180.0, 180.0, -0.5, 0.5, "y of the rotation vector", 0.0},
        {"turn_z_deg", -180.0, 180.0, -0.5, 0.5, "z of the rotation vector", 0.0},
        {"from_s", 0.0, 1e6, 1.0, 8.0, "time of the bump", 0.0}},
       add_bump},
  };
}

}  // namespace softarm::rig
