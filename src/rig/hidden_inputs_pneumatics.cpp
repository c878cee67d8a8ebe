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
       "pressures follow their command late: through a line of first or second order, or through a valve "
       "whose flow chokes, with separate time constants for filling and venting",
       {"first_order", "second_order", "choked"},
       {{"time_constant_s", 0.005, 100.0, 0.1, 0.5,
         "time constant: the delay in slow ramps; choked: that of small fillings"},
        {"damping_ratio", 0.05, 5.0, 0.4, 1.0, "damping ratio of the second order", 0.7},
        {"vent_time_constant_s", 0.005, 100.0, 0.2, 0.8, "choked: time constant of venting", 0.4},
        {"supply_pa", 1e3, 1e7, 2e5, 2e5, "choked: gauge pressure of the supply", 2e5},
        all_or_one_chamber()},
       lag},
      {"pressure_leak",
       true,
       "the acting pressure is below the commanded one by a share, always (steady) or growing while the "
       "command holds (in_holds)",
       {"steady", "in_holds"},
       {chamber,
        {"share", 0.0, 0.9, 0.01, 0.05, "share of the gauge pressure"},
        {"time_s", 0.05, 1e5, 2.0, 10.0, "in_holds: time constant of the loss", 5.0}},
       leak},
      {"regulator_error",
       false,
       "the regulator's zero is off, and it acts only once the error has exceeded a dead band",
       {},
       {{"offset_pa", -5e4, 5e4, -200.0, 200.0, "acting pressure less commanded pressure", 0.0},
        {"dead_band_pa", 0.0, 5e4, 1000.0, 4000.0, "largest error on which the regulator does not act", 0.0}},
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
       {{"step_pa", 1.0, 5e4, 1000.0, 4000.0, "step of the command at which the valve slips"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         if (scenario.input_path.valve_step_pa > 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.valve_step_pa = choice.values.at("step_pa");
       },
       "",
       "hysteresis"},
      {"flow_limit",
       true,
       "the valves limit how fast pressures rise and fall: each by itself (slew), or all rising ones "
       "together, because one supply feeds them (shared)",
       {"slew", "shared"},
       {{"rise_pa_per_s", 10.0, 1e8, 4e3, 2e4, "largest rate of rising"},
        {"fall_pa_per_s", 0.0, 1e8, 4e3, 2e4, "largest rate of falling; 0: as for rising", 0.0}},
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
       {{"delay_s", 1e-4, 100.0, 0.05, 0.2, "dead time from command to chamber"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         if (scenario.input_path.line_delay_s > 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.line_delay_s = choice.values.at("delay_s");
       },
       "clock_offset"},
      {"supply_sag",
       true,
       "one supply feeds all chambers: it droops when other chambers are open (droop), or it is a tank that "
       "they empty and a pump refills at a constant rate (tank)",
       {"droop", "tank"},
       {{"share", 0.0, 0.9, 0.05, 0.2, "largest share of a chamber's pressure that is lost"},
        {"reference_pa", 1.0, 1e7, 4e4, 8e4,
         "droop: sum of the others' pressures at which half of that is lost; tank: amount taken from it at "
         "which all of that is lost",
         kReferencePa},
        {"refill_pa_per_s",
         0.0,
         1e7,
         5e3,
         2e4,
         "rate at which the tank is refilled, as a sum of pressures",
         1e4,
         false,
         {"tank"}}},
       sag},
      {"supply_ripple",
       false,
       "the compressor runs in cycles, and all pressures rise and fall with its tank",
       {},
       {{"share", 0.0, 0.9, 0.04, 0.15, "share of the pressures, from lowest to highest"},
        {"period_s", 0.02, 1e5, 3.0, 15.0, "period of the cycle"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need_pressures(scenario);
         put(scenario.input_path.supply_ripple,
             SupplyRipple{choice.values.at("share"), choice.values.at("period_s")});
       }},
  };
}

}  // namespace softarm::rig
