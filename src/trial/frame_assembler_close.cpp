// When a frame is closed, and what becomes of it.
#include <utility>

#include "frame_assembler.h"

namespace softarm::trial {

void FrameAssembler::added() {
  if (!params_.close_when_taken) close_ready();
}

bool FrameAssembler::awaits_body(const Pending& frame, std::size_t i) const {
  const Stream& stream = streams_[i];
  return stream.expected && !frame.slots[i].reported &&
         !(stream.newest_s && *stream.newest_s > frame.reference_s + tolerance_s_);
}

bool FrameAssembler::awaits_input(const Pending& frame, std::size_t i) const {
  const Input& input = input_streams_[i];
  return params_.input_wait_s > 0.0 && input.expected && input.rhythm.is_due(frame.reference_s);
}

bool FrameAssembler::waited_for_bodies(const Pending& frame) const {
  return *newest_s_ > frame.reference_s + params_.reorder_window_s;
}

bool FrameAssembler::waited_for_inputs(const Pending& frame) const {
  return *newest_s_ > frame.reference_s + params_.input_wait_s;
}

bool FrameAssembler::gives_up() const {
  for (const Pending& frame : pending_) {
    if (waited_for_bodies(frame)) {
      for (std::size_t i = 0; i < streams_.size(); ++i)
        if (awaits_body(frame, i)) return true;
    }
    if (waited_for_inputs(frame)) {
      for (std::size_t i = 0; i < input_streams_.size(); ++i)
        if (awaits_input(frame, i)) return true;
    }
  }
  return false;
}

bool FrameAssembler::bodies_complete(const Pending& frame) {
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    if (!awaits_body(frame, i)) continue;
    if (!waited_for_bodies(frame)) return false;
    streams_[i].expected = false;
  }
  return true;
}

bool FrameAssembler::inputs_complete(Pending& frame) {
  for (std::size_t i = 0; i < input_streams_.size(); ++i) {
    if (!awaits_input(frame, i)) continue;
    if (!waited_for_inputs(frame)) {
      frames_that_waited_ += !std::exchange(frame.waited, true);
      return false;
    }
    input_streams_[i].expected = false;
    ++waited_in_vain_[scalars_[i].name];
  }
  return true;
}

void FrameAssembler::close_ready() {
  while (!pending_.empty() && bodies_complete(pending_.front()) && inputs_complete(pending_.front())) {
    emit(pending_.front());
    pending_.pop_front();
  }
}

void FrameAssembler::emit(const Pending& pending) {
  last_emitted_ = pending;
  Frame frame;
  const Stamp* first = nullptr;
  for (std::size_t i = 0; i < pending.slots.size(); ++i) {
    const Slot& entry = pending.slots[i];
    if (!entry.observation) continue;
    if (!first || entry.stamp.ns < first->ns) first = &entry.stamp;
    if (i > 0) {
      frame.bodies.push_back(*entry.observation);
    } else {
      Eigen::Isometry3d pose(*entry.observation->q_mocap);
      pose.translation() = entry.observation->p_mocap;
      frame.base_body = pose;
    }
  }
  if (frame.bodies.empty() && !frame.base_body) {
    ++dropped_frames_["no_valid_body"];
    return;
  }
  frame.stamp_ns = first->ns;
  frame.samples = samples_until(first->s);
  frame.inputs = inputs_at(first->s);
  frame.payload_kg = payload_at(first->s);
  closed_.push_back(std::move(frame));
}

}  // namespace softarm::trial
