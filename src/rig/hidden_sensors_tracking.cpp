// Effects of tracking: bodies lost, frozen, flipped, swapped, wrong for a frame.
#include <fmt/format.h>

#include <stdexcept>

#include "hidden_sensors.h"

namespace softarm::rig {
namespace {

constexpr double kDegree = M_PI / 180.0;

void add_bursts(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.bursts.push_back(
      {body_of(choice, scenario), choice.values.at("share"), choice.values.at("mean_length_s")});
}

void add_occlusion(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.occlusions.push_back({body_of(choice, scenario), kDegree * value.at("beyond_deg"),
                                         kDegree * value.at("towards_deg"),
                                         kDegree * value.at("within_deg")});
}

void add_swap(const HiddenChoice& choice, Scenario& scenario) {
  const int first = body_of(choice, scenario, "body"), second = body_of(choice, scenario, "other_body");
  if (first == second)
    throw std::invalid_argument(
        fmt::format("effect {}: other_body is {}, allowed is any other than body", choice.effect, second));
  scenario.sensors.swapped.push_back({first, second, times_of(choice)});
}

void add_frozen(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.frozen.push_back({body_of(choice, scenario), times_of(choice)});
}

void add_flip(const HiddenChoice& choice, Scenario& scenario) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  if (choice.form == "about_x") axis = Eigen::Vector3d::UnitX();
  if (choice.form == "about_y") axis = Eigen::Vector3d::UnitY();
  if (choice.form == "about_z") axis = Eigen::Vector3d::UnitZ();
  scenario.sensors.flipped.push_back({body_of(choice, scenario), axis, times_of(choice)});
}

void add_jumps(const HiddenChoice& choice, Scenario& scenario) {
  const auto& value = choice.values;
  scenario.sensors.jumps.push_back({body_of(choice, scenario), value.at("probability"), value.at("size_m"),
                                    kDegree * value.at("turn_deg")});
}

}  // namespace

std::vector<HiddenEffect> tracking_effects() {
  return {
      {"dropout_bursts",
       false,
       "a body is lost for stretches of random length, independently of other bodies",
       {},
       {body_parameter(),
        {"share", 0.0, 0.5, 0.005, 0.1, "share of all frames in which it is lost"},
        {"mean_length_s", 1e-4, 1e4, 0.03, 0.5, "mean length of a stretch; at least one frame"}},
       add_bursts},
      {"occlusion",
       false,
       "a ring is lost while the arm is bent so far at the ring that the cameras do not see it",
       {},
       {body_parameter(),
        {"beyond_deg", 0.0, 180.0, 30.0, 80.0,
         "angle between the tangents at the base and at the ring, beyond which it is lost"},
        {"towards_deg", -360.0, 360.0, -180.0, 180.0, "direction of the bend in the base frame", 0.0},
        {"within_deg", 0.0, 180.0, 40.0, 120.0,
         "half width of the range about that direction; 180: any direction", 180.0}},
       add_occlusion},
      {"swapped_bodies",
       false,
       "two bodies have each other's name",
       {},
       with_times({{"body", 0.0, 64.0, 1.0, 2.0, "0: base, 1: ring_1, ...", std::nullopt, true},
                   {"other_body", 0.0, 64.0, 3.0, 4.0, "number of the other body", std::nullopt, true}}),
       add_swap},
      {"frozen_body",
       false,
       "a body's last pose is sent again and again, whether it is lost or not",
       {},
       with_times({one_body_parameter()}),
       add_frozen},
      {"flipped_body",
       false,
       "a body's orientation is off by half a turn (its markers are nearly symmetric); sign: q becomes -q, "
       "which "
       "is the same orientation",
       {"about_z", "about_x", "about_y", "sign"},
       with_times({one_body_parameter()}),
       add_flip},
      {"jumps",
       false,
       "a body jumps away for a single frame, in a random direction, independently of other bodies",
       {},
       {body_parameter(),
        {"probability", 0.0, 1.0, 5e-4, 5e-3, "probability for each frame"},
        {"size_m", 0.0, 10.0, 0.005, 0.1, "distance of the jump"},
        {"turn_deg", 0.0, 180.0, 0.0, 90.0, "angle by which its orientation is off, about a random axis",
         0.0}},
       add_jumps},
  };
}

}  // namespace softarm::rig
