// Frames, as they come, to a trial.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm::trial {

/// Keeps frames, and out of their samples the inputs as series.
///
/// Where frames go back in time one stamp means several instants: such a trial has no series, and what its
/// frames hold is used.
class TrialRecorder {
 public:
  TrialRecorder(const arm::Arm& arm, std::string name);

  void add(Frame frame);
  /// Samples that are in no frame: those after the last one, to which lines still lead.
  void add(const std::vector<InputSample>& samples);
  /// The trial; the recorder is empty afterwards.
  Trial take();

 private:
  std::vector<std::optional<arm::Between>> stated_;
  Trial trial_;
  bool went_back_ = false;
};

}  // namespace softarm::trial
