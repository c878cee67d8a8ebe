// Every fault that the rig's sensors can have: `softarm check` names it, and nothing else. Faults that have
// nothing to do with one another share a trial.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program.h"

namespace softarm {
namespace {

struct Fault {
  std::string name;
  std::string hidden;  ///< as the scenario's list has it; "key: a -> b" changes the scenario instead
  std::string severity, id, where;  ///< of the finding
};

struct Trial {
  std::string scenario, arm;
  int seconds = 14;
  std::vector<Fault> faults;
};

const std::vector<Trial>& trials() {
  const auto online = [](std::vector<Fault> faults, int seconds = 14) {
    return Trial{"trial_10s", "online_200mm", seconds, std::move(faults)};
  };
  static const std::vector<Trial> kTrials{
      online({{"CorrelatedNoise", "correlated_noise, body: 2, position_sd_m: 0.0005, correlation_s: 0.5",
               "warning", "ring_wanders", "ring_2"},
              {"Offset", "pressure_offset, number: 1, offset_pa: 1000", "warning", "offset_at_rest",
               "chamber_1"},
              {"StampJitterOfInputs", "stamp_jitter, form: inputs, sd_s: 0.003", "information",
               "irregular_stamps", "chamber_1, chamber_2, chamber_3"}}),
      online({{"MarkerBias", "marker_bias, form: given, body: 2, x_m: 0.001, y_m: 0, z_m: 0", "warning",
               "ring_beside", "ring_2"},
              {"SensorNoise", "sensor_noise, form: pressure, number: 1, sd_pa: 1000", "warning",
               "noisy_input", "chamber_1"},
              {"Quantisation", "sensor_quantisation, form: pressure, number: 2, step_pa: 700", "warning",
               "coarse_steps", "chamber_2"}}),
      online({{"RingFurtherAlong", "marker_slip, body: 3, along_m: 0.003", "warning", "ring_misplaced",
               "ring_3"},
              {"SensorStuck", "sensor_stuck, form: pressure, number: 1, from_s: 6, for_s: 2", "warning",
               "stuck_input", "chamber_1"},
              {"SignOfQuaternion", "flipped_body, form: sign, body: 4, from_s: 4, for_s: 1, repeat_s: 2",
               "information", "quaternion_sign", "ring_4"}}),
      online({{"RingSlips", "marker_slip, body: 2, sideways_m: 0.002, from_s: 7", "warning", "ring_slips",
               "ring_2"},
              {"SensorDead", "sensor_dead, form: pressure, number: 1", "warning", "missing_topic",
               "/pressure/chamber_1"}}),
      online({{"BumpedCameras", "bumped_cameras, x_m: 0.004, turn_z_deg: 0.4, from_s: 6", "serious",
               "base_bumped", "base"},
              {"SensorDies", "sensor_dead, form: pressure, number: 2, from_s: 9", "warning", "gap",
               "chamber_2"}}),
      online({{"MarkersOfTheBaseSlip", "marker_slip, body: 0, sideways_m: 0.003, from_s: 7", "warning",
               "base_bumped", "base"},
              {"GapOfInputs", "gaps, form: inputs, from_s: 5, for_s: 0.8", "warning", "gap",
               "chamber_1, chamber_2, chamber_3"}}),
      online({{"VolumeScale", "camera_scale, share: 0.02", "warning", "stretched", ""},
              {"FrozenBody", "frozen_body, body: 2, from_s: 4, for_s: 1", "warning", "frozen_body", "ring_2"},
              {"TurnedOver", "flipped_body, form: about_z, body: 4, from_s: 4, for_s: 1.5", "serious",
               "turned_over", "ring_4"}}),
      online({{"DropoutBursts", "dropout_bursts, body: 2, share: 0.06, mean_length_s: 0.3", "warning",
               "lost_body", "ring_2"},
              {"Occlusion", "occlusion, body: 4, beyond_deg: 40", "serious", "lost_body", "ring_4"},
              {"Latency", "latency, form: mocap, delay_s: 0.03, jitter_s: 0.005", "information", "receipt",
               "mocap"}}),
      online({{"ExchangedForAWhile", "swapped_bodies, body: 1, other_body: 3, from_s: 4, for_s: 1.5",
               "serious", "exchanged_bodies", "ring_1, ring_3"},
              {"CorrelatedTurns", "correlated_noise, body: 4, orientation_sd_rad: 0.03, correlation_s: 0.5",
               "warning", "tangent_off", "ring_4"},
              {"LatencyOfInputs", "latency, form: inputs, delay_s: 0.15, jitter_s: 0.01", "warning",
               "late_receipt", "chamber_1, chamber_2, chamber_3"}}),
      online({{"ExchangedThroughout", "swapped_bodies, body: 2, other_body: 3", "serious", "body_order", ""},
              {"Duplicates", "duplicated_frames, probability: 0.02", "warning", "duplicates",
               "base, ring_1, ring_2, ring_3, ring_4"}}),
      online({{"AllFrozen", "frozen_body, body: -1, from_s: 4, for_s: 1", "warning", "frozen_body",
               "base, ring_1, ring_2, ring_3, ring_4"},
              {"QuaternionSpikes", "jumps, body: 4, probability: 0.004, size_m: 0, turn_deg: 30", "warning",
               "quaternion_spikes", "ring_4"}}),
      online({{"TangentBackwards", "flipped_body, form: about_x, body: 4", "serious", "tangent_backwards",
               "ring_4"},
              {"GapOfMocap", "gaps, form: mocap, from_s: 5, for_s: 0.6", "warning", "gap", "mocap"},
              {"Jumps", "jumps, body: 2, probability: 0.004, size_m: 0.008", "warning", "jumping_body",
               "ring_2"}}),
      online({{"ClockDrift", "clock_offset, offset_s: 0, drift_ppm: 80", "warning", "clock_drift", "mocap"},
              {"WobblingRing", "wobbling_ring, body: 4, tilt_deg_per_g: 5", "warning", "tangent_off",
               "ring_4"}}),
      online(
          {{"ClockBehind", "clock_offset, offset_s: -0.15", "warning", "clock_offset_or_lag", ""},
           {"LooseRing", "wobbling_ring, body: 2, shift_m_per_g: 0.004", "warning", "ring_wanders", "ring_2"},
           {"BaseTurnedOver", "flipped_body, form: about_z, body: 0, from_s: 4, for_s: 1.5", "serious",
            "turned_over", "base"}},
          24),
      online({{"ClockAhead", "clock_offset, offset_s: 0.15", "warning", "stamps_ahead", "mocap"},
              {"MarkersTurned", "marker_bias, form: drawn, body: 4, orientation_sd_rad: 0.05", "warning",
               "tangent_off", "ring_4"},
              {"BaseJumps", "jumps, body: 0, probability: 0.003, size_m: 0.008", "warning", "jumping_body",
               "base"}},
             24),
      online({{"StampJitter", "stamp_jitter, form: mocap, sd_s: 0.001", "warning", "irregular_stamps",
               "base, ring_1, ring_2, ring_3, ring_4"}}),
      online({{"WhiteNoise", "position_sd_m: 0.0005 -> 0.002", "warning", "noise_understated", "ring_"},
              {"Dropouts", "dropout_probability: 0.01 -> 0.05", "warning", "lost_body", "ring_"}}),
      online({{"CorrelatedNoiseOfAll", "correlated_noise, position_sd_m: 0.0005, correlation_s: 0.5",
               "warning", "correlated_noise", "base"}}),
      online({{"SensorDeadAmongOthers", "sensor_stuck, form: pressure, number: 1, from_s: 0, for_s: 60",
               "warning", "dead_input", "chamber_1"}},
             40),
      {"two_segment",
       "two_segment",
       10,
       {{"TensionOffset", "tension_offset, number: 1, offset_n: 0.4", "warning", "offset_at_rest",
         "tendon_1"},
        {"TensionNoise", "sensor_noise, form: tension, number: 1, sd_n: 0.1", "warning", "noisy_input",
         "tendon_1"},
        {"TensionSteps", "sensor_quantisation, form: tension, number: 2, step_n: 0.1", "warning",
         "coarse_steps", "tendon_2"}}},
      {"cable_235mm",
       "cable_235mm",
       10,
       {{"AngleOffset", "angle_offset, number: 1, offset_rad: 0.1", "warning", "offset_at_rest", "servo_1"},
        {"AngleNoise", "sensor_noise, form: angle, number: 1, sd_rad: 0.05", "warning", "noisy_input",
         "servo_1"}}},
      {"semi_physical_200mm",
       "semi_physical_200mm",
       20,
       {{"VacuumOffset", "pressure_offset, form: vacuum, offset_pa: 2000", "warning", "offset_at_rest",
         "vacuum"},
        {"VacuumSteps", "sensor_quantisation, form: vacuum, step_pa: 1000", "warning", "coarse_steps",
         "vacuum"}}}};
  return kTrials;
}

std::string scenario_of(const Trial& trial) {
  std::string text = text_of(std::string(SOFTARM_SOURCE_DIR "/config/scenarios/") + trial.scenario + ".yaml");
  std::string hidden;
  for (const Fault& fault : trial.faults) {
    const std::size_t arrow = fault.hidden.find(" -> ");
    if (arrow == std::string::npos) {
      hidden += "  - {effect: " + fault.hidden + "}\n";
      continue;
    }
    const std::string was = fault.hidden.substr(0, arrow);
    const std::size_t at = text.find(was);
    EXPECT_NE(at, std::string::npos) << was;
    if (at == std::string::npos) continue;
    text.replace(at, was.size(), was.substr(0, was.find(':') + 2) + fault.hidden.substr(arrow + 4));
  }
  return hidden.empty() ? text : text + "\nhidden:\n" + hidden;
}

/// The findings of a trial, recorded when it is first asked for.
const nlohmann::json& findings_of(std::size_t number) {
  static std::map<std::size_t, nlohmann::json> all;
  const auto known = all.find(number);
  if (known != all.end()) return known->second;
  nlohmann::json& findings = all[number] = nlohmann::json::array();
  const Trial& trial = trials()[number];
  const TestFolder dir;
  const Outcome simulated =
      softarm_program("simulate " + dir.write("s.yaml", scenario_of(trial)) + " --seconds " +
                      std::to_string(trial.seconds) + " --out " + dir / "a.bag");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const Outcome checked =
      softarm_program("check --arm " + trial.arm + " " + dir / "a.bag" + " --json " + dir / "f.json");
  EXPECT_LT(checked.status, 2) << checked.err;
  const auto report = nlohmann::json::parse(text_of(dir / "f.json"), nullptr, false);
  if (!report.is_discarded()) findings = report.at("recordings").at(0).at("findings");
  return findings;
}

bool is_of(const nlohmann::json& finding, const Fault& fault) {
  const std::string where = finding.at("where");
  // "ring_": of every one of them.
  const bool there = fault.where == "ring_" ? where.find("ring_") == 0 : where == fault.where;
  return there && finding.at("id") == fault.id && finding.at("severity") == fault.severity;
}

struct Case {
  std::size_t trial = 0;
  Fault fault;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.fault.hidden;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (std::size_t t = 0; t < trials().size(); ++t) {
    for (const Fault& fault : trials()[t].faults) all.push_back({t, fault});
  }
  return all;
}

class CheckRigFault : public ::testing::TestWithParam<Case> {};

TEST_P(CheckRigFault, IsFound) {
  const auto& findings = findings_of(GetParam().trial);
  const Fault& fault = GetParam().fault;
  const auto found = std::count_if(findings.begin(), findings.end(),
                                   [&](const nlohmann::json& f) { return is_of(f, fault); });
  if (fault.where == "ring_") {
    EXPECT_GE(found, 1) << fault.id << " is missing:\n" << findings.dump(1);
  } else {
    EXPECT_EQ(found, 1) << fault.id << ", " << fault.where << ":\n" << findings.dump(1);
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, CheckRigFault, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.fault.name; });

TEST(CheckRigFaults, NothingElseIsFound) {
  for (std::size_t t = 0; t < trials().size(); ++t) {
    const auto& faults = trials()[t].faults;
    for (const nlohmann::json& f : findings_of(t)) {
      if (f.at("severity") == "information") continue;
      const bool caused =
          std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) { return is_of(f, fault); });
      // One row of Dropouts concerns the base too.
      const bool base_lost = f.at("id") == "lost_body" && f.at("where") == "base" &&
                             std::any_of(faults.begin(), faults.end(),
                                         [](const Fault& fault) { return fault.name == "Dropouts"; });
      EXPECT_TRUE(caused || base_lost) << "beside " << faults.front().hidden << ": " << f.dump(1);
    }
  }
}

}  // namespace
}  // namespace softarm
