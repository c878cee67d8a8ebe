// Effects along the arm: what differs from section to section, or gives way besides bending. Torsion is among
// the laws of the inputs.
#include <fmt/format.h>

#include <stdexcept>

#include "hidden_body.h"

namespace softarm::rig {
namespace {

void soft_spot(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  const SoftSpot spot{choice.values.at("centre_fraction"), choice.values.at("width_fraction"),
                      choice.values.at("share"), choice.form == "bell"};
  const double half = 0.5 * spot.width_fraction;
  if (spot.centre_fraction < half || spot.centre_fraction > 1.0 - half)
    throw std::invalid_argument(fmt::format("centre_fraction is {}, allowed {} ... {} for its width",
                                            spot.centre_fraction, half, 1.0 - half));
  scenario.body.soft_spot = spot;
}

void rigid_ends(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  constexpr double kMost = 0.8;  // of the arm
  const RigidEnds ends{choice.values.at("base_m"), choice.values.at("tip_m")};
  const double most_m = kMost * scenario.arm.length_m();
  if (ends.base_m + ends.tip_m > most_m)
    throw std::invalid_argument(
        fmt::format("base_m and tip_m sum to {}, allowed 0 ... {}", ends.base_m + ends.tip_m, most_m));
  scenario.body.rigid_ends = ends;
}

void axial_compliance(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  for (SegmentSpec& segment : scenario.arm.segments) {
    if (segment.axial_stiffness_n) throw std::invalid_argument("the arm has an axial_stiffness_n of its own");
    segment.axial_stiffness_n = choice.values.at("axial_stiffness_n");
  }
}

void shear(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  for (SegmentSpec& segment : scenario.arm.segments) {
    if (segment.shear_stiffness_n) throw std::invalid_argument("the arm has a shear_stiffness_n of its own");
    segment.shear_stiffness_n = choice.values.at("shear_stiffness_n");
  }
}

void mass_distribution(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  if (choice.form == "lump")
    scenario.body.mass_lump = MassLump{choice.values.at("share"), choice.values.at("lump_fraction")};
  else
    scenario.body.mass_taper = choice.values.at("share");
}

}  // namespace

std::vector<HiddenEffect> profile_effects() {
  return {
      {"stiffness_taper",
       true,
       "bending stiffness falls or rises along each segment: EI (1 + a (2 s / L - 1)); or in a step in its "
       "middle, where two casts meet: EI (1 - a), EI (1 + a)",
       {"linear", "step"},
       {{"share", -0.9, 0.9, -0.3, 0.3, "a"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.stiffness_taper = choice.values.at("share");
         scenario.body.stiffness_steps = choice.form == "step";
       }},
      {"soft_spot",
       true,
       "bending stiffness is lower over a short stretch: evenly, with a smooth edge of a quarter of the "
       "stretch at each end (even), or most at its centre (bell)",
       {"even", "bell"},
       {{"centre_fraction", 0.0, 1.0, 0.2, 0.8, "centre of the stretch, as a fraction of the arm's length"},
        {"width_fraction", 0.02, 0.6, 0.1, 0.25, "length of the stretch, as a fraction of the arm's length"},
        {"share", -3.0, 0.9, 0.15, 0.5, "share by which the stiffness is lower; of a bell: at its centre"}},
       soft_spot},
      {"rigid_ends",
       true,
       "end caps that neither bend nor are bent by the actuation",
       {},
       {{"base_m", 0.0, 1.0, 0.005, 0.02, "length of the end cap at the base"},
        {"tip_m", 0.0, 1.0, 0.005, 0.015, "length of the end cap at the tip"}},
       rigid_ends},
      {"actuation_taper",
       true,
       "the moment of the actuation falls or rises along each segment: M0 (1 + a (2 s / L - 1)); or in a "
       "step in its middle, where the winding of the chambers changes: M0 (1 - a), M0 (1 + a)",
       {"linear", "step"},
       {{"share", -0.9, 0.9, -0.2, 0.2, "a"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.actuation_taper = choice.values.at("share");
         scenario.body.actuation_steps = choice.form == "step";
       }},
      {"mass_distribution",
       true,
       "the arm's weight is not uniform: it tapers along each segment, 1 + a (2 s / L - 1), or has a lump",
       {"taper", "lump"},
       {{"share", -0.9, 0.9, 0.1, 0.3, "a; lump: share of the arm's mass in the lump"},
        {"lump_fraction", 0.0, 1.0, 0.3, 0.9, "place of the lump, as a fraction of the arm's length", 0.5}},
       mass_distribution},
      {"axial_compliance",
       true,
       "the arm stretches under its weight and payload",
       {},
       {{"axial_stiffness_n", 1.0, 1e8, 100.0, 500.0, "EA"}},
       axial_compliance},
      {"shear",
       true,
       "the arm shears under its weight and payload",
       {},
       {{"shear_stiffness_n", 1.0, 1e8, 30.0, 150.0, "GA"}},
       shear},
  };
}

}  // namespace softarm::rig
