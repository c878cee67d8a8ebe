#include "diagnose_node.h"

#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "child.h"
#include "ros/input_topics.h"
#include "ros/master_watch.h"
#include "ros/open_bag.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;
using diagnostic_msgs::DiagnosticStatus;

constexpr double kTick_s = 0.1;
constexpr double kEnoughTrials = 0.5;  // of one: less than this is no recording

/// A folder that is not there yet, named by the newest message.
fs::path new_folder(const std::string& out, const ros::Time& time) {
  const std::time_t seconds = time.sec;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char name[32];
  std::strftime(name, sizeof name, "%Y%m%d_%H%M%S", &utc);
  fs::path folder = fs::path(out) / name;
  for (int i = 2; fs::exists(folder); ++i) folder = fs::path(out) / fmt::format("{}_{}", name, i);
  return folder;
}

}  // namespace

DiagnoseNode::DiagnoseNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                           const DiagnoseNodeParams& params)
    : nh_(nh),
      private_nh_(private_nh),
      params_(params),
      recent_(params.keep_s, static_cast<std::size_t>(1e6 * params.most_mb)),
      alarm_wait_(params.alarm_wait_s),
      updater_(nh_, private_nh_, ros::this_node::getName()) {
  // By the names that the program looks for, wherever remapping and namespace take them from. Base and rings
  // may come on one topic: its messages are kept once.
  std::map<std::string, std::string> topics;
  for (const InputTopic& input : input_topics(params_.arm))
    topics.emplace(absolute_topic(input.topic), input.topic);
  for (const auto& [in_bag, topic] : topics) {
    const boost::function<void(const Event&)> callback = [this, name = in_bag](const Event& event) {
      on_message(name, event);
    };
    subscribers_.push_back(nh_.subscribe<topic_tools::ShapeShifter, const Event&>(
        topic, kSubscriberQueue, callback, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
  if (params_.on_alarm)
    subscribers_.push_back(nh_.subscribe("mismatch", 100, &DiagnoseNode::on_mismatch, this));
  updater_.setHardwareID(params_.arm.name);
  updater_.add("diagnosis", this, &DiagnoseNode::report);
  timer_ = nh_.createWallTimer(ros::WallDuration(1.0),
                               [this](const ros::WallTimerEvent&) { updater_.force_update(); });

  ros::AdvertiseServiceOptions options = ros::AdvertiseServiceOptions::create<std_srvs::Trigger>(
      private_nh_.resolveName("diagnose"),
      [this](std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response) {
        return on_diagnose(request, response);
      },
      ros::VoidConstPtr(), &service_queue_);
  service_ = private_nh_.advertiseService(options);
  worker_ = std::thread([this] { work(); });
}

DiagnoseNode::~DiagnoseNode() {
  stop_ = true;
  worker_.join();
}

void DiagnoseNode::spin() {
  const MasterWatch watch({service_});
  ros::spin();
}

void DiagnoseNode::work() {
  while (ros::ok() && !stop_) {
    service_queue_.callAvailable(ros::WallDuration(kTick_s));
    bool due = false;
    {
      const std::lock_guard<std::mutex> lock(state_mutex_);
      due = alarm_wait_.over(ros::Time::now(), ros::SteadyTime::now());
      if (due) last_alarm_run_ = ros::SteadyTime::now();
    }
    if (due) diagnose("an alarm");
  }
}

void DiagnoseNode::on_message(const std::string& topic, const Event& event) {
  const std::lock_guard<std::mutex> lock(recent_mutex_);
  recent_.add(topic, event.getReceiptTime(), *event.getConstMessage(), event.getConnectionHeaderPtr());
}

void DiagnoseNode::on_mismatch(const softarm_estimator::Mismatch& mismatch) {
  const bool begins = mismatch.alarm && !was_alarm_;
  was_alarm_ = mismatch.alarm;
  if (!begins) return;
  const std::lock_guard<std::mutex> lock(state_mutex_);
  const ros::SteadyTime now = ros::SteadyTime::now();
  // One that already waits stands for those that follow; but while a diagnosis runs the newest waits.
  if (alarm_wait_.waits() && !running_since_) return;
  // By the machine's clock, also where time is simulated: it is the machine that is to have a pause.
  if (last_alarm_run_ && (now - *last_alarm_run_).toSec() < params_.alarm_pause_s) return;
  alarm_wait_.begin(ros::Time::now(), now);
  ROS_INFO("alarm (%s): a diagnosis in %.0f s%s", mismatch.description.c_str(), params_.alarm_wait_s,
           running_since_ ? ", or when the one that runs is over" : "");
}

bool DiagnoseNode::on_diagnose(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const Outcome outcome = diagnose("the service was called");
  response.success = outcome.success;
  response.message = outcome.description;
  return true;
}

DiagnoseNode::Outcome DiagnoseNode::diagnose(const std::string& why) {
  RecentMessages recent(params_.keep_s, 0);
  {
    const std::lock_guard<std::mutex> lock(recent_mutex_);
    recent = recent_;  // pointers to the messages
  }
  {
    const std::lock_guard<std::mutex> lock(state_mutex_);
    running_since_ = ros::SteadyTime::now();
    ++runs_;
  }
  ROS_INFO("diagnosis of the last %.0f s: %s", recent.duration_s(), why.c_str());
  Outcome outcome;
  try {
    outcome = run(std::move(recent));
  } catch (const std::exception& e) {
    outcome.description = e.what();
  }
  if (outcome.success) {
    ROS_INFO("diagnosis: %s", outcome.description.c_str());
  } else {
    ROS_WARN("diagnosis: %s", outcome.description.c_str());
  }
  const std::lock_guard<std::mutex> lock(state_mutex_);
  running_since_.reset();
  last_ = outcome;
  return outcome;
}

DiagnoseNode::Outcome DiagnoseNode::run(RecentMessages recent) {
  if (recent.duration_s() < kEnoughTrials * params_.trial_s) {
    return {false,
            fmt::format("only {:.1f} s have been recorded: at least {:.1f} s (half of ~trial_s) are needed",
                        recent.duration_s(), kEnoughTrials * params_.trial_s)};
  }
  const fs::path folder = new_folder(params_.out, recent.messages().back().receipt);
  const std::vector<std::string> trials = write_trials(recent, (folder / "trials").string(), params_.trial_s);
  recent = RecentMessages(params_.keep_s, 0);  // they would stay in memory beside what comes meanwhile
  std::vector<std::string> arguments{"diagnose", "--arm", params_.arm_name};
  arguments.insert(arguments.end(), trials.begin(), trials.end());
  arguments.insert(arguments.end(), {"--out", (folder / "report").string()});
  arguments.insert(arguments.end(), params_.arguments.begin(), params_.arguments.end());
  const fs::path log = folder / "diagnose.log";
  const Ended ended = run_program(params_.program, arguments, log.string(), stop_);
  const fs::path report = folder / "report" / "report.html";
  if (ended.exit_status == 0 && fs::exists(report))
    return {true, fmt::format("exit status 0, report: {}", report.string())};
  return {false, fmt::format("exit status {}{}{}, trials: {}, log: {}", ended.exit_status,
                             ended.exit_status == 0 ? ", but no report.html" : "",
                             ended.last_line.empty() ? "" : " (" + ended.last_line + ")",
                             (folder / "trials").string(), log.string())};
}

void DiagnoseNode::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  double duration_s = 0.0, mb = 0.0;
  std::size_t messages = 0;
  std::uint64_t dropped = 0;
  {
    const std::lock_guard<std::mutex> lock(recent_mutex_);
    duration_s = recent_.duration_s();
    mb = 1e-6 * static_cast<double>(recent_.bytes());
    messages = recent_.messages().size();
    dropped = recent_.dropped_for_size();
  }
  const std::lock_guard<std::mutex> lock(state_mutex_);
  status.summary(
      messages > 0 ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
      messages > 0 ? fmt::format("the last {:.0f} s are kept", duration_s) : "nothing recorded yet");
  if (running_since_) {
    status.mergeSummary(DiagnosticStatus::OK,
                        fmt::format("a diagnosis has been running for {:.0f} s",
                                    (ros::SteadyTime::now() - *running_since_).toSec()));
  } else if (last_) {
    status.mergeSummary(last_->success ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                        "last diagnosis: " + last_->description);
  }
  if (dropped > 0) {
    status.mergeSummary(DiagnosticStatus::WARN, fmt::format("less than {:.0f} s fit into max_mb {:g}",
                                                            params_.keep_s, params_.most_mb));
  }
  status.add("kept (s)", fmt::format("{:.1f}", duration_s));
  status.add("kept (messages)", messages);
  status.add("kept (MB)", fmt::format("{:.1f}", mb));
  status.add("diagnoses", runs_);
  status.add("running", running_since_ ? "yes" : "no");
  status.add("an alarm waits", alarm_wait_.waits() ? "yes" : "no");
  if (last_) status.add("last diagnosis", last_->description);
}

}  // namespace softarm::app
