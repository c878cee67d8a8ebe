// Writes trial bags: the topics that a laboratory is asked to record.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/header.h>
#include <rosbag/bag.h>

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "lab_messages.h"
#include "trial/stamp.h"

namespace softarm {

/// What an import says of itself in its bags.
inline constexpr char kImportLayoutTopic[] = "/import/layout", kImportLeftOutTopic[] = "/import/left_out";

/// Writes the topics of a trial bag in SI units, each message recorded at the time of its receipt.
///
/// The same calls give the same bytes: nothing in the file depends on the clock, the machine or the process.
/// Times of receipt must be given in their order. Not thread-safe.
class TrialBagWriter {
 public:
  /// It and all that writes: @throws BagError where the file cannot be written, with its name
  /// @param called as which people know it, where it is renamed when it is complete
  explicit TrialBagWriter(const std::string& file, const std::string& called = "");

  /// /mocap/<body>/pose, geometry_msgs/PoseStamped in frame `mocap`.
  /// @param receipt absent: received at its stamp
  void pose(const std::string& body, trial::Stamp stamp, const Eigen::Vector3d& p_mocap,
            const Eigen::Quaterniond& q_mocap, std::optional<trial::Stamp> receipt = {});
  /// sensor_msgs/FluidPressure, absolute Pa.
  /// @param receipt absent: received at its stamp
  void pressure(const std::string& topic, trial::Stamp stamp, double absolute_pa,
                std::optional<trial::Stamp> receipt = {});
  /// std_msgs/Float64 (tension in N, say): without a stamp, it holds from its receipt.
  void scalar(const std::string& topic, trial::Stamp receipt, double value);
  /// /payload, std_msgs/Float64 in kg, latched; holds from `stamp` on, recorded 1 us before it.
  void payload(trial::Stamp stamp, double kg);

  /// Any of a laboratory's, latched ones 1 us before their receipt.
  void message(const LabMessage& message, trial::Stamp receipt);

  /// /import/layout, std_msgs/String, latched: the column layout that a recording was imported by.
  void import_layout(trial::Stamp stamp, const std::string& text);
  /// /import/left_out, std_msgs/Float64MultiArray: the stamps between which an import left rows out as told.
  void left_out(double from_s, double to_s);

  /// Completes the file. Without it the bag has no index.
  void close();

  std::uint64_t messages() const { return messages_; }

 private:
  template <typename Message>
  void write(const std::string& topic, trial::Stamp receipt, const Message& message, bool latched = false);
  std_msgs::Header header(const std::string& topic, trial::Stamp stamp, const std::string& frame);

  std::string path_;
  std::shared_ptr<rosbag::Bag> bag_;
  std::map<std::string, std::uint32_t> sequence_;
  std::uint64_t messages_ = 0;
};

}  // namespace softarm
