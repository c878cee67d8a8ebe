// An estimate as ROS messages.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Path.h>
#include <ros/time.h>
#include <softarm_estimator/ArmEstimate.h>

#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/estimate/estimator.h"

namespace softarm {

/// Names of the tf frames: `<prefix>/base`, `<prefix>/<body>`, `<prefix>/tip` below the frame of the mocap.
struct FrameNames {
  std::string mocap = "mocap";
  std::string prefix;
  std::string base() const { return prefix + "/base"; }
  std::string of(const std::string& body) const { return prefix + "/" + body; }
};

/// What the messages of one estimate have in common.
struct MessageContext {
  const arm::Arm& arm;
  const arm::EstimatorOptions& options;
  const FrameNames& frames;
  ros::Time stamp;
};

/// The estimate, whatever its status; without a backbone unless it is ok.
/// @param solve_time_s how long the estimator took
softarm_estimator::ArmEstimate to_message(const estimate::Estimate& estimate, const MessageContext& context,
                                          double solve_time_s);

/// The backbone in the base frame. @pre status is ok
nav_msgs::Path to_path(const estimate::Estimate& estimate, const MessageContext& context);

/// Base in the mocap frame; rings and tip, as estimated, in the base frame. @pre status is ok
std::vector<geometry_msgs::TransformStamped> to_transforms(const estimate::Estimate& estimate,
                                                           const MessageContext& context);

}  // namespace softarm
