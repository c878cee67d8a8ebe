// Effects of the body that the catalogue does not have: air that moves, a wall that kinks, a coupling that
// plays.
#include <fmt/format.h>

#include <stdexcept>

#include "hidden_body.h"

namespace softarm::rig {
namespace {

/// A stretch from a fraction on, as it fits the arm and what answers as a whole already.
Stretch stretch_of(const Scenario& scenario, double from, double width) {
  constexpr double kSame = 2e-3;  // of the arm: what is as near as that to an end of the stretch is there
  const Stretch stretch{from, from + width};
  if (stretch.to > 1.0)
    throw std::invalid_argument(fmt::format("fraction is {}, allowed up to {:g}", from, 1.0 - width));
  const auto refuse_within = [&](double fraction, const char* what) {
    if (fraction > stretch.from + kSame && fraction < stretch.to - kSame)
      throw std::invalid_argument(
          fmt::format("fraction is {}: {} at {:.4g}, allowed are places up to {:.4g} and from there on", from,
                      what, fraction, fraction - width));
  };
  double end_m = 0.0;
  for (const SegmentSpec& segment : scenario.arm.segments) {
    end_m += segment.length_m;
    refuse_within(end_m / scenario.arm.length_m(), "a segment ends");
  }
  if (!scenario.payload.schedule.empty()) refuse_within(scenario.payload.fraction, "the payload hangs");
  for (const Stretch& other : scenario.body.stretches())
    if (stretch.from < other.to + kSame && other.from < stretch.to + kSame)
      throw std::invalid_argument(fmt::format(
          "fraction is {}: another effect has the stretch {:.4g} ... {:.4g}", from, other.from, other.to));
  return stretch;
}

void draught(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  scenario.body.draught =
      Draught{choice.values.at("force_n"), choice.values.at("correlation_s"), choice.form == "sheltered"};
}

void kink(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  Kink kink;
  kink.stretch = stretch_of(scenario, choice.values.at("fraction"), choice.values.at("width_fraction"));
  kink.share = choice.values.at("share");
  kink.fold_per_m = choice.values.at("fold_per_m");
  kink.unfold_per_m = choice.values.at("unfold_share") * kink.fold_per_m;
  scenario.body.kink = kink;
}

void joint_play(const HiddenChoice& choice, Scenario& scenario) {
  constexpr double kWidth = 0.02;  // of the arm
  refuse_twice(choice, scenario);
  scenario.body.joint_play =
      JointPlay{stretch_of(scenario, choice.values.at("fraction"), kWidth), angle_of(choice, "play_deg")};
}

}  // namespace

std::vector<HiddenEffect> outside_effects() {
  return {
      {"draught",
       false,
       "air that moves pushes the arm across, horizontally and slowly varying at random: the same all along "
       "(even), or more the farther from the base, which is in the lee (sheltered)",
       {"even", "sheltered"},
       {{"force_n", 0.0, 100.0, 0.003, 0.02, "rms; across the tip it would bend an evenly stiff arm as far"},
        {"correlation_s", 0.1, 1e5, 1.0, 8.0, "after which a correlation of 1/e is left"}},
       draught},
      {"kink",
       false,
       "a short stretch whose wall kinks: bent to a curvature it folds and is softer in that plane, until it "
       "is bent back to a smaller one",
       {},
       {{"share", 0.0, 0.9, 0.15, 0.6, "by which its bending stiffness drops"},
        {"fraction", 0.0, 1.0, 0.15, 0.7, "where the stretch begins, of the arm's length"},
        {"fold_per_m", 1e-2, 1e3, 1.0, 4.0, "curvature at which it folds"},
        {"unfold_share", 0.05, 1.0, 0.4, 0.8, "of that curvature, at which it unfolds", 0.6},
        {"width_fraction", 0.01, 0.3, 0.04, 0.08, "how long it is, of the arm's length", 0.05}},
       kink},
      {"joint_play",
       false,
       "a coupling along the arm has clearance: it turns freely so far, then holds",
       {},
       {{"play_deg", 0.0, 30.0, 0.3, 1.2, "how far it turns in every direction"},
        {"fraction", 0.05, 0.95, 0.3, 0.7, "where it is, of the arm's length"}},
       joint_play},
  };
}

}  // namespace softarm::rig
