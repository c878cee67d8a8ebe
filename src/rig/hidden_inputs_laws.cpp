// Effects in the laws from inputs to moment, stiffness and length.
#include "hidden_inputs_parts.h"
#include "scenario_parts.h"

namespace softarm::rig {
namespace {

LawSpec::ShareAt share_at(const HiddenChoice& choice) {
  return {choice.values.at("share"), choice.values.at("reference_pa")};
}

void torsion(const HiddenChoice& choice, Scenario& scenario) {
  if (choice.form == "compliance") {
    for (SegmentSpec& segment : scenario.arm.segments)
      segment.torsional_stiffness_nm2 = choice.values.at("stiffness_ratio") * segment.stiffness_base_nm2;
    return;
  }
  LawSpec& laws = scenario.input_path.laws;
  const double angle_rad = kRadPerDeg * choice.values.at("twist_deg");
  if (choice.form == "pressure") {
    need_pressures(scenario);
    put(laws.twist_with_pressure, LawSpec::Twist{angle_rad, choice.values.at("reference_pa")});
  } else {
    need(scenario.arm.tendons > 0, "an arm with tendons");
    put(laws.twist_with_tension, LawSpec::Twist{angle_rad, choice.values.at("reference_n")});
  }
}

void rest_curvature(const HiddenChoice& choice, Scenario& scenario) {
  const int number = static_cast<int>(choice.values.at("segment"));
  const auto count = static_cast<int>(scenario.arm.segments.size());
  if (number > count)
    throw std::invalid_argument("segment is " + std::to_string(number) + ", allowed 0 ... " +
                                std::to_string(count) + " (of the arm)");
  scenario.input_path.laws.rest_curvature.push_back(
      {number - 1, choice.values.at("curvature_per_m"), kRadPerDeg * choice.values.at("azimuth_deg")});
}

std::vector<HiddenEffect> pressure_laws() {
  const HiddenParameter at_pressure = reference(kReferencePa);
  return {
      {"gain_nonlinearity",
       true,
       "a chamber's moment is not proportional to its pressure",
       {"quadratic", "saturating"},
       {{"share", -0.9, 10.0, 0.08, 0.25, "share of the moment, in addition to the proportional one"},
        at_pressure},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_chambers(scenario);
         put(scenario.input_path.laws.gain_nonlinearity, {share_at(choice), choice.form == "saturating"});
       }},
      {"pressure_dead_zone",
       true,
       "no moment below a pressure, and above it as if the pressure were lower by that much; for one chamber "
       "alone its pressure itself is lower, also where it lengthens and stiffens the arm",
       {"sharp", "smooth"},
       {{"pressure_pa", 1.0, 1e6, 1500.0, 5000.0, "pressure up to which there is no moment"},
        all_or_one_chamber()},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_chambers(scenario);
         put(scenario.input_path.laws.dead_zone,
             LawSpec::DeadZone{choice.values.at("pressure_pa"), choice.form == "smooth",
                               chamber_index(choice, scenario)});
       }},
      {"pressure_stiffening",
       true,
       "EI grows with the mean pressure beyond the law of the arm file",
       {"linear", "quadratic"},
       {{"share", -0.9, 10.0, 0.08, 0.25, "share by which EI grows"}, at_pressure},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.laws.pressure_stiffening, {share_at(choice), choice.form == "quadratic"});
       }},
      {"radial_expansion",
       true,
       "the arm grows wider with the mean pressure: EI and GJ grow with the square of the radius if the wall "
       "gets thinner, with the fourth power if it does not",
       {"square", "fourth_power"},
       {{"share", -0.5, 5.0, 0.04, 0.12, "share by which the radius grows"}, at_pressure},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.laws.radial_expansion, {share_at(choice), choice.form == "square" ? 2 : 4});
       }},
      {"pressure_elongation",
       true,
       "the arm grows longer with the mean pressure beyond the law of the arm file",
       {},
       {{"share", -0.5, 2.0, 0.01, 0.04, "share by which the length grows"}, at_pressure},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.laws.pressure_elongation, share_at(choice));
       }},
      {"chamber_bulge",
       true,
       "neighbouring chambers bulge into each other: the moment of each grows with the others' pressures, in "
       "proportion (linear), or less where these are high (saturating)",
       {"linear", "saturating"},
       {{"share", -0.9, 10.0, 0.08, 0.25,
         "share of the moment that is added where the sum of the others' pressures is reference_pa"},
        at_pressure},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need(scenario.arm.chambers > 1, "an arm that takes several pressures");
         need_chambers(scenario);
         put(scenario.input_path.laws.chamber_bulge,
             LawSpec::ChamberBulge{share_at(choice), choice.form == "saturating"});
       }},
  };
}

