// The live node: samples in, estimates out, for one arm.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <softarm_estimator/SetMode.h>
#include <softarm_estimator/SetPayload.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "finite.h"
#include "input_topic.h"
#include "node_params.h"
#include "node_statistics.h"
#include "overload.h"
#include "softarm/estimate/estimator.h"
#include "softarm/monitor/mismatch_monitor.h"
#include "topic_publishers.h"
#include "trial/frame_assembler.h"

namespace softarm {

/// Subscribes to what the arm listens to and answers every frame.
///
/// 1. Each message is converted to samples (InputTopic) and handed to the FrameAssembler. Frames close when
/// all messages at hand have been: after a hiccup of the machine what has arrived counts, whatever its topic.
/// 2. Each closed frame is estimated and published on ~estimate, whatever its status; with status ok also
/// ~backbone
///    (nav_msgs/Path), tf of base, rings and tip. ~markers follow at a lower rate.
/// 3. The mismatch monitor sees every frame and its estimate: ~mismatch.
/// 4. A time jump resets the estimator and the monitor.
/// 5. Where frames come faster than they can be answered some are skipped, so that the newest is not late:
/// counted as dropped, "overload".
/// 6. Once a second, and when an alarm of the monitor begins or ends, /diagnostics says what arrives, what
/// was rejected and why, how the fit does, and whether the arm does what its laws say.
///
/// No message with a NaN or infinity leaves: it is held back and counted. A clock, one that nobody sets, only
/// measures rates and solve times. All callbacks must run in one thread.
class EstimatorNode {
 public:
  /// Services: ~reset, ~set_payload, ~set_mode.
  /// @throws std::exception in one line if the arm cannot be estimated or names types that no adapter reads
  EstimatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const NodeParams& params);

  /// Works until ROS is shut down.
  void spin();

  const NodeStatistics& statistics() const { return statistics_; }
  const trial::FrameAssembler& assembler() const { return assembler_; }

 private:
  struct Source {
    InputTopic input;
    ros::Subscriber subscriber;
    std::uint64_t messages = 0, messages_before = 0;  // until now, and at the last diagnostics
    TopicPublishers publishers;
    bool said_two = false;  // publishers
    std::optional<std::string> two_publishers() const;
  };

  void on_message(Source& source, const std_msgs::Header* header, const std::string& publisher);
  void drain();
  bool is_hiccup(std::uint64_t messages);
  void process();
  void answer(std::vector<trial::Frame> frames);
  void handle(const trial::Frame& frame);
  bool watch(const trial::Frame& frame);
  void publish(const estimate::Estimate& estimate, const trial::Frame& frame, double solve_time_s);
  template <class Message>
  bool publish_finite(ros::Publisher& publisher, const Message& message);

  bool on_reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool on_set_payload(softarm_estimator::SetPayload::Request& request,
                      softarm_estimator::SetPayload::Response& response);
  bool on_set_mode(softarm_estimator::SetMode::Request& request,
                   softarm_estimator::SetMode::Response& response);

  void diagnose_frames(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_inputs(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_fit(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_mismatch(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_bodies(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_values(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_rejections(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_publishers(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose_silent_topics(diagnostic_updater::DiagnosticStatusWrapper& status);
  bool is_needed(int input) const;
  void on_diagnostics_timer();
  void show_waiting();
  std::string waiting_for() const;

  ros::NodeHandle nh_, private_nh_;
  NodeParams params_;
  estimate::Estimator estimator_;
  trial::FrameAssembler assembler_;
  std::optional<monitor::MismatchMonitor> monitor_;  // absent: not wanted
  const monitor::Mismatch* mismatch_ = nullptr;      // the newest; null before the first
  std::optional<monitor::Mismatch> last_alarm_;
  std::uint64_t alarms_ = 0;
  std::vector<std::string> body_names_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::uint64_t messages_ = 0;          // since the last round of drain()
  std::optional<double> drained_to_s_;  // newest stamp of a body then
  Overload overload_;
  std::uint64_t messages_of_second_ = 0;  // since second_start_
  double messages_per_s_ = 0.0;           // in the second before
  ros::SteadyTime second_start_;

  ros::Publisher estimate_publisher_, markers_publisher_, path_publisher_, mismatch_publisher_;
  tf2_ros::TransformBroadcaster tf_;
  std::vector<ros::ServiceServer> services_;
  std::optional<double> last_marker_s_;
  Eigen::Isometry3d base_in_mocap_;   // of the last estimate
  ros::Time clock_;                   // at the last diagnostics
  std::optional<double> payload_kg_;  // of the last frame

  NodeStatistics statistics_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer diagnostics_timer_;
  ros::SteadyTime period_start_;
  double period_s_ = 1.0;
  double silent_s_ = 0.0;  // wall time without a frame
  std::map<std::string, std::uint64_t> rejected_before_, dropped_before_;
  std::uint64_t samples_before_ = 0, time_jumps_before_ = 0, not_finite_before_ = 0, lost_before_ = 0;
  int diagnostics_count_ = 0;
};

template <class Message>
bool EstimatorNode::publish_finite(ros::Publisher& publisher, const Message& message) {
  if (!all_finite(message)) {
    ++statistics_.not_finite_messages;
    return false;
  }
  publisher.publish(message);
  return true;
}

}  // namespace softarm
