// From what was measured, frame by frame, to the messages in the order in which they are received.
#pragma once

#include <map>
#include <optional>
#include <variant>

#include "simulator.h"

namespace softarm::rig {

/// One body in one frame.
struct PoseSample {
  double stamp_s = 0.0;
  std::size_t body = 0;  ///< of Simulator::body_names()
  Pose pose;             ///< in the mocap frame
};

struct Received {
  double receipt_s = 0.0;
  std::variant<PayloadSample, InputSample, PoseSample> message;
};

/// Messages on their way. Those received at the same time come as they were sent: payload, inputs, bodies.
class ReceiptQueue {
 public:
  /// The messages of a sample. Samples are given in the order of time.
  void add(const Sample& sample);

  /// Takes the next message received by a time; up to the last sample's stamp_s nothing can come in between
  /// any more.
  std::optional<Received> take(double until_s);

 private:
  std::multimap<double, Received> on_the_way_;
};

}  // namespace softarm::rig
