#include "sensors_clocks.h"

#include <algorithm>
#include <cmath>

namespace softarm::rig {
namespace {

constexpr double kJitterReach = 3.0;  ///< standard deviations
constexpr double kTick_s = 1e-6;      ///< that stamps of one sender differ at least

}  // namespace

MessageClock::MessageClock(const Scenario& scenario, MessageStream stream, std::size_t sender)
    : session_s_(scenario.session_s) {
  const SensorSpec& spec = scenario.sensors;
  if (stream == MessageStream::kMocap) clock_ = spec.mocap_clock;
  const std::size_t part = 2 * sender + (stream == MessageStream::kMocap ? 0 : 1);
  for (std::size_t i = 0; i < spec.latencies.size(); ++i)
    if (spec.latencies[i].stream == stream)
      lines_.push_back({&spec.latencies[i], stream_of(scenario.seed, SensorPurpose::kLatency, i, part)});
  for (std::size_t i = 0; i < spec.stamp_jitters.size(); ++i)
    if (spec.stamp_jitters[i].stream == stream)
      jitters_.push_back(
          {&spec.stamp_jitters[i], stream_of(scenario.seed, SensorPurpose::kStampJitter, i, part)});
}

Timing MessageClock::time(double sent_s) {
  double stamped_s = sent_s;
  for (Jitter& jitter : jitters_) {
    const double wander = std::clamp(jitter.random.normal(), -kJitterReach, kJitterReach);
    stamped_s += jitter.spec->sd_s * wander;
  }
  stamped_s = std::max(stamped_s, last_stamp_s_ + kTick_s);
  last_stamp_s_ = stamped_s;

  double receipt_s = sent_s;
  for (Line& line : lines_)
    receipt_s += line.spec->delay_s - line.spec->jitter_s * std::log(1.0 - line.random.uniform());
  // Nothing is received before it is stamped, or before what was sent earlier.
  receipt_s = std::max({receipt_s, stamped_s, last_receipt_s_});
  last_receipt_s_ = receipt_s;

  const double offset_s =
      clock_ ? clock_->offset_s + clock_->drift * sent_s + clock_->session_drift * (session_s_ + sent_s)
             : 0.0;
  return {stamped_s + offset_s, receipt_s};
}

}  // namespace softarm::rig
