// Cases of a campaign, recorded in memory: trials for tests of the diagnosis.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "softarm/identify/shape_error.h"
#include "softarm/rig/campaign.h"
#include "softarm/rig/simulator.h"
#include "softarm/trial/arm_file.h"
#include "softarm/trial/frame_assembler.h"

namespace softarm::diagnose::testing {

struct RecordedCase {
  Arm arm;  ///< what a laboratory would have
  std::vector<identify::Trial> trials;
  std::vector<rig::Scenario> truth;
};

inline identify::Trial record(const Arm& arm, const rig::Scenario& scenario, const std::string& name) {
  constexpr double kBegin_s = 100.0;
  rig::Simulator simulator(scenario);
  FrameAssembler assembler(arm);
  while (const auto sample = simulator.next()) {
    if (sample->payload) assembler.add_payload(kBegin_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kBegin_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kBegin_s + sample->mocap_stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  return {name, assembler.take()};
}

/// What is done in the trials, the campaign's keys.
constexpr const char* kProtocol =
    "attitudes: [hanging, horizontal, hanging], speeds: [0.5, 1, 2], payload_kg: [0, 0.1]";

/// @param effects the campaign's list `effects`, YAML in one line
inline RecordedCase recorded_case(const std::string& effects, std::uint64_t seed, int trials = 6,
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
  RecordedCase out{load_arm_file(root + "arms/online_200mm.yaml"), {}, drawn.trials};
  for (std::size_t i = 0; i < drawn.trials.size(); ++i)
    out.trials.push_back(record(out.arm, drawn.trials[i], "trial_" + std::to_string(i + 1)));
  return out;
}

}  // namespace softarm::diagnose::testing
