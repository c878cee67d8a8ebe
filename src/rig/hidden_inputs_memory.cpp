// Effects of memory and age between a command and what acts in the arm, and of the scale.
#include <algorithm>

#include "hidden_inputs_parts.h"
#include "scenario_parts.h"

namespace softarm::rig {
namespace {

void hysteresis(const HiddenChoice& choice, Scenario& scenario) {
  InputPathSpec& spec = scenario.input_path;
  if (choice.form == "material") {
    put(scenario.body.hysteresis,
        MaterialHysteresis{0.5 * choice.values.at("loop_per_m"), choice.values.at("yield_per_m")});
    return;
  }
  if (spec.pressure_play_pa != 0.0 || spec.tension_play_n != 0.0 || spec.angle_play_rad != 0.0)
    throw std::invalid_argument("given twice");
  spec.hysteresis =
      choice.form == "bouc_wen" ? InputPathSpec::Hysteresis::kBoucWen : InputPathSpec::Hysteresis::kPlay;
  spec.pressure_play_chamber = chamber_index(choice, scenario);
  spec.pressure_play_pa = choice.values.at("loop_pa");
  spec.tension_play_n = choice.values.at("loop_n");
  spec.angle_play_rad = choice.values.at("loop_rad");
}

void jamming_settling(const HiddenChoice& choice, Scenario& scenario) {
  need_jamming(scenario);
  put(scenario.input_path.jamming_settling,
      JammingSettling{choice.values.at("rate_pa_per_s"), choice.values.at("compaction_s"),
                      choice.values.at("loop_pa")});
}

/// Into the walls of all segments, which have a spectrum of times, and what was before the recording.
void axial_memory(const HiddenChoice& choice, Scenario& scenario) {
  const auto grows = [](const SegmentSpec& segment) {
    for (const ChamberSpec& chamber : segment.chambers)
      if (chamber.near_elongation_m_per_pa + chamber.far_elongation_m_per_pa != 0.0) return true;
    return segment.axial_stiffness_n && (segment.central_chamber || !segment.tendons.empty());
  };
  const std::vector<SegmentSpec>& all = scenario.arm.segments;
  need(std::any_of(all.begin(), all.end(), grows), "an arm whose length depends on its inputs");
  const double share = choice.values.at("share"), time_s = choice.values.at("time_s");
  for (SegmentSpec& segment : scenario.arm.segments) {
    if (!segment.creep.length.empty()) throw std::invalid_argument("the arm's length creeps already");
    if (choice.form == "spectrum")
      segment.creep.length = {{time_s, share, 0.4}};
    else
      segment.creep.length = {{time_s / 3.0, 0.5 * share, 0.0}, {3.0 * time_s, 0.5 * share, 0.0}};
    segment.creep.before_length_m = choice.values.at("before_share") * segment.length_m;
  }
}

void drift(const HiddenChoice& choice, Scenario& scenario) {
  const Drift::Form form = choice.form == "logarithmic"  ? Drift::Form::kLogarithmic
                           : choice.form == "saturating" ? Drift::Form::kSaturating
                                                         : Drift::Form::kLinear;
  put(scenario.input_path.drift, Drift{choice.values.at("gain_share"), choice.values.at("stiffness_share"),
                                       choice.values.at("over_s"), form});
}

}  // namespace

std::vector<HiddenEffect> memory_effects() {
  return {
      {"hysteresis",
       true,
       "rate-independent loop between what is commanded and what acts in the arm (play, bouc_wen), of all "
       "inputs or of one pressure, whose valve sticks; or between curvature and moment of every section "
       "(material, by Bouc and Wen); the width of the loop is that in a much wider cycle",
       {"play", "bouc_wen", "material"},
       {{"loop_pa", 0.0, 1e6, 500.0, 5000.0, "width of the loop in the pressures", 0.0},
        {"loop_n", 0.0, 1e4, 0.05, 0.5, "width of the loop in the tensions", 0.0},
        {"loop_rad", 0.0, 1e3, 0.01, 0.1, "width of the loop in the servos' angles", 0.0},
        {"loop_per_m", 0.0, 100.0, 0.1, 0.6, "material: width of the loop in the curvature", 0.3},
        {"yield_per_m", 1e-2, 100.0, 0.3, 2.0, "material: change of curvature after which the loop turns",
         1.0},
        all_or_one_chamber({"play", "bouc_wen"})},
       hysteresis},
      {"axial_memory",
       true,
       "part of the length that inputs cause comes late, with a broad spectrum of times (spectrum) or with "
       "two, a third of time_s and three times time_s (two_times)",
       {"spectrum", "two_times"},
       {{"share", 0.0, 0.95, 0.2, 0.6, "share of the length that inputs cause which comes late"},
        {"time_s", 1e-3, 1e6, 3.0, 15.0, "time constant"},
        {"before_share", -0.2, 0.2, 0.0, 0.0,
         "share of the arm's length by which the late part is ahead at the start", 0.0}},
       axial_memory},
      {"tendon_friction",
       true,
       "tendons rub where the arm bends: the tension falls along them, and comes back late",
       {},
       {{"coefficient", 0.0, 5.0, 0.05, 0.3, "coefficient of friction in the capstan equation"},
        {"routing_rad", 0.0, 100.0, 0.0, 1.5, "angle around which the tendons are led before the base", 0.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need(scenario.arm.tendons > 0, "an arm with tendons");
         put(scenario.input_path.tendon_friction,
             TendonFriction{choice.values.at("coefficient"), choice.values.at("routing_rad")});
       }},
      {"jamming_settling",
       false,
       "granules pack depending on how they were evacuated: fast evacuation leaves them loose, they then "
       "settle slowly, and release comes late",
       {},
       {{"rate_pa_per_s", 10.0, 1e9, 3e4, 2e5, "rate of evacuation at which half is reached at once"},
        {"compaction_s", 0.05, 1e5, 3.0, 20.0, "time constant of settling"},
        {"loop_pa", 0.0, 1e5, 0.0, 6000.0, "width of the loop in vacuum", 0.0}},
       jamming_settling},
      {"drift",
       true,
       "gain or stiffness changes over the session: at one rate (linear), or at a rate that falls "
       "exponentially (saturating) or as one over the time (logarithmic)",
       {"linear", "saturating", "logarithmic"},
       {{"gain_share", -0.9, 10.0, -0.06, -0.02, "share by which all moments grow", 0.0},
        {"stiffness_share", -0.9, 10.0, -0.06, -0.02, "share by which all stiffnesses grow", 0.0},
        {"over_s", 0.1, 1e7, 300.0, 1800.0,
         "time after which this is reached; saturating: after which 63 % is reached"}},
       drift},
      {"temperature",
       true,
       "the room's temperature swings over the session, as a sine or with a thermostat's heater: stiffness "
       "and "
       "length follow",
       {"sine", "thermostat"},
       {{"amplitude_k", 0.0, 100.0, 2.0, 6.0, "amplitude of the swing"},
        {"period_s", 1.0, 1e6, 600.0, 2400.0, "period of the swing"},
        {"phase_deg", -360.0, 360.0, 0.0, 360.0,
         "phase at the start of the session; 0: mean and rising, or the heater goes on", 0.0},
        {"stiffness_share_per_k", -0.2, 0.2, -0.015, -0.005, "share by which all stiffnesses change per K",
         -0.01},
        {"expansion_share_per_k", -0.01, 0.01, 2e-4, 4e-4, "share by which the length changes per K", 3e-4}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         put(scenario.input_path.temperature,
             TemperatureSwing{choice.values.at("amplitude_k"), choice.values.at("period_s"),
                              kRadPerDeg * choice.values.at("phase_deg"),
                              choice.values.at("stiffness_share_per_k"),
                              choice.values.at("expansion_share_per_k"), choice.form == "thermostat"});
       }},
      {"payload_scale",
       true,
       "the published payload is the true one times 1 + share",
       {},
       {{"share", -0.9, 10.0, 0.03, 0.1, "share of the payload"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         need(scenario.payload.publish && !scenario.payload.schedule.empty(), "a payload that is published");
         if (scenario.input_path.payload_scale_share != 0.0) throw std::invalid_argument("given twice");
         scenario.input_path.payload_scale_share = choice.values.at("share");
       }},
  };
}

}  // namespace softarm::rig
