// A mismatch as ROS messages.
#pragma once

#include <softarm_estimator/Mismatch.h>
#include <visualization_msgs/MarkerArray.h>

#include "estimate_message.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm {

softarm_estimator::Mismatch to_message(const monitor::Mismatch& mismatch, const MessageContext& context);

/// Markers in the mocap frame while there is an alarm, none otherwise: `mismatch` (a red sleeve around the
/// place; without a place, as where the base moved, around the base) and `alarm` (text beside it). They
/// vanish half a second after the last one. @pre the estimate's status is ok and it has a backbone
visualization_msgs::MarkerArray to_markers(const monitor::Mismatch& mismatch,
                                           const estimate::Estimate& estimate, const MessageContext& context);

}  // namespace softarm
