// What a laboratory's drivers and controllers send, by the arm file that listens to them: the way back of the
// drivers. For the virtual rig.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "softarm/arm/arm.h"

namespace softarm {

struct LabMessage {
  std::string topic;
  std::variant<geometry_msgs::PoseStamped, geometry_msgs::TransformStamped, nav_msgs::Odometry,
               geometry_msgs::PointStamped, tf2_msgs::TFMessage, sensor_msgs::FluidPressure,
               std_msgs::Float64, std_msgs::Float32MultiArray, std_msgs::Float64MultiArray>
      content;
  bool latched = false;
};

/// Makes the messages of bodies, inputs and payload on the topics, of the types and in the units of the arm
/// file. Not thread-safe.
class LabMessages {
 public:
  /// @param driven indices in Inputs::scalars of what is sent at all
  /// @throws std::invalid_argument, a line that begins with the key, for what has no way back: markers,
  /// clouds of points, fields of other messages, stamps of receipt with a latency
  LabMessages(const arm::Inputs& inputs, std::vector<std::size_t> driven);

  /// @param name of the body
  /// @param is_base whether it is that of the base
  LabMessage body(const std::string& name, bool is_base, ros::Time stamp, const Eigen::Vector3d& p_mocap,
                  const Eigen::Quaterniond& q_mocap) const;
  /// @param input index in Inputs::scalars
  /// @param value of pressures absolute Pa, of a vacuum too; else N, rad
  /// @returns nothing where the message waits for other elements of its array
  std::optional<LabMessage> scalar(std::size_t input, ros::Time stamp, double value);
  LabMessage payload(double kg) const;

  /// One of each topic of what is driven, without its values: to advertise them.
  std::vector<LabMessage> blank_scalars() const;

 private:
  struct Array {
    std::size_t last_input = 0;  ///< the one that sends it
    std::vector<double> values;
  };
  arm::Inputs inputs_;
  std::vector<std::size_t> driven_;
  std::map<std::string, Array> arrays_;  ///< by topic
};

}  // namespace softarm
