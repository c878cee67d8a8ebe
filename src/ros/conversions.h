// Eigen to geometry_msgs, stamps both ways.
#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <ros/time.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "trial/stamp.h"

namespace softarm {

inline trial::Stamp to_stamp(const ros::Time& time) {
  return trial::Stamp::from_ns(static_cast<std::int64_t>(time.toNSec()));
}

/// Zero where the stamp is from before all dates.
inline ros::Time to_time(std::int64_t stamp_ns) {
  return ros::Time().fromNSec(static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp_ns)));
}

/// The same where the stamp is a driver's, of whatever epoch: the last time that there is (in 2106) where the
/// stamp is later. to_time() throws there, as what is to be kept must not change.
inline ros::Time nearest_time(std::int64_t stamp_ns) {
  constexpr std::int64_t kLast_ns = (std::int64_t{1} << 32) * 1'000'000'000 - 1;
  return to_time(std::min(stamp_ns, kLast_ns));
}

/// From a stamp to a time, s. Not by ros::Duration: it throws beyond 68 years, and stamps that count from
/// 1900 (NTP) are 70 years off.
inline double seconds_since(std::int64_t stamp_ns, const ros::Time& time) {
  return trial::to_seconds(static_cast<std::int64_t>(time.toNSec()) - stamp_ns);
}

inline geometry_msgs::Point to_point(const Eigen::Vector3d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

inline geometry_msgs::Vector3 to_vector(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v.x();
  vector.y = v.y();
  vector.z = v.z();
  return vector;
}

inline geometry_msgs::Quaternion to_quaternion(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion quaternion;
  quaternion.x = q.x();
  quaternion.y = q.y();
  quaternion.z = q.z();
  quaternion.w = q.w();
  return quaternion;
}

inline geometry_msgs::Pose to_pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  geometry_msgs::Pose pose;
  pose.position = to_point(p);
  pose.orientation = to_quaternion(q);
  return pose;
}

inline geometry_msgs::Pose to_pose(const Eigen::Isometry3d& pose) {
  return to_pose(pose.translation(), Eigen::Quaterniond(pose.linear()).normalized());
}

inline geometry_msgs::Transform to_transform(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  geometry_msgs::Transform transform;
  transform.translation = to_vector(p);
  transform.rotation = to_quaternion(q);
  return transform;
}

}  // namespace softarm
