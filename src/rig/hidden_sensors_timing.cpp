// Effects of clocks and transport.
#include <algorithm>

#include "hidden_sensors.h"

namespace softarm::rig {
namespace {

void add_clock_offset(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.mocap_clock.offset_s += choice.values.at("offset_s");
  scenario.sensors.mocap_clock.drift += 1e-6 * choice.values.at("drift_ppm");
}

void add_clock_drift(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.mocap_clock.session_drift += 1e-6 * choice.values.at("drift_ppm");
}

void add_input_clock(const HiddenChoice& choice, Scenario& scenario) {
  const InputKind kind = kind_of(choice);
  scenario.sensors.input_clocks.push_back(
      {kind, number_of(choice, kind, scenario), choice.values.at("offset_s")});
}

void add_latency(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.latencies.push_back(
      {stream_of(choice), choice.values.at("delay_s"), choice.values.at("jitter_s")});
}

void add_stamp_jitter(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.stamp_jitters.push_back({stream_of(choice), choice.values.at("sd_s")});
}

void add_duplicates(const HiddenChoice& choice, Scenario& scenario) {
  double& probability = scenario.sensors.duplicate_probability;
  probability = std::max(probability, choice.values.at("probability"));
}

void add_gap(const HiddenChoice& choice, Scenario& scenario) {
  scenario.sensors.gaps.push_back({stream_of(choice), times_of(choice)});
}

}  // namespace

std::vector<HiddenEffect> timing_effects() {
  return {
      {"clock_offset",
       true,
       "the clock that stamps the mocap frames is ahead of the clock of the inputs and of receipt",
       {},
       {{"offset_s", -1e4, 1e4, -0.2, 0.2, "time by which it is ahead at the start"},
        {"drift_ppm", -1e5, 1e5, -50.0, 50.0, "microseconds per second by which it gets further ahead", 0.0}},
       add_clock_offset},
      {"clock_drift",
       true,
       "the clock that stamps the mocap frames runs at another rate than the clock of the inputs and of "
       "receipt",
       {},
       {{"drift_ppm", -1e5, 1e5, -200.0, 200.0,
         "microseconds per second by which it gets further ahead, over the whole session"}},
       add_clock_drift},
      {"input_clock",
       false,
       "the clock that stamps an input is ahead of the clock of receipt",
       input_forms(),
       {number_parameter(), {"offset_s", -1e4, 1e4, -0.2, 0.2, "time by which it is ahead"}},
       add_input_clock,
       "clock_offset"},
      {"latency",
       false,
       "messages are received later than they are stamped; messages without a header then count at that "
       "later time",
       stream_forms(),
       {{"delay_s", 0.0, 10.0, 0.003, 0.05, "delay of all messages"},
        {"jitter_s", 0.0, 10.0, 0.0, 0.01, "mean of an additional random (exponential) delay", 0.0}},
       add_latency},
      {"stamp_jitter",
       false,
       "stamps vary about the true times, by up to three standard deviations, and never go back",
       stream_forms(),
       {{"sd_s", 0.0, 1.0, 2e-4, 3e-3, "standard deviation"}},
       add_stamp_jitter},
      {"duplicated_frames",
       false,
       "a mocap frame is sent twice, with the same stamp",
       {},
       {{"probability", 0.0, 1.0, 0.001, 0.05, "probability for each frame"}},
       add_duplicates},
      {"gaps", false, "nothing of a stream is sent", stream_forms(), with_times({}), add_gap},
  };
}

}  // namespace softarm::rig
