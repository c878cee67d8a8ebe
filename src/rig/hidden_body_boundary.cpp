// Effects of the base, of gravity and of what hangs on the arm or stands in its way.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "hidden_body.h"

namespace softarm::rig {
namespace {

void payload_offset(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  if (scenario.payload.schedule.empty()) throw std::invalid_argument("the scenario has no payload");
  const double lateral = choice.values.at("lateral_m"), angle = angle_of(choice, "azimuth_deg");
  scenario.body.payload_offset_m = {lateral * std::cos(angle), lateral * std::sin(angle),
                                    choice.values.at("axial_m")};
}

void tether(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  Tether tether;
  tether.stiffness_n_per_m = choice.values.at("stiffness_n_per_m");
  tether.anchor_distance_m = choice.values.at("anchor_distance_m");
  tether.anchor_azimuth_rad = angle_of(choice, "azimuth_deg");
  tether.hose = choice.form == "hose";
  if (tether.hose) {
    tether.slack_m = choice.values.at("slack_m");
    tether.hose_kg = choice.values.at("hose_kg");
  }
  scenario.body.tether = tether;
}

void contact(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  Wall wall;
  wall.stiffness_n_per_m = choice.values.at("stiffness_n_per_m");
  wall.distance_m = choice.values.at("distance_m");
  wall.azimuth_rad = angle_of(choice, "azimuth_deg");
  wall.fraction = choice.values.at("fraction");
  wall.everywhere = choice.form != "spring_wall";
  if (choice.form == "post") {
    wall.post_radius_m = choice.values.at("radius_m");
    wall.friction = choice.values.at("friction");
  } else if (wall.everywhere) {
    wall.inclination_rad = angle_of(choice, "inclination_deg");
    wall.friction = choice.values.at("friction");
    // The straight arm must be clear of it.
    const double reach_m = std::max(0.0, scenario.arm.length_m() * std::sin(wall.inclination_rad));
    if (wall.distance_m < reach_m)
      throw std::invalid_argument(
          fmt::format("distance_m is {}, allowed from {}: at its inclination the wall cuts "
                      "the straight arm",
                      wall.distance_m, reach_m));
  }
  scenario.body.wall = wall;
}

}  // namespace

std::vector<HiddenEffect> boundary_effects() {
  return {
      {"base_compliance",
       true,
       "the base turns under the load, though the measured body `base` does not",
       {},
       {{"stiffness_nm_per_rad", 1e-4, 1e6, 2.0, 20.0, "bending moment at the base per angle that it turns"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.base_stiffness_nm_per_rad = choice.values.at("stiffness_nm_per_rad");
       }},
      {"base_tilt",
       true,
       "the arm stands tilted on the measured base",
       {},
       {{"angle_deg", 0.0, 60.0, 0.5, 2.0, "angle of the tilt"},
        azimuth("azimuth towards which the arm tilts, base frame")},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         const double angle = angle_of(choice, "angle_deg"), azimuth_rad = angle_of(choice, "azimuth_deg");
         scenario.body.base_tilt_rad = {-angle * std::sin(azimuth_rad), angle * std::cos(azimuth_rad), 0.0};
       }},
      {"gravity_direction",
       true,
       "gravity is not along -z of the mocap frame",
       {},
       {{"angle_deg", 0.0, 90.0, 0.5, 2.0, "angle by which gravity is off"},
        azimuth("azimuth towards which gravity is off, mocap frame")},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         const double angle = angle_of(choice, "angle_deg"), azimuth_rad = angle_of(choice, "azimuth_deg");
         scenario.body.gravity_tilt_rad = {angle * std::cos(azimuth_rad), angle * std::sin(azimuth_rad)};
       }},
      {"base_free_play",
       true,
       "the clamp has clearance: the base turns freely within the play, and beyond it is held by a spring "
       "(ring) or by a stop that yields like a Hertz contact (bush)",
       {"ring", "bush"},
       {{"play_deg", 0.0, 30.0, 0.3, 1.2, "angle that the base can turn freely to every side"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.base_play_rad = angle_of(choice, "play_deg");
         scenario.body.base_bush = choice.form == "bush";
       }},
      {"payload_offset",
       true,
       "the payload's centre of mass is not at the place where the payload hangs",
       {},
       {{"axial_m", -1.0, 1.0, 0.01, 0.03, "distance along the arm's axis", 0.0},
        {"lateral_m", 0.0, 1.0, 0.0, 0.02, "distance across the arm's axis", 0.0},
        azimuth("azimuth of lateral_m, in the section frame", 0.0)},
       payload_offset},
      {"tip_mass",
       true,
       "a fitting at the tip that nobody weighed",
       {},
       {{"mass_kg", 0.0, 10.0, 0.005, 0.03, "mass of the fitting"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.tip_mass_kg = choice.values.at("mass_kg");
       }},
      {"tether",
       true,
       "something pulls the tip towards an anchor beside the straight tip: a spring with a rest length of "
       "zero, or a hose that pulls only when taut and half of whose weight hangs at the tip",
       {"spring", "hose"},
       {{"stiffness_n_per_m", 0.0, 1e5, 1.0, 5.0, "stiffness of the spring or hose"},
        {"anchor_distance_m", 0.0, 10.0, 0.0, 0.1, "distance of the anchor from the straight tip", 0.0},
        azimuth("azimuth of the anchor, base frame", 0.0),
        {"slack_m", 0.0, 10.0, 0.005, 0.03, "slack of a hose when the arm is straight", 0.01},
        {"hose_kg", 0.0, 10.0, 0.005, 0.03, "mass of a hose", 0.01}},
       tether},
      {"contact",
       true,
       "a wall beside the arm: it touches the arm at one place, as a spring without friction (spring_wall), "
       "or anywhere along the arm, with Hunt and Crossley's law and friction (rough_wall; inclined by 90 "
       "degrees it is a floor); or a round post along the arm, with friction that grows with the speed "
       "(post)",
       {"spring_wall", "rough_wall", "post"},
       {{"stiffness_n_per_m", 0.0, 1e6, 30.0, 300.0,
         "stiffness of the wall; of a rough wall or a post: against 20 mm of arm"},
        {"distance_m", 0.0, 10.0, 0.01, 0.05, "distance of the wall from the straight arm's axis"},
        azimuth("azimuth towards the wall, base frame"),
        {"fraction", 0.05, 1.0, 0.4, 1.0,
         "place where a spring_wall touches the arm, as a fraction of the arm's length", 0.7},
        {"inclination_deg", -90.0, 90.0, -10.0, 0.0, "inclination of a rough wall over the tip", 0.0},
        {"friction", 0.0, 2.0, 0.1, 0.6, "friction of a rough wall or a post", 0.3},
        {"radius_m", 1e-3, 1.0, 0.01, 0.04, "radius of a post", 0.02, false, {"post"}}},
       contact},
  };
}

}  // namespace softarm::rig
