// Keeps the last minutes of an arm's topics and runs `softarm diagnose` on them when asked.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <softarm_estimator/Mismatch.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ros/alarm_wait.h"
#include "ros/recent_messages.h"
#include "softarm/arm/arm.h"

namespace softarm::app {

/// Parameters, documented in launch/diagnose.launch.
struct DiagnoseNodeParams {
  std::string arm_name;  ///< as `softarm diagnose --arm` is given it
  arm::Arm arm;
  double keep_s = 300.0, trial_s = 30.0, most_mb = 1000.0;
  std::string out, program;
  std::vector<std::string> arguments;
  bool on_alarm = false;
  double alarm_wait_s = 10.0, alarm_pause_s = 600.0;

  /// @throws std::runtime_error in one line: parameter, value, what is allowed
  static DiagnoseNodeParams read(const ros::NodeHandle& private_nh);
};

/// 1. Every message of the arm's topics goes into RecentMessages, in the thread of spin().
/// 2. ~diagnose (std_srvs/Trigger), or an alarm of ~mismatch where params.on_alarm is set, takes a copy of
/// them (the messages are shared), writes it as trials and runs the program on these, in a thread of its own:
/// recording goes on. An alarm that comes meanwhile waits until that is over.
/// 3. The answer, and /diagnostics once a second, have the program's exit status and the report's path.
class DiagnoseNode {
 public:
  DiagnoseNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
               const DiagnoseNodeParams& params);
  ~DiagnoseNode();

  /// Works until ROS is shut down.
  void spin();

 private:
  struct Outcome {
    bool success = false;
    std::string description;
  };
  using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;

  void on_message(const std::string& topic, const Event& event);
  void on_mismatch(const softarm_estimator::Mismatch& mismatch);
  bool on_diagnose(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  void work();
  /// Of the whole thing; at most one at a time. @param why for the log
  Outcome diagnose(const std::string& why);
  Outcome run(RecentMessages recent);
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_, private_nh_;
  DiagnoseNodeParams params_;

  std::mutex recent_mutex_;
  RecentMessages recent_;
  std::vector<ros::Subscriber> subscribers_;

  // Services and diagnoses have a queue and a thread of their own.
  ros::CallbackQueue service_queue_;
  ros::ServiceServer service_;
  std::thread worker_;
  std::atomic<bool> stop_{false};
  std::mutex state_mutex_;
  std::optional<ros::SteadyTime> running_since_;
  std::optional<Outcome> last_;
  AlarmWait alarm_wait_;  // of the diagnosis that is still to begin
  std::optional<ros::SteadyTime> last_alarm_run_;
  bool was_alarm_ = false;
  std::uint64_t runs_ = 0;

  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace softarm::app
