// Effects of the material: what a section answers to bending.
#include <cmath>
#include <stdexcept>

#include "hidden_body.h"
#include "hidden_inputs_parts.h"
#include "random_stream.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kLeftPurpose = 0x6c656674;

/// The core of an arm that can be jammed.
JammedCore& core(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  need_jamming(scenario);
  if (!scenario.body.core) scenario.body.core = JammedCore{};
  return *scenario.body.core;
}

void jamming_yield(const HiddenChoice& choice, Scenario& scenario) {
  JammedCore& jammed = core(choice, scenario);
  jammed.yield_per_m = choice.values.at("yield_per_m");
  jammed.smooth = choice.form == "bouc_wen";
}

void strain_stiffening(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  scenario.body.stiffening = Stiffening{choice.values.at("beta_m2"), choice.form == "gent"};
}

void curvature_softening(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  scenario.body.softening =
      Softening{choice.values.at("share"), choice.values.at("knee_per_m"), choice.form == "wrinkling"};
}

/// What drives the arm comes late through the walls of all segments, and something was left in them.
void wall_creep(const HiddenChoice& choice, Scenario& scenario) {
  constexpr double kDecades = 0.4;
  const double share = choice.values.at("share");
  RandomStream random(scenario.seed, kLeftPurpose);
  for (SegmentSpec& segment : scenario.arm.segments) {
    if (!segment.creep.moment.empty()) throw std::invalid_argument("the arm's wall creeps already");
    segment.creep.moment = {{choice.values.at("time_s"), share / (1.0 + share), kDecades}};
    const double towards = random.uniform(0.0, 2.0 * M_PI);
    segment.creep.before_moment_nm =
        choice.values.at("left_nm") * Eigen::Vector2d(std::cos(towards), std::sin(towards));
  }
}

void creep(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  if (choice.form == "wall") return wall_creep(choice, scenario);
  scenario.body.creep = Creep{choice.values.at("share"), choice.values.at("time_s"), choice.form == "prony"};
}

SideStiffness side(const HiddenChoice& choice, Scenario& scenario) {
  refuse_twice(choice, scenario);
  return {angle_of(choice, "azimuth_deg"), choice.values.at("share"), choice.values.at("to_fraction"),
          choice.form == "ribs" || choice.form == "folds"};
}

}  // namespace

std::vector<HiddenEffect> material_effects() {
  return {
      {"strain_stiffening",
       true,
       "stiffer at large curvature: EI u (1 + beta u^2), or EI u / (1 - beta u^2)",
       {"cubic", "gent"},
       {{"beta_m2", 0.0, 1.0, 3e-4, 2e-3, "beta"}},
       strain_stiffening},
      {"curvature_softening",
       true,
       "softer at large curvature: the section turns oval, EI u (1 - share x^2 / (1 + x^2)), x = u / knee; "
       "or the wall wrinkles beyond the knee, where the moment tends to twice its value at the knee",
       {"oval", "wrinkling"},
       {{"share", 0.0, 0.85, 0.15, 0.5,
         "oval: share of EI that is lost; wrinkling: share of the full loss of moment"},
        {"knee_per_m", 1e-2, 1e3, 1.5, 5.0, "curvature of the knee"}},
       curvature_softening},
      {"creep",
       true,
       "the curvature grows under a held load, with one time constant (maxwell: a standard linear solid) or "
       "with five a decade apart (prony); or the drive acts through the wall with a broad spectrum of times, "
       "and something of it is left at the start (wall)",
       {"maxwell", "prony", "wall"},
       {{"share", 0.0, 10.0, 0.05, 0.2, "share by which the curvature grows in the end"},
        {"time_s", 1e-3, 1e6, 5.0, 60.0, "time constant; prony: the middle one"},
        {"left_nm",
         0.0,
         10.0,
         0.0,
         0.05,
         "moment that is left in each segment at the start, in a direction from the seed",
         0.0,
         false,
         {"wall"}}},
       creep},
      {"mullins",
       true,
       "stiffer on first loading: where the curvature has not been so large before (ogden_roxburgh), or "
       "everywhere, but less so the larger the curvature has been (softening)",
       {"ogden_roxburgh", "softening"},
       {{"share", 0.0, 5.0, 0.05, 0.2, "share by which the arm is stiffer"},
        {"scale_per_m", 1e-2, 1e3, 1.0, 5.0, "scale of the differences of curvature", 2.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         refuse_twice(choice, scenario);
         scenario.body.first_loading = FirstLoading{
             choice.values.at("share"), choice.values.at("scale_per_m"), choice.form == "ogden_roxburgh"};
       }},
      {"jamming_memory",
       true,
       "the jammed core keeps the curvature at which the vacuum was applied",
       {},
       {{"share", 0.0, 1.0, 0.3, 1.0, "share of that curvature that the core keeps"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         core(choice, scenario).memory = choice.values.at("share");
       }},
      {"jamming_yield",
       true,
       "the jammed core slips beyond a curvature: sharply (elastoplastic) or gradually (bouc_wen)",
       {"elastoplastic", "bouc_wen"},
       {{"yield_per_m", 1e-2, 1e3, 1.0, 6.0, "elastic curvature at which the core slips"}},
       jamming_yield},
      {"plane_stiffness",
       true,
       "the bending stiffness in one plane differs from that across it: the same at every bend (oval), or "
       "less where the arm is bent far (ribs)",
       {"oval", "ribs"},
       {{"share", -0.9, 10.0, 0.1, 0.4, "share by which the stiffness is larger in that plane"},
        azimuth("azimuth of the plane, in the section frame"),
        {"to_fraction", 0.0, 1.0, 1.0, 1.0, "acts only from the base up to this fraction of the arm", 1.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         scenario.body.plane_stiffness = side(choice, scenario);
       }},
      {"one_sided_softness",
       true,
       "softer when bent to one side, as if the wall on that side buckled at once (buckles) or bit by bit "
       "(folds)",
       {"buckles", "folds"},
       {{"share", -3.0, 0.9, 0.1, 0.4, "share by which the arm is softer towards that side"},
        azimuth("azimuth of the side, in the section frame"),
        {"to_fraction", 0.0, 1.0, 0.4, 1.0, "acts only from the base up to this fraction of the arm", 1.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         scenario.body.one_sided_softness = side(choice, scenario);
       }},
  };
}

}  // namespace softarm::rig
