// nav_msgs/Odometry of mocap_optitrack, mocap_qualisys.
#include <nav_msgs/Odometry.h>

#include "pose_topics.h"

namespace softarm {
namespace {

/// The covariance is that of the driver's own filter, correlated in time: the arm file's noise stands.
BodySample odometry_sample(const nav_msgs::Odometry& message) {
  return {vector_of(message.pose.pose.position), quaternion_of(message.pose.pose.orientation)};
}

}  // namespace

BodyDriver driver_odometry() {
  return {topic_per_body<nav_msgs::Odometry, odometry_sample>};
}

}  // namespace softarm
