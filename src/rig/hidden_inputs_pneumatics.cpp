// Effects of regulators, valves, lines and their supply.
#include "hidden_inputs_parts.h"

namespace softarm::rig {
namespace {

void lag(const HiddenChoice& choice, Scenario& scenario) {
  need_pressures(scenario);
  using Form = PressureLag::Form;
  PressureLag spec;
  spec.chamber = chamber_index(choice, scenario);
  spec.form = choice.form == "choked"         ? Form::kChoked
              : choice.form == "second_order" ? Form::kSecondOrder
                                              : Form::kFirstOrder;
  spec.time_constant_s = choice.values.at("time_constant_s");
  spec.damping_ratio = choice.values.at("damping_ratio");
  spec.vent_time_constant_s = choice.values.at("vent_time_constant_s");
  spec.supply_pa = choice.values.at("supply_pa");
  put(scenario.input_path.pressure_lag, spec);
}

void leak(const HiddenChoice& choice, Scenario& scenario) {
  need_pressures(scenario);
  PressureLeak spec{chamber_index(choice, scenario), choice.values.at("share"), std::nullopt};
  if (choice.form == "in_holds") spec.time_s = choice.values.at("time_s");
  for (const PressureLeak& other : scenario.input_path.pressure_leaks)
    if (other.chamber == spec.chamber) throw std::invalid_argument("given twice for the same chamber");
  scenario.input_path.pressure_leaks.push_back(spec);
}

void sag(const HiddenChoice& choice, Scenario& scenario) {
  need(scenario.arm.chambers > 1, "an arm that takes several pressures");
  SupplySag spec{SupplySag::Form::kDroop, choice.values.at("share"), choice.values.at("reference_pa")};
  if (choice.form == "tank") {
    spec.form = SupplySag::Form::kTank;
    spec.refill_pa_per_s = choice.values.at("refill_pa_per_s");
  }
  put(scenario.input_path.supply_sag, spec);
}

}  // namespace

std::vector<HiddenEffect> pneumatic_effects() {
  const HiddenParameter chamber = chamber_number();
  return {
      {"pressure_lag",
       true,
       "pressures follow their command late: a line of first or second order, or a valve whose flow chokes "
       "and "
       "which vents in another way than it fills",
       {"first_order", "second_order", "choked"},
       {{"time_constant_s", 0.005, 100.0, 0.1, 0.5, "delay in slow ramps; choked: of small fillings"},
        {"damping_ratio", 0.05, 5.0, 0.4, 1.0, "of the second order", 0.7},
        {"vent_time_constant_s", 0.005, 100.0, 0.2, 0.8, "choked: of venting", 0.4},
        {"supply_pa", 1e3, 1e7, 2e5, 2e5, "choked: gauge pressure of the supply", 2e5},
        all_or_one_chamber()},
       lag},
      {"pressure_leak",
       true,
       "what acts is below what is commanded by a share, always or growing while the command holds",
       {"steady", "in_holds"},
       {chamber,
        {"share", 0.0, 0.9, 0.01, 0.05, "of the gauge pressure"},
        {"time_s", 0.05, 1e5, 2.0, 10.0, "in holds: time constant of the loss", 5.0}},
       leak},
      {"regulator_error",
       false,
       "the regulator's zero is off, and it works only while the error has exceeded a dead band",
       {},
       {{"offset_pa", -5e4, 5e4, -200.0, 200.0, "acts beyond what is commanded", 0.0},
        {"dead_band_pa", 0.0, 5e4, 1000.0, 4000.0, "error that it leaves alone", 0.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.regulator_error,
             RegulatorError{choice.values.at("offset_pa"), choice.values.at("dead_band_pa")});
       },
       "",
       "hysteresis"},
      {"valve_stiction",
       false,
       "the valve sticks: pressures move in steps",
       {},
       {{"step_pa", 1.0, 5e4, 1000.0, 4000.0, "of the command, until the valve slips"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         if (scenario.input_path.valve_step_pa > 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.valve_step_pa = choice.values.at("step_pa");
       },
       "",
       "hysteresis"},
      {"flow_limit",
       true,
       "pressures rise and fall no faster than the valves let them, each by itself (slew), or all rising "
       "ones together (shared: one supply feeds them)",
       {"slew", "shared"},
       {{"rise_pa_per_s", 10.0, 1e8, 4e3, 2e4, "at most"},
        {"fall_pa_per_s", 0.0, 1e8, 4e3, 2e4, "at most; 0: as the rise", 0.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         const double rise = choice.values.at("rise_pa_per_s"), fall = choice.values.at("fall_pa_per_s");
         put(scenario.input_path.slew_limit,
             SlewLimit{rise, fall > 0.0 ? fall : rise, choice.form == "shared"});
       }},
      {"line_delay",
       false,
       "pressures arrive later by a dead time",
       {},
       {{"delay_s", 1e-4, 100.0, 0.05, 0.2, "from command to chamber"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         if (scenario.input_path.line_delay_s > 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.line_delay_s = choice.values.at("delay_s");
       },
       "clock_offset"},
      {"supply_sag",
       true,
       "all chambers hang on one supply: it droops when the others are open (droop), or is a tank that they "
       "empty and a pump fills again at a constant rate (tank)",
       {"droop", "tank"},
       {{"share", 0.0, 0.9, 0.05, 0.2, "of a chamber's pressure that is lost at most"},
        {"reference_pa", 1.0, 1e7, 4e4, 8e4,
         "droop: sum of the others' pressures at half of that; tank: what is taken of it at all of that",
         kReferencePa},
        {"refill_pa_per_s", 0.0, 1e7, 5e3, 2e4, "of the tank, in sum of pressures", 1e4, false, {"tank"}}},
       sag},
      {"supply_ripple",
       false,
       "the compressor runs in cycles, and all pressures rise and fall with its tank",
       {},
       {{"share", 0.0, 0.9, 0.04, 0.15, "of the pressures, from lowest to highest"},
        {"period_s", 0.02, 1e5, 3.0, 15.0, "of the cycle"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.supply_ripple,
             SupplyRipple{choice.values.at("share"), choice.values.at("period_s")});
       }},
  };
}

}  // namespace softarm::rig
