// Every fault that the rig's sensors can have, in a trial of its own: `softarm check` names it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "apps/program.h"

namespace softarm {
namespace {

struct Fault {
  const char* name;
  const char* hidden;  ///< as the scenario's list has it
  const char* id;      ///< of the finding
  const char* where;
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.hidden;
}

class CheckRigFault : public ::testing::TestWithParam<Fault> {};

TEST_P(CheckRigFault, IsFound) {
  const Fault& fault = GetParam();
  const TestFolder dir;
  const std::string scenario =
      dir.write("s.yaml", text_of(SOFTARM_SOURCE_DIR "/config/scenarios/trial_10s.yaml") +
                              "\nhidden:\n  - {effect: " + fault.hidden + "}\n");
  const Outcome simulated = softarm_program("simulate " + scenario + " --seconds 24 --out " + dir / "a.bag");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const Outcome checked =
      softarm_program("check --arm online_200mm " + dir / "a.bag" + " --json " + dir / "f.json");
  ASSERT_LT(checked.status, 2) << checked.err;
  const auto recording = nlohmann::json::parse(text_of(dir / "f.json")).at("recordings").at(0);
  bool found = false;
  for (const auto& f : recording.at("findings")) {
    found = found || (f.at("id") == fault.id &&
                      f.at("where").get<std::string>().find(fault.where) != std::string::npos);
  }
  EXPECT_TRUE(found) << fault.id << " is missing:\n" << checked.out;
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, CheckRigFault,
    ::testing::Values(
        Fault{"noise", "correlated_noise, body: 2, position_sd_m: 0.0005, correlation_s: 0.5", "ring_wanders",
              "ring_2"},
        Fault{"bias", "marker_bias, form: given, body: 2, x_m: 0.001, y_m: 0, z_m: 0", "ring_beside",
              "ring_2"},
        Fault{"misplaced", "marker_slip, body: 3, along_m: 0.003", "ring_misplaced", "ring_3"},
        Fault{"slip", "marker_slip, body: 2, sideways_m: 0.002, from_s: 8", "ring_slips", "ring_2"},
        Fault{"bump", "bumped_cameras, x_m: 0.004, turn_z_deg: 0.4, from_s: 6", "base_bumped", "base"},
        Fault{"scale", "volume_scale, share: 0.02", "stretched", ""},
        Fault{"bursts", "dropout_bursts, body: 2, share: 0.06, mean_length_s: 0.3", "lost_body", "ring_2"},
        Fault{"occlusion", "occlusion, body: 4, beyond_deg: 40", "lost_body", "ring_4"},
        Fault{"swap", "swapped_bodies, body: 1, other_body: 3, from_s: 4, for_s: 1.5", "exchanged_bodies",
              "ring_1"},
        Fault{"order", "swapped_bodies, body: 2, other_body: 3", "body_order", ""},
        Fault{"frozen", "frozen_body, body: 2, from_s: 4, for_s: 1.5", "frozen_body", "ring_2"},
        Fault{"flip", "flipped_body, form: about_z, body: 4, from_s: 4, for_s: 1.5", "turned_over", "ring_4"},
        Fault{"backwards", "flipped_body, form: about_x, body: 4", "tangent_backwards", "ring_4"},
        Fault{"sign", "flipped_body, form: sign, body: 4, from_s: 4, for_s: 1, repeat_s: 2",
              "quaternion_sign", "ring_4"},
        Fault{"jumps", "jumps, body: 2, probability: 0.003, size_m: 0.008", "jumping_body", "ring_2"},
        Fault{"clock", "clock_offset, offset_s: 0.15", "stamps_ahead", "mocap"},
        Fault{"lead", "clock_offset, offset_s: -0.15", "clock_offset_or_lag", ""},
        Fault{"drift", "clock_offset, offset_s: 0, drift_ppm: 50", "clock_drift", "mocap"},
        Fault{"latency", "latency, form: mocap, delay_s: 0.03, jitter_s: 0.005", "receipt", "mocap"},
        Fault{"jitter", "stamp_jitter, form: mocap, sd_s: 0.001", "irregular_stamps", "ring_4"},
        Fault{"duplicates", "duplicated_frames, probability: 0.02", "duplicates", "ring_1"},
        Fault{"gap", "gaps, form: mocap, from_s: 5, for_s: 0.6", "gap", "mocap"},
        Fault{"input_gap", "gaps, form: inputs, from_s: 5, for_s: 0.8", "gap", "chamber_1"},
        Fault{"offset", "pressure_offset, number: 1, offset_pa: 1000", "offset_at_rest", "chamber_1"},
        Fault{"sensor_noise", "sensor_noise, form: pressure, number: 1, sd_pa: 500", "noisy_input",
              "chamber_1"},
        Fault{"steps", "sensor_quantisation, form: pressure, number: 2, step_pa: 700", "coarse_steps",
              "chamber_2"},
        Fault{"stuck", "sensor_stuck, form: pressure, number: 1, from_s: 6, for_s: 2", "stuck_input",
              "chamber_1"},
        Fault{"dead", "sensor_dead, form: pressure, number: 1", "missing_topic", "chamber_1"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace softarm
