#include "frame_assembler.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace softarm::trial {
namespace {

/// The instant that a stamp means. A stamp that is none stays none.
Stamp instant_of(Stamp stamp, double latency_s) {
  return stamp.s > 0.0 ? stamp.earlier(latency_s) : stamp;
}

}  // namespace

void FrameAssembler::begin_message(const std::string& topic, const std::string& reader) {
  const auto has_read = std::find(message_readers_.begin(), message_readers_.end(), reader);
  const bool same = topic == message_topic_ && has_read == message_readers_.end();
  if (!same) {
    ++message_;
    message_topic_ = topic;
    message_readers_.clear();
  }
  message_readers_.push_back(reader);
}

bool FrameAssembler::is_alone_in_time(Stamp stamp) const {
  const double stamp_s = instant_of(stamp, body_latency_s_).s;
  if (is_ahead(stamp_s)) return !confirms(ahead_candidate_, stamp_s);
  const bool back = std::any_of(streams_.begin() + 1, streams_.end(), [&](const Stream& stream) {
    return stream.newest_s && stamp_s < *stream.newest_s - params_.time_jump_s;
  });
  return back && !confirms_step_back(stamp_s);
}

FrameAssembler::FrameAssembler(const arm::Arm& arm, const Params& params)
    : params_(params),
      has_base_body_(arm.base.body.has_value()),
      body_latency_s_(arm.inputs.body_latency_s),
      tolerance_s_(arm.inputs.body_sync_tolerance_s),
      payload_range_kg_(arm.payload.range_kg),
      ambient_pa_(arm.inputs.ambient_pressure_pa),
      input_max_age_s_(arm.inputs.input_max_age_s),
      scalars_(arm.inputs.scalars),
      inputs_(arm.inputs.scalars.size()),
      input_streams_(arm.inputs.scalars.size()) {
  double finest_sd_m = std::numeric_limits<double>::max();
  for (const arm::MeasuredBody& body : arm.bodies) finest_sd_m = std::min(finest_sd_m, body.position_sd_m);
  if (arm.bodies.empty()) finest_sd_m = 0.0;
  streams_.push_back({arm.base.body.value_or(""),
                      BodyGate({true, true, finest_sd_m, 0.0}, params.gate),
                      has_base_body_,
                      {},
                      {},
                      {}});
  for (const arm::MeasuredBody& body : arm.bodies) {
    const BodyGate::Body gate{body.kind == arm::BodyKind::kRing && body.orientation_usable, false,
                              body.position_sd_m, body.orientation_sd_rad};
    streams_.push_back({body.name, BodyGate(gate, params.gate), true, {}, {}, {}});
  }
}

FrameAssembler::Slot* FrameAssembler::slot_for(std::size_t index, Stamp stamp, bool repeats) {
  const double stamp_s = stamp.s;
  Stream& stream = streams_[index];
  if (message_topic_.empty()) ++message_;
  const auto useless = [&](const char* reason) -> Slot* {
    reject(reason, stream.name);
    return nullptr;
  };
  if (!check_time(stream, stamp_s)) return nullptr;
  if (stream.newest_s && stamp_s == *stream.newest_s) return useless("duplicate");
  stream.newest_s = std::max(stream.newest_s.value_or(stamp_s), stamp_s);
  stream.expected = true;
  if (newest_s_ && stamp_s > *newest_s_ + tolerance_s_) step_s_ = stamp_s - *newest_s_;
  newest_s_ = std::max(newest_s_.value_or(stamp_s), stamp_s);

  Pending* frame = nearest_open(stamp_s);
  if (frame && frame->slots[index].reported) {
    // Some drivers send each pose twice, stamped when it was sent. A faster body than the tolerance is a new
    // frame.
    if (repeats) return useless("duplicate");
    frame = nullptr;
  }
  if (!frame) {
    switch (past_of(index, stamp_s)) {
      case Past::kThisBodyCame:
        if (repeats) return useless("duplicate");
        break;
      case Past::kClosed:
        reject("late", stream.name);
        added();  // the stream went on: others may have waited for it
        return nullptr;
      case Past::kNone:
        break;
    }
    frame = open_frame(stamp_s);
  }
  Slot& slot = frame->slots[index];
  slot.reported = true;
  slot.stamp = stamp;
  return &slot;
}

void FrameAssembler::add_body(int body, Stamp stamp, const Eigen::Vector3d& p_mocap,
                              const std::optional<Eigen::Quaterniond>& q_mocap) {
  if (body == kBaseBody && !has_base_body_) throw std::out_of_range("the arm's base has no body");
  const std::size_t index = static_cast<std::size_t>(body + 1);
  Stream& stream = streams_.at(index);
  ++samples_;
  if (tap_.body) tap_.body(body, stamp.s, p_mocap, q_mocap);
  stamp = instant_of(stamp, body_latency_s_);
  Slot* slot = slot_for(index, stamp, stream.gate.repeats(p_mocap, q_mocap));
  if (!slot) return;
  std::optional<Eigen::Quaterniond> q = q_mocap;
  const BodyGate::Verdict verdict = stream.gate.check(stamp.s, p_mocap, q, changed_beside(index));
  if (verdict == BodyGate::Verdict::kAccept) {
    slot->observation = BodyObservation{body, p_mocap, q};
    if (body == kBaseBody) {
      base_body_pose_.emplace(*q);
      base_body_pose_->translation() = p_mocap;
    }
  } else {
    reject(BodyGate::name(verdict), stream.name);
  }
  added();
}

