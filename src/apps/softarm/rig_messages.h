// What the virtual rig's sensors see, as the messages of a laboratory.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rig/receipt_queue.h"
#include "ros/lab_messages.h"
#include "softarm/arm/arm.h"

namespace softarm::app {

/// Indices, in Inputs::scalars, of the inputs of a kind that drive a segment. The rig numbers them so.
std::vector<std::size_t> driven_inputs(const arm::Arm& arm, arm::InputKind kind);

/// From the rig's mocap frame, whose z is up, to the arm file's, whose gravity may lie otherwise.
Eigen::Quaterniond to_arms_mocap(const arm::Arm& arm);

/// On the topics, of the types and in the units of an arm file; without one on those that the trial bags of
/// doc/rig.md have.
class RigMessages {
 public:
  using StampOf = std::function<ros::Time(double t_s)>;

  /// @throws std::invalid_argument in one line for what the rig cannot send
  RigMessages(const rig::Simulator& simulator, const std::optional<arm::Arm>& arm);

  std::vector<LabMessage> of(const rig::Received& received, const StampOf& stamp_of);
  /// One for each topic, to advertise them.
  std::vector<LabMessage> blank() const;

 private:
  bool is_base(std::size_t body) const { return base_measured_ && body == 0; }

  std::vector<std::string> bodies_;
  bool base_measured_ = true, payload_ = true;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  std::map<std::pair<rig::InputKind, int>, std::vector<std::size_t>> inputs_;
  std::optional<LabMessages> messages_;
};

}  // namespace softarm::app
