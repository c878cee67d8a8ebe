// The stamps of bodies: lone outliers in time, steps back and forth, the leftovers of the time before a jump.
#include <algorithm>
#include <cmath>
#include <utility>

#include "frame_assembler.h"

namespace softarm::trial {
namespace {

constexpr double kSlowestStream_s = 60.0;  // between two messages that agree: slower ones are no stream
constexpr double kPaces = 2.5;             // one instant may be lost
// A clock that goes back takes all bodies with it. Where they go on for so long where time was, the stamp of
// the one that went back was damaged. Should what is still on its way from before a jump take longer, the
// next two messages of the new time agree.
constexpr double kGoesOn_s = 1.0;

}  // namespace

/// By more than a jump, and than the next instant of a stream that is slower than that.
bool FrameAssembler::is_ahead(double stamp_s) const {
  const double pace_s = kPaces * std::min(step_s_, kSlowestStream_s);
  return newest_s_ && stamp_s > *newest_s_ + std::max(params_.time_jump_s, pace_s);
}

/// A sample of the very next message: one of where time was before would have dropped the candidate. Bodies
/// of one message say the same thing, damaged or not.
bool FrameAssembler::confirms(const std::optional<Candidate>& candidate, double stamp_s) const {
  return candidate && candidate->message != message_ && stamp_s > candidate->stamp_s - params_.time_jump_s &&
         stamp_s < candidate->stamp_s + std::max(params_.time_jump_s, kSlowestStream_s);
}

/// One sample may be damaged; two that agree are a new time, whichever bodies they are of.
bool FrameAssembler::confirms_step_back(double stamp_s) const {
  return std::any_of(streams_.begin(), streams_.end(), [&](const Stream& stream) {
    const std::optional<Candidate>& candidate = stream.back_candidate;
    return confirms(candidate, stamp_s) && *newest_s_ <= candidate->newest_s + kGoesOn_s;
  });
}

bool FrameAssembler::check_time(Stream& stream, double stamp_s) {
  if (!(stamp_s > 0.0) || !std::isfinite(stamp_s)) {
    reject("bad_stamp", stream.name);
    return false;
  }
  const double jump_s = params_.time_jump_s;

  // Back, against the stream's own past: a body whose clock merely lags never goes back.
  if (stream.newest_s && stamp_s < *stream.newest_s - jump_s) {
    if (confirms_step_back(stamp_s)) {
      reset_time(stamp_s);
      return true;
    }
    stream.back_candidate = Candidate{stamp_s, message_, *newest_s_};
    reject("time_jump", stream.name);
    return false;
  }
  stream.back_candidate.reset();

  if (!is_ahead(stamp_s)) {
    ahead_candidate_.reset();  // time goes on where it was: the candidate's stamp was damaged
    return true;
  }
  // Samples of the time before a jump that were still on their way.
  if (newest_before_jump_s_ && stream.before_jump_s && !stream.newest_s && stamp_s >= *stream.before_jump_s &&
      stamp_s <= *newest_before_jump_s_ + 0.25) {
    reject("time_jump", stream.name);
    return false;
  }
  // Forward: after a pause the first message waits for a second one that agrees.
  if (confirms(ahead_candidate_, stamp_s)) {
    ahead_candidate_.reset();
    return true;
  }
  ahead_candidate_ = Candidate{stamp_s, message_, *newest_s_};
  reject("time_gap", stream.name);
  return false;
}

void FrameAssembler::reset_time(double stamp_s) {
  std::vector<Frame> frames = take();  // still to be fetched, they are good
  if (!pending_.empty()) dropped_frames_["time_jump"] += pending_.size();
  pending_.clear();
  std::vector<std::optional<double>> last;
  for (const Stream& stream : streams_) last.push_back(stream.newest_s);
  const std::optional<double> newest = newest_s_;
  std::vector<std::deque<Value>> inputs = std::move(inputs_);
  inputs_.assign(inputs.size(), {});
  const std::vector<Input> input_streams = input_streams_;
  std::deque<Value> payload = payload_;

  reset();

  before_jump_ = std::move(frames);
  for (std::size_t i = 0; i < streams_.size(); ++i) streams_[i].before_jump_s = last[i];
  newest_before_jump_s_ = newest;
  // Values that already belong to the new time stay: their topics may be ahead of the bodies.
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (const Value& value : inputs[i]) {
      if (std::abs(value.stamp.s - stamp_s) < 0.5 * params_.time_jump_s) inputs_[i].push_back(value);
    }
    if (!inputs_[i].empty()) input_streams_[i] = input_streams[i];
  }
  if (!payload.empty() && std::abs(payload.back().stamp.s - stamp_s) < params_.time_jump_s) {
    payload_ = {payload.back()};
  }
  time_jump_ = true;
  ++time_jumps_;
}

}  // namespace softarm::trial
