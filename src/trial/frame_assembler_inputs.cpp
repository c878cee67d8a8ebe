// Inputs and payload: what held at the stamp of a frame.
#include <algorithm>
#include <cmath>
#include <limits>

#include "softarm/trial/frame_assembler.h"

namespace softarm {
namespace {

constexpr std::size_t kLongestHistory = 20000;

}  // namespace

void FrameAssembler::add_input(int input, double stamp_s, double value) {
  const ScalarInput& source = scalars_.at(static_cast<std::size_t>(input));
  std::deque<Value>& history = inputs_.at(static_cast<std::size_t>(input));
  Input& stream = input_streams_.at(static_cast<std::size_t>(input));
  ++samples_;
  if (tap_.input) tap_.input(input, stamp_s, value);
  if (!std::isfinite(value)) return reject("input_nan", source.name);
  if (!(stamp_s > 0.0) || !std::isfinite(stamp_s)) return reject("bad_stamp", source.name);
  stamp_s -= source.latency_s;
  if (stream.rhythm.newest_s() && stamp_s < *stream.rhythm.newest_s() - params_.time_jump_s)
    stream.rhythm.reset();
  stream.rhythm.add(stamp_s);
  if (stream.last && *stream.last != value)
    input_changed_s_ = std::max(input_changed_s_.value_or(stamp_s), stamp_s);
  stream.last = value;
  // One that always comes too late would hold up every frame, and in vain.
  if (!newest_s_ || stamp_s > *newest_s_ - 0.5 * params_.input_wait_s) stream.expected = true;
  if (source.kind == InputKind::kTension || source.kind == InputKind::kAngle) {
    insert(history, {stamp_s, value - source.zero_si});
  } else {
    const double gauge_pa = source.reference == PressureReference::kAbsolute ? value - ambient_pa_ : value;
    insert(history, {stamp_s, source.kind == InputKind::kVacuum ? -gauge_pa : gauge_pa});
  }
  added();
}

void FrameAssembler::add_payload(double stamp_s, std::optional<double> kg) {
  ++samples_;
  if (tap_.payload) tap_.payload(stamp_s, kg);
  if (kg && !std::isfinite(*kg)) return reject("payload_nan", "payload");
  if (kg && !(*kg >= payload_range_kg_.low && *kg <= payload_range_kg_.high)) {
    return reject("payload_out_of_range", "payload");
  }
  if (!std::isfinite(stamp_s)) return reject("bad_stamp", "payload");
  insert(payload_, {stamp_s > 0.0 ? stamp_s : -std::numeric_limits<double>::infinity(), kg});
}

void FrameAssembler::insert(std::deque<Value>& history, const Value& value) {
  if (!history.empty() && value.stamp_s < history.back().stamp_s - params_.time_jump_s) history.clear();
  const auto after =
      std::find_if(history.begin(), history.end(), [&](const Value& v) { return v.stamp_s > value.stamp_s; });
  history.insert(after, value);
  if (history.size() > kLongestHistory) history.pop_front();
}

const FrameAssembler::Value* FrameAssembler::newest_at(std::deque<Value>& history, double stamp_s) {
  // Frames come in order of their stamps: what a newer value replaced is not asked for again.
  while (history.size() > 1 && history[1].stamp_s <= stamp_s) history.pop_front();
  return !history.empty() && history.front().stamp_s <= stamp_s ? &history.front() : nullptr;
}

InputValues FrameAssembler::inputs_at(double stamp_s) {
  // Strictly before the frame: whether a command of the very same stamp came before or after the bodies is
  // chance, and would tell a replayed bag from the live stream.
  const double before_s = std::nextafter(stamp_s, 0.0);
  InputValues values;
  for (auto& history : inputs_) {
    const Value* held = newest_at(history, before_s);
    const bool fresh = held && stamp_s - held->stamp_s <= input_max_age_s_;
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
  return history.empty() ? std::nullopt : std::optional(history.back().stamp_s);
}

}  // namespace softarm
