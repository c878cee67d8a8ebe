// What the sensors see: private to the rig.
#pragma once

#include <optional>
#include <vector>

#include "protocol.h"
#include "sensors_clocks.h"
#include "sensors_inputs.h"
#include "sensors_poses.h"
#include "sensors_random.h"
#include "sensors_tracking.h"
#include "simulator.h"

namespace softarm::rig {

/// Motion capture, and the messages of the inputs. observe() is asked once a frame, in the order of time.
class Sensors {
 public:
  Sensors(const Scenario& scenario, const Protocol& protocol);

  /// Fills everything but the truth, from the truth at the frame's time.
  /// @param pose_at of the arm at that time
  void observe(const PoseAt& pose_at, Sample& sample);

  std::size_t dropouts() const { return dropouts_; }

 private:
  std::optional<Pose> with_noise(Pose pose, const PoseNoise& sd);
  void add_payload(Sample& sample);

  const Scenario& scenario_;
  const Protocol& protocol_;
  RandomStream noise_, duplicates_;
  PoseSensors poses_;
  Tracking tracking_;
  MessageClock mocap_clock_;
  InputSensors inputs_;
  std::size_t dropouts_ = 0;
  std::optional<double> published_kg_;
};

}  // namespace softarm::rig
