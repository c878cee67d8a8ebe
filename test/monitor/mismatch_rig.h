// The virtual rig's stream through estimator and monitor, for tests of the monitor.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "rig/simulator.h"
#include "softarm/arm/arm_file.h"
#include "softarm/estimate/estimator.h"
#include "softarm/monitor/mismatch_monitor.h"
#include "trial/frame_assembler.h"

namespace softarm::diagnose::testing {

constexpr double kEpoch_s = 100.0;

inline std::string read_config(const std::string& path) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/" + path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline arm::Arm shipped_arm(const std::string& name) {
  return arm::parse_arm(read_config("arms/" + name + ".yaml"), name);
}

/// The demo's arm in random motion.
/// @param hidden an entry of the scenario's list, or empty
inline rig::Scenario demo_scenario(const std::string& hidden, double duration_s, double rate_hz = 120.0,
                                   std::uint64_t seed = 1) {
  std::string text = read_config("scenarios/demo.yaml");
  if (!hidden.empty()) text += "\nhidden:\n  - " + hidden + "\n";
  rig::Scenario scenario = rig::parse_scenario(text, "demo");
  scenario.duration_s = duration_s;
  scenario.mocap.rate_hz = rate_hz;
  scenario.seed = seed;
  return scenario;
}

struct Alarm {
  double at_s = 0.0;               ///< of the frame at which it came, from the trial's start
  monitor::Mismatch first, named;  ///< at that frame, and once it had been looked at for a second
};

struct Watched {
  std::vector<Alarm> alarms;
  std::size_t frames = 0;
  double largest_quiet_sd = 0.0;  ///< change where there was no alarm and none was held off
  double largest_score_sd = 0.0;
  monitor::Mismatch last;
};

/// @param change may alter or drop (false) a frame before anyone sees it; t from the trial's start
inline Watched watch(const arm::Arm& arm, const rig::Scenario& scenario,
                     const monitor::MismatchMonitorParams& params = {},
                     const std::function<bool(double t_s, trial::Frame&)>& change = {}) {
  rig::Simulator simulator(scenario);
  trial::FrameAssembler assembler(arm);
  estimate::Estimator estimator(arm);
  monitor::MismatchMonitor monitor(arm, params);
  Watched watched;
  bool alarmed = false;
  const auto take = [&] {
    for (trial::Frame frame : assembler.take()) {
      if (change && !change(frame.stamp_s() - kEpoch_s, frame)) continue;
      const monitor::Mismatch& mismatch = monitor.add(frame, estimator.estimate(frame));
      ++watched.frames;
      const double t_s = frame.stamp_s() - kEpoch_s;
      if (mismatch.alarm) {
        if (!alarmed) watched.alarms.push_back({t_s, mismatch, mismatch});
        if (t_s < watched.alarms.back().at_s + 1.0) watched.alarms.back().named = mismatch;
      } else if (mismatch.valid && mismatch.threshold_sd > 0.0) {
        watched.largest_quiet_sd = std::max(watched.largest_quiet_sd, mismatch.change_sd);
      }
      alarmed = mismatch.alarm;
      if (mismatch.valid) watched.largest_score_sd = std::max(watched.largest_score_sd, mismatch.score_sd);
      watched.last = mismatch;
    }
  };
  while (const auto sample = simulator.next()) {
    if (sample->payload) assembler.add_payload(kEpoch_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kEpoch_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kEpoch_s + sample->mocap_stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
    take();
  }
  assembler.flush();
  take();
  return watched;
}

/// When a ring of the disturbed arm is first this far from where it would be, after 5 s.
inline std::optional<double> displaced_at_s(const rig::Scenario& disturbed, const rig::Scenario& clean,
                                            double by_m) {
  rig::Simulator a(disturbed), b(clean);
  while (const auto x = a.next()) {
    const auto y = b.next();
    if (!y) break;
    for (std::size_t i = 0; i < x->truth.rings_base.size(); ++i) {
      if (x->stamp_s > 5.0 && (x->truth.rings_base[i].p - y->truth.rings_base[i].p).norm() > by_m)
        return x->stamp_s;
    }
  }
  return std::nullopt;
}

}  // namespace softarm::diagnose::testing