void FrameAssembler::add_missing_body(int body, Stamp stamp, const std::string& reason) {
  if (body == kBaseBody && !has_base_body_) throw std::out_of_range("the arm's base has no body");
  const std::size_t index = static_cast<std::size_t>(body + 1);
  Stream& stream = streams_.at(index);
  ++samples_;
  if (!slot_for(index, instant_of(stamp, body_latency_s_), false)) return;
  reject(reason, stream.name);
  added();
}

void FrameAssembler::count_rejected(const std::string& reason, const std::string& source,
                                    std::uint64_t count) {
  if (count > 0) rejected_[reason + " " + source] += count;
}

std::vector<Frame> FrameAssembler::take() {
  close_ready();
  std::vector<Frame> frames = take_before_jump();
  std::move(closed_.begin(), closed_.end(), std::back_inserter(frames));
  closed_.clear();
  return frames;
}

std::vector<Frame> FrameAssembler::take_before_jump() {
  return std::exchange(before_jump_, {});
}

void FrameAssembler::flush() {
  for (const Pending& pending : pending_) emit(pending);
  pending_.clear();
}

void FrameAssembler::reset() {
  const std::size_t lost = pending_.size() + before_jump_.size() + closed_.size();
  if (lost > 0) dropped_frames_["reset"] += lost;
  pending_.clear();
  before_jump_.clear();
  closed_.clear();
  last_emitted_.reset();
  newest_s_.reset();
  newest_before_jump_s_.reset();
  input_changed_s_.reset();
  base_body_pose_.reset();
  ahead_candidate_.reset();
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    Stream& stream = streams_[i];
    stream.gate.reset();
    stream.expected = i > 0 || has_base_body_;
    stream.newest_s.reset();
    stream.before_jump_s.reset();
    stream.back_candidate.reset();
  }
  for (auto& history : inputs_) history.clear();
  // What did not come before will hardly come now: it is not waited for again.
  for (Input& input : input_streams_) input.rhythm.reset();
  if (!payload_.empty()) {
    payload_.front() = {-std::numeric_limits<double>::infinity(), payload_.back().value, false};
    payload_.resize(1);
  }
}

bool FrameAssembler::take_time_jump() {
  return std::exchange(time_jump_, false);
}

std::optional<double> FrameAssembler::body_accepted_s(int body) const {
  return streams_.at(static_cast<std::size_t>(body + 1)).gate.accepted_s();
}

std::optional<double> FrameAssembler::changed_s() const {
  std::optional<double> newest;
  for (const Stream& stream : streams_) {
    const std::optional<double> changed = stream.gate.changed_s();
    if (changed && (!newest || *changed > *newest)) newest = changed;
  }
  return newest;
}

std::optional<double> FrameAssembler::changed_beside(std::size_t slot) const {
  // A mount rests: where there is but one ring, what drives it must say that it should move.
  std::optional<double> newest = streams_.size() > 2 ? std::nullopt : input_changed_s_;
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const std::optional<double> changed = streams_[i].gate.surely_changed_s();
    if (i != slot && changed && (!newest || *changed > *newest)) newest = changed;
  }
  return newest;
}

FrameAssembler::Pending* FrameAssembler::nearest_open(double stamp_s) {
  Pending* nearest = nullptr;
  for (Pending& pending : pending_) {
    const double distance = std::abs(pending.reference_s - stamp_s);
    if (distance <= tolerance_s_ && (!nearest || distance < std::abs(nearest->reference_s - stamp_s))) {
      nearest = &pending;
    }
  }
  return nearest;
}

FrameAssembler::Past FrameAssembler::past_of(std::size_t slot, double stamp_s) const {
  if (!last_emitted_ || stamp_s > last_emitted_->reference_s + tolerance_s_) return Past::kNone;
  const Slot& entry = last_emitted_->slots[slot];
  return entry.reported && stamp_s > entry.stamp.s ? Past::kThisBodyCame : Past::kClosed;
}

FrameAssembler::Pending* FrameAssembler::open_frame(double stamp_s) {
  ++frames_seen_;
  const auto after = std::find_if(pending_.begin(), pending_.end(),
                                  [stamp_s](const Pending& p) { return p.reference_s > stamp_s; });
  return &*pending_.insert(after, Pending{stamp_s, false, std::vector<Slot>(streams_.size())});
}

}  // namespace softarm::trial
