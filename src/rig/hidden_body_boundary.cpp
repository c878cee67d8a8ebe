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
       {{"stiffness_nm_per_rad", 1e-4, 1e6, 2.0, 20.0, "bending moment at the base over its turn"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.base_stiffness_nm_per_rad = choice.values.at("stiffness_nm_per_rad");
       }},
      {"base_tilt",
       true,
       "the arm stands tilted on the measured base",
       {},
       {{"angle_deg", 0.0, 60.0, 0.5, 2.0, "of the tilt"}, azimuth("towards which it tilts, base frame")},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         const double angle = angle_of(choice, "angle_deg"), azimuth_rad = angle_of(choice, "azimuth_deg");
         scenario.body.base_tilt_rad = {-angle * std::sin(azimuth_rad), angle * std::cos(azimuth_rad), 0.0};
       }},
      {"gravity_direction",
       true,
       "gravity is not along -z of the mocap frame",
       {},
       {{"angle_deg", 0.0, 90.0, 0.5, 2.0, "it is off by"}, azimuth("towards which it is off, mocap frame")},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         const double angle = angle_of(choice, "angle_deg"), azimuth_rad = angle_of(choice, "azimuth_deg");
         scenario.body.gravity_tilt_rad = {angle * std::cos(azimuth_rad), angle * std::sin(azimuth_rad)};
       }},
      {"base_free_play",
       true,
       "the clamp has clearance: the base turns freely so far, then is held, by a spring (ring) or by a stop "
       "that yields as Hertz's contact does (bush)",
       {"ring", "bush"},
       {{"play_deg", 0.0, 30.0, 0.3, 1.2, "how far it turns to every side"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.base_play_rad = angle_of(choice, "play_deg");
         scenario.body.base_bush = choice.form == "bush";
       }},
      {"payload_offset",
       true,
       "the payload's centre is off the place where it hangs",
       {},
       {{"axial_m", -1.0, 1.0, 0.01, 0.03, "along the arm's axis there", 0.0},
        {"lateral_m", 0.0, 1.0, 0.0, 0.02, "across it", 0.0},
        azimuth("of lateral_m, in the section frame", 0.0)},
       payload_offset},
      {"tip_mass",
       true,
       "a fitting at the tip that nobody weighed",
       {},
       {{"mass_kg", 0.0, 10.0, 0.005, 0.03, "its mass"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.tip_mass_kg = choice.values.at("mass_kg");
       }},
      {"tether",
       true,
       "something pulls at the tip towards an anchor beside the straight tip: a spring of no length, or a "
       "hose that pulls only when taut and whose weight hangs at the tip by half",
       {"spring", "hose"},
       {{"stiffness_n_per_m", 0.0, 1e5, 1.0, 5.0, "of its pull"},
        {"anchor_distance_m", 0.0, 10.0, 0.0, 0.1, "of the anchor from the straight tip", 0.0},
        azimuth("of the anchor, base frame", 0.0),
        {"slack_m", 0.0, 10.0, 0.005, 0.03, "of a hose, when the arm is straight", 0.01},
        {"hose_kg", 0.0, 10.0, 0.005, 0.03, "weight of a hose", 0.01}},
       tether},
      {"contact",
       true,
       "a wall beside the arm: touches it at one place, as a spring without friction (spring_wall); or all "
       "along, with Hunt and Crossley's law and friction (rough_wall, inclined by 90 degrees a floor), or a "
       "round post along the arm, with friction that grows with the speed (post)",
       {"spring_wall", "rough_wall", "post"},
       {{"stiffness_n_per_m", 0.0, 1e6, 30.0, 300.0,
         "of the wall; a rough one's or a post's against 20 mm of arm"},
        {"distance_m", 0.0, 10.0, 0.01, 0.05, "of the wall from the straight arm's axis"},
        azimuth("towards which the wall is, base frame"),
        {"fraction", 0.05, 1.0, 0.4, 1.0, "of the arm's length, where a spring_wall touches it", 0.7},
        {"inclination_deg", -90.0, 90.0, -10.0, 0.0, "of a rough wall over the tip", 0.0},
        {"friction", 0.0, 2.0, 0.1, 0.6, "of a rough wall or a post", 0.3},
        {"radius_m", 1e-3, 1.0, 0.01, 0.04, "of a post", 0.02, false, {"post"}}},
       contact},
  };
}

}  // namespace softarm::rig
