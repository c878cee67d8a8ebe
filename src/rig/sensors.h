// What the sensors see: private to the rig.
#pragma once

#include <optional>
#include <vector>

#include "random_stream.h"
#include "softarm/rig/protocol.h"
#include "softarm/rig/simulator.h"

namespace softarm::rig {

/// Motion capture, and the messages of the inputs. observe() is asked once a frame, in the order of time.
class Sensors {
 public:
  Sensors(const Scenario& scenario, const Protocol& protocol);

  /// Fills everything but the truth, from the truth at the frame's stamp.
  void observe(Sample& sample);

  std::size_t dropouts() const { return dropouts_; }

 private:
  std::optional<Pose> measure(const Pose& base_pose, const PoseNoise& sd);
  void add_inputs(Sample& sample);
  void add_payload(Sample& sample);
  /// Calls with the stamp and commands of each message of a kind's drive up to a time.
  template <typename Add>
  void messages_until(double until_s, const DriveSpec& spec, std::size_t& count, const Add& add) const;

  const Scenario& scenario_;
  const Protocol& protocol_;
  RandomStream noise_;
  std::size_t pressure_messages_ = 0, tension_messages_ = 0, angle_messages_ = 0;
  std::size_t dropouts_ = 0;
  std::optional<double> published_kg_;
};

}  // namespace softarm::rig