std::vector<HiddenEffect> vacuum_laws() {
  const HiddenParameter at_vacuum = reference(kReferenceVacuumPa);
  return {
      {"vacuum_shortening",
       true,
       "the arm grows shorter with the vacuum",
       {},
       {{"share", -0.5, 0.5, 0.005, 0.02, "share by which the length shrinks"}, at_vacuum},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_vacuum(scenario);
         put(scenario.input_path.laws.vacuum_shortening, share_at(choice));
       }},
      {"vacuum_gain",
       true,
       "actuators bend the arm less under vacuum",
       {},
       {{"share", -0.9, 0.9, 0.05, 0.2, "share of the moments that is lost"}, at_vacuum},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_vacuum(scenario);
         put(scenario.input_path.laws.vacuum_gain, share_at(choice));
       }},
      {"jamming_law",
       false,
       "the EI that jamming adds is not proportional to the vacuum",
       {"saturating", "power"},
       {{"scale_pa", 100.0, 1e6, 1e4, 3e4, "saturating: vacuum at which 63 % of the limit is reached", 2e4},
        {"exponent", 0.05, 5.0, 0.4, 0.7, "power: exponent of the vacuum", 0.5},
        {"reference_pa", 1.0, 1e6, kReferenceVacuumPa, kReferenceVacuumPa,
         "vacuum at which the EI is as the arm file says", kReferenceVacuumPa}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_jamming(scenario);
         put(scenario.input_path.laws.jamming_law,
             LawSpec::JammingLaw{choice.form == "power", choice.values.at("reference_pa"),
                                 choice.values.at("exponent"), choice.values.at("scale_pa")});
       }},
  };
}

std::vector<HiddenEffect> geometry_laws() {
  const HiddenParameter chamber{"chamber", 1.0, 16.0, 1.0, 3.0, "number of the chamber", std::nullopt, true};
  return {
      {"chamber_mismatch",
       true,
       "the gain of one chamber is not as the arm file says",
       {},
       {chamber, {"share", -0.95, 10.0, 0.03, 0.1, "share by which its gain is higher"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_chambers(scenario);
         const int chamber_input = chamber_index(choice, scenario);
         auto& shares = scenario.input_path.laws.chamber_gain_share;
         if (!shares.emplace(chamber_input, choice.values.at("share")).second)
           throw std::invalid_argument("given twice for the same chamber");
       }},
      {"bending_plane_offset",
       true,
       "all actuators are turned about the arm's axis",
       {},
       {{"angle_deg", -180.0, 180.0, 3.0, 8.0, "angle by which they are turned"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         if (scenario.input_path.laws.actuators_turned_rad != 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.laws.actuators_turned_rad = kRadPerDeg * choice.values.at("angle_deg");
       }},
      {"rest_curvature",
       true,
       "the arm is curved without input or load, in a direction fixed in its body",
       {},
       {{"curvature_per_m", -100.0, 100.0, 0.15, 0.5, "curvature at rest"},
        {"azimuth_deg", -360.0, 360.0, 0.0, 360.0, "azimuth towards which it is bent", 0.0},
        {"segment", 0.0, 8.0, 0.0, 0.0, "number of the segment; 0: all", 0.0, true}},
       rest_curvature},
      {"torsion",
       true,
       "the arm twists: under load, as rubber does (compliance), or with the mean pressure or tension",
       {"compliance", "pressure", "tension"},
       {{"stiffness_ratio", 1e-3, 1e4, 0.4, 0.8, "compliance: GJ over EI, both at zero input", 2.0 / 3.0},
        {"twist_deg", -360.0, 360.0, 2.0, 5.0, "twist of each segment, at the reference", 3.0},
        reference(kReferencePa),
        {"reference_n", 1e-3, 1e4, 3.0, 3.0, "mean tension at which the twist is reached", 3.0}},
       torsion},
      {"tendon_slack",
       true,
       "cables that servos wind up are slack at first: until they are taut they do not pull (taut), or pull "
       "less (sags)",
       {"taut", "sags"},
       {{"angle_deg", 0.0, 180.0, 2.0, 8.0, "angle of the servo that takes up the slack"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need(scenario.arm.servos > 0, "an arm with cables that servos wind up");
         put(scenario.input_path.laws.cable_slack,
             LawSpec::Slack{kRadPerDeg * choice.values.at("angle_deg"), choice.form == "sags"});
       }},
      {"curvature_gain",
       true,
       "the moments of actuators depend on how far the arm is bent",
       {},
       {{"share_per_rad", -0.6, 2.0, 0.05, 0.15, "share of the moments per bending angle of the segment"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         if (scenario.input_path.laws.gain_share_per_rad != 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.laws.gain_share_per_rad = choice.values.at("share_per_rad");
       }},
  };
}

/// Whether cables have other segments to pass through.
bool cables_pass_through(const ArmSpec& arm) {
  for (std::size_t k = 1; k < arm.segments.size(); ++k)
    if (!arm.segments[k].cables.empty()) return true;
  return false;
}

std::vector<HiddenEffect> cable_laws() {
  return {
      {"tendon_length",
       true,
       "cables pass through the segments before theirs and are held: what those are bent towards a cable it "
       "lacks in its own, all of it (held), or where it is slack no more than is wound up (slackens)",
       {"held", "slackens"},
       {{"share", 0.0, 3.0, 0.4, 1.0,
         "of the bend before that a cable lacks; 1: as far from the axis there as in its own segment"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need(cables_pass_through(scenario.arm), "an arm with cables in a segment that follows another");
         put(scenario.input_path.laws.cables_through,
             LawSpec::CablesThrough{choice.values.at("share"), choice.form == "slackens"});
       }},
  };
}

}  // namespace

std::vector<HiddenEffect> law_effects() {
  std::vector<HiddenEffect> effects;
  for (const auto& part : {pressure_laws(), vacuum_laws(), geometry_laws(), cable_laws()})
    effects.insert(effects.end(), part.begin(), part.end());
  return effects;
}

}  // namespace softarm::rig
