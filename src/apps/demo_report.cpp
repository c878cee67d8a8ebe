// Listens to a running estimator, shows a live line, and ends with a table.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "demo_report/tally.h"

namespace {

constexpr double kSilence_s = 5.0;

struct Options {
  double seconds = 20.0;
  double wait_s = 60.0;
  bool truth = false;
  std::string estimate_topic = "/softarm_estimator/estimate";
  std::string truth_topic = "/softarm_rig/truth";
};

void listen(softarm::Tally& tally, const Options& options) {
  ros::NodeHandle nh;
  ros::WallTime newest = ros::WallTime::now();
  const auto on_estimate = [&](const softarm_estimator::ArmEstimate::ConstPtr& message) {
    newest = ros::WallTime::now();
    tally.add(*message, ros::Time::now(), newest);
  };
  const auto on_truth = [&](const softarm_estimator::Truth::ConstPtr& message) { tally.add(*message); };
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const ros::Subscriber estimates = nh.subscribe<softarm_estimator::ArmEstimate>(
      options.estimate_topic, 1000, on_estimate, ros::VoidConstPtr(), hints);
  const auto on_diagnostics = [&](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
    for (const diagnostic_msgs::DiagnosticStatus& status : message->status) tally.add(status);
  };
  const ros::Subscriber diagnostics =
      nh.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 100, on_diagnostics);
  ros::Subscriber truth;
  if (options.truth) {
    truth = nh.subscribe<softarm_estimator::Truth>(options.truth_topic, 1000, on_truth, ros::VoidConstPtr(),
                                                   hints);
  }

  const bool live = isatty(STDOUT_FILENO) != 0;
  const ros::WallTime start = ros::WallTime::now();
  std::optional<ros::WallTime> first;
  ros::WallTime shown;
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    const ros::WallTime now = ros::WallTime::now();
    if (!first && tally.frames() > 0) first = now;
    if (live && (now - shown).toSec() > 0.1) {
      fmt::print("\r\033[K{}", tally.line());
      std::fflush(stdout);
      shown = now;
    }
    if (first ? (now - *first).toSec() >= options.seconds : (now - start).toSec() >= options.wait_s) break;
    if (first && (now - newest).toSec() > kSilence_s) break;  // a recording that is over
  }
  if (live) fmt::print("\r\033[K");
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "softarm_report", ros::init_options::AnonymousName);
  CLI::App app{"Shows live estimates and ends with a table. Exit status 0 only if estimates were received."};
  Options options;
  app.add_option("--seconds", options.seconds, "how long to listen after the first estimate, s")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_option("--wait", options.wait_s, "how long to wait for the first estimate, s")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_flag("--truth,!--no-truth", options.truth,
               "compare with the truth of the virtual rig (default: do not)");
  app.add_option("--estimate-topic", options.estimate_topic, "estimates of the node")->capture_default_str();
  app.add_option("--truth-topic", options.truth_topic, "truth of the virtual rig")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  softarm::Tally tally;
  listen(tally, options);
  fmt::print("\n{}", tally.table(options.truth));
  std::fflush(stdout);  // the reason of a failure comes after it
  if (const std::string trouble = tally.trouble(options.truth); !trouble.empty()) {
    fmt::print(stderr, "demo_report: {} ({})\n", trouble, options.estimate_topic);
    return 1;
  }
  if (options.truth && tally.compared() == 0) {
    fmt::print(stderr, "demo_report: no truth was received on {}\n", options.truth_topic);
    return 1;
  }
  return 0;
}
