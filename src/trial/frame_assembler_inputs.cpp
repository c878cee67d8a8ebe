// Inputs and payload: what held at the stamp of a frame.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "frame_assembler.h"

namespace softarm::trial {
namespace {

constexpr std::size_t kLongestHistory = 20000;
constexpr double kSame_s = 1e-6;  // stamps of one instant: a double of seconds holds a quarter of this

}  // namespace

void FrameAssembler::add_input(int input, Stamp stamp, double value) {
  const arm::ScalarInput& source = scalars_.at(static_cast<std::size_t>(input));
  std::deque<Value>& history = inputs_.at(static_cast<std::size_t>(input));
  Input& stream = input_streams_.at(static_cast<std::size_t>(input));
  ++samples_;
  if (tap_.input) tap_.input(input, stamp.s, value);
  if (!std::isfinite(value)) return reject("input_nan", source.name);
  if (!(stamp.s > 0.0) || !std::isfinite(stamp.s)) return reject("bad_stamp", source.name);
  stamp = stamp.earlier(source.latency_s);
  const double stamp_s = stamp.s;
  if (stream.rhythm.newest_s() && stamp_s < *stream.rhythm.newest_s() - params_.time_jump_s)
    stream.rhythm.reset();
  stream.rhythm.add(stamp_s);
  if (newest_s_ && stream.last && *stream.last != value) {
    // No later than the bodies that came before it: its stamp may be damaged.
    const double changed_s = std::min(stamp_s, *newest_s_);
    input_changed_s_ = std::max(input_changed_s_.value_or(changed_s), changed_s);
  }
  stream.last = value;
  // One that always comes too late would hold up every frame, and in vain.
  if (!newest_s_ || stamp_s > *newest_s_ - 0.5 * params_.input_wait_s) stream.expected = true;
  value -= source.zero_si;
  if (source.kind == arm::InputKind::kTension || source.kind == arm::InputKind::kAngle) {
    insert(history, {stamp, value, false});
  } else {
    const double gauge_pa =
        source.reference == arm::PressureReference::kAbsolute ? value - ambient_pa_ : value;
    insert(history, {stamp, source.kind == arm::InputKind::kVacuum ? -gauge_pa : gauge_pa, false});
  }
  added();
}

void FrameAssembler::add_payload(Stamp stamp, std::optional<double> kg) {
  ++samples_;
  if (tap_.payload) tap_.payload(stamp.s, kg);
  if (kg && !std::isfinite(*kg)) return reject("payload_nan", "payload");
  if (kg && !(*kg >= payload_range_kg_.low && *kg <= payload_range_kg_.high)) {
    return reject("payload_out_of_range", "payload");
  }
  if (!std::isfinite(stamp.s)) return reject("bad_stamp", "payload");
  insert(payload_, {stamp.s > 0.0 ? stamp : Stamp(-std::numeric_limits<double>::infinity()), kg, false});
}

void FrameAssembler::insert(std::deque<Value>& history, const Value& value) {
  if (!history.empty() && value.stamp.s < history.back().stamp.s - params_.time_jump_s) history.clear();
  // Nearly always the last. While no body comes the history is long: it is not searched from its begin.
  auto after = history.end();
  while (after != history.begin() && std::prev(after)->stamp.s > value.stamp.s) --after;
  history.insert(after, value);
  if (history.size() > kLongestHistory) history.pop_front();
}

const FrameAssembler::Value* FrameAssembler::newest_at(std::deque<Value>& history, double stamp_s) {
  // Frames come in order of their stamps: what a newer value replaced is not asked for again.
  while (history.size() > 1 && history[1].stamp.s <= stamp_s + kSame_s) history.pop_front();
  return !history.empty() && history.front().stamp.s <= stamp_s + kSame_s ? &history.front() : nullptr;
}

std::vector<InputSample> FrameAssembler::samples_until(double stamp_s) {
  std::vector<InputSample> samples;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    for (Value& sample : inputs_[i]) {
      if (sample.stamp.s > stamp_s + kSame_s) break;
      if (std::exchange(sample.given, true)) continue;
      samples.push_back({static_cast<int>(i), sample.stamp.ns, *sample.value});
    }
  }
  return samples;
}

std::vector<InputSample> FrameAssembler::take_samples() {
  return samples_until(std::numeric_limits<double>::max());
}

arm::InputValues FrameAssembler::inputs_at(double stamp_s) {
  // A sample of the very same stamp may come before or after the bodies: inputs_complete() has waited for it.
  arm::InputValues values;
  for (auto& history : inputs_) {
    const Value* held = newest_at(history, stamp_s);
    const bool fresh = held && stamp_s - held->stamp.s <= input_max_age_s_;
    values.push_back(fresh ? held->value : std::nullopt);
  }
  return values;
}

std::optional<double> FrameAssembler::payload_at(double stamp_s) {
  const Value* held = newest_at(payload_, stamp_s);
  return held ? held->value : std::nullopt;
}

std::optional<double> FrameAssembler::input_accepted_s(int input) const {
  const std::deque<Value>& history = inputs_.at(static_cast<std::size_t>(input));
  return history.empty() ? std::nullopt : std::optional(history.back().stamp.s);
}

}  // namespace softarm::trial
