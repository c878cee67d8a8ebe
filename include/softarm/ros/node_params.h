// Parameters of the estimator node.
#pragma once

#include <ros/node_handle.h>

#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/diagnose/mismatch_monitor.h"
#include "softarm/effects/effect.h"
#include "softarm/ros/estimate_message.h"

namespace softarm {

/// Everything that the node is told at its start. The parameters are documented in launch/estimate.launch.
struct NodeParams {
  Arm arm;
  std::vector<effects::Present> effects;  ///< of the arm file
  EstimatorOptions options;               ///< the arm's, with what parameters override
  FrameNames frames;                      ///< ~mocap_frame, ~frame_prefix (default: the arm's name)
  double marker_rate_hz = 30.0;           ///< ~marker_rate: markers at most so often; 0: none
  bool publish_tf = true;                 ///< ~publish_tf
  bool monitor = true;                    ///< ~monitor: watch for sudden changes
  /// ~alarm_threshold, ~alarm_hold_off, ~alarm_memory, ~alarm_accept_after
  diagnose::MismatchMonitorParams alarm;
  double mismatch_warning = 4.0;  ///< ~mismatch_warning: chi-square per degree of freedom that is a warning

  /// Reads and checks them.
  /// @throws std::runtime_error in one line: parameter, value, what is allowed
  static NodeParams read(const ros::NodeHandle& private_nh);
};

}  // namespace softarm
