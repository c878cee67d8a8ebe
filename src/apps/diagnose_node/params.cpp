#include <cstdlib>
#include <sstream>

#include "child.h"
#include "diagnose_node.h"
#include "ros/param_reader.h"
#include "softarm/arm/arm_file.h"

namespace softarm::app {
namespace {

/// Where ROS keeps what its nodes write.
std::string ros_home() {
  if (const char* home = std::getenv("ROS_HOME")) return home;
  const char* home = std::getenv("HOME");
  return std::string(home ? home : ".") + "/.ros";
}

}  // namespace

DiagnoseNodeParams DiagnoseNodeParams::read(const ros::NodeHandle& private_nh) {
  ParamReader reader(private_nh);
  DiagnoseNodeParams params;
  const std::optional<std::string> arm = reader.word("arm");
  if (!arm) throw reader.error("arm", "is not set: the path of an arm file, or the name of a shipped arm");
  std::vector<std::string> directories;
  if (const auto directory = reader.word("arms_dir")) directories.push_back(*directory);
  params.arm_name = *arm;
  params.arm = arm::load_arm_file(*arm, directories);
  params.keep_s = 60.0 * reader.number("minutes", 0.05, 240.0).value_or(params.keep_s / 60.0);
  params.trial_s = reader.number("trial_s", 1.0, 3600.0).value_or(params.trial_s);
  if (params.trial_s > params.keep_s) {
    throw reader.error("trial_s", fmt::format("is {}, allowed is at most ~minutes, which is {} s",
                                              params.trial_s, params.keep_s));
  }
  params.most_mb = reader.number("max_mb", 1.0, 1e6).value_or(params.most_mb);
  params.out = reader.word("out").value_or(ros_home() + "/softarm_diagnosis");
  params.program = reader.word("program").value_or(beside_this_program("softarm"));
  std::istringstream words(reader.word("arguments").value_or(""));
  for (std::string word; words >> word;) params.arguments.push_back(word);
  params.on_alarm = reader.flag("on_alarm").value_or(params.on_alarm);
  params.alarm_wait_s = reader.number("alarm_wait", 0.0, 3600.0).value_or(params.alarm_wait_s);
  params.alarm_pause_s = reader.number("alarm_pause", 0.0, 86400.0).value_or(params.alarm_pause_s);
  reader.warn_of_unknown();
  return params;
}

}  // namespace softarm::app
