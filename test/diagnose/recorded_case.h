// Cases of a campaign, recorded in memory: trials for tests of the diagnosis.
#pragma once

#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "rig/campaign.h"
#include "rig/simulator.h"
#include "softarm/arm/arm_file.h"
#include "softarm/identify/identify.h"
#include "trial/frame_assembler.h"
#include "trial/trial_recorder.h"

namespace softarm::diagnose::testing {

struct RecordedCase {
  arm::Arm arm;  ///< what a laboratory would have
  std::vector<trial::Trial> trials;
  std::vector<rig::Scenario> truth;
};

/// Which samples of inputs are logged, and as what; by default all, as they are.
using Logged = std::function<bool(rig::InputSample&)>;

inline trial::Trial record(
    const arm::Arm& arm, const rig::Scenario& scenario, const std::string& name,
    const Logged& logged = [](rig::InputSample&) { return true; }, double begin_s = 100.0) {
  rig::Simulator simulator(scenario);
  trial::FrameAssembler assembler(arm);
  while (const auto sample = simulator.next()) {
    if (sample->payload) assembler.add_payload(begin_s + sample->payload->stamp_s, sample->payload->kg);
    for (rig::InputSample input : sample->inputs) {
      if (logged(input)) assembler.add_input(input.number, begin_s + input.stamp_s, input.value);
    }
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, begin_s + sample->mocap_stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  trial::TrialRecorder recorder(arm, name);
  for (trial::Frame& frame : assembler.take()) recorder.add(std::move(frame));
  recorder.add(assembler.take_samples());
  return recorder.take();
}

/// What is done in the trials, the campaign's keys.
constexpr const char* kProtocol =
    "attitudes: [hanging, horizontal, hanging], speeds: [0.5, 1, 2], payload_kg: [0, 0.1]";

/// The arm and what is to be recorded; no trials yet.
/// @param effects the campaign's list `effects`, YAML in one line
inline RecordedCase drawn_case(const std::string& effects, std::uint64_t seed, int trials = 6,
                               double seconds = 12.0, const std::string& protocol = kProtocol) {
  const std::string root = SOFTARM_SOURCE_DIR "/config/";
  std::ostringstream text;
  text << "format: 1\nname: test\narms: [{scenario: demo, arm: online_200mm}]\neffects: " << effects
       << "\narm_spread: {stiffness: 0.15, gain: 0.1}\ntrials: {count: " << trials << ", seconds: " << seconds
       << ", " << protocol << "}\n"
       << "mocap: {rate_hz: 60, position_sd_m: 0.0004}\n";
  std::ifstream file(root + "scenarios/demo.yaml");
  std::stringstream scenario;
  scenario << file.rdbuf();
  const rig::CampaignSpec spec = rig::parse_campaign(text.str(), "test");
  const rig::CampaignCase drawn =
      rig::draw_case(spec, {rig::parse_scenario(scenario.str(), "demo")}, seed, 1);
  return {arm::load_arm_file(root + "arms/online_200mm.yaml"), {}, drawn.trials};
}

inline RecordedCase recorded_case(const std::string& effects, std::uint64_t seed, int trials = 6,
                                  double seconds = 12.0, const std::string& protocol = kProtocol) {
  RecordedCase out = drawn_case(effects, seed, trials, seconds, protocol);
  for (std::size_t i = 0; i < out.truth.size(); ++i)
    out.trials.push_back(record(out.arm, out.truth[i], "trial_" + std::to_string(i + 1)));
  return out;
}

/// The shipped demo, in which a hand changes the payload every eight seconds.
inline rig::Scenario demo(double seconds) {
  std::ifstream file(SOFTARM_SOURCE_DIR "/config/scenarios/demo.yaml");
  std::stringstream text;
  text << file.rdbuf();
  rig::Scenario scenario = rig::parse_scenario(text.str(), "demo");
  scenario.duration_s = seconds;
  return scenario;
}

/// The same with one payload, and inputs that are a little too fast for the arm.
inline rig::Scenario fast_demo() {
  rig::Scenario scenario = demo(14.0);
  scenario.pressures.random->lowest_hz = 0.1;
  scenario.pressures.random->highest_hz = 0.5;
  scenario.payload.schedule = {rig::Setpoint{0.0, {0.1}, {}}};
  return scenario;
}

}  // namespace softarm::diagnose::testing
