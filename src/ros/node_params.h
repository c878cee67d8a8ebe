// Parameters of the estimator node.
#pragma once

#include <ros/node_handle.h>

#include <vector>

#include "estimate_message.h"
#include "model/effect.h"
#include "softarm/arm/arm.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm {

/// Everything that the node is told at its start. The parameters are documented in launch/estimate.launch.
struct NodeParams {
  arm::Arm arm;
  std::vector<model::Present> effects;  ///< of the arm file
  arm::EstimatorOptions options;        ///< the arm's, with what parameters override
  FrameNames frames;                    ///< ~mocap_frame, ~frame_prefix (default: the arm's name)
  double marker_rate_hz = 30.0;         ///< ~marker_rate: markers at most so often; 0: none
  /// ~overload_latency: where frames come faster than they are answered, none is answered later than so long
  /// after it could be; the others are skipped. 0: none is
  double overload_latency_s = 0.02;
  bool publish_tf = true;  ///< ~publish_tf
  bool monitor = true;     ///< ~monitor: watch for sudden changes
  /// ~alarm_threshold, ~alarm_hold_off, ~alarm_memory, ~alarm_accept_after
  monitor::MismatchMonitorParams alarm;
  double reduced_chi_square_warning =
      4.0;  ///< ~reduced_chi_square_warning: chi-square per degree of freedom that is a warning

  /// Reads and checks them.
  /// @throws std::runtime_error in one line: parameter, value, what is allowed
  static NodeParams read(const ros::NodeHandle& private_nh);
};

}  // namespace softarm
