// A trial of the rig as messages of a live graph.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rig/scenario.h"
#include "rig/simulator.h"

namespace softarm {

struct RigTrial {
  std::vector<std::string> bodies;
  std::vector<rig::Sample> samples;
};

/// The scenario trial_10s, for another time and at another rate.
inline RigTrial simulated_trial(double seconds, double rate_hz) {
  const std::string path = std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/trial_10s.yaml";
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  rig::Scenario scenario = rig::parse_scenario(text.str(), path);
  scenario.duration_s = seconds;
  scenario.mocap.rate_hz = rate_hz;
  rig::Simulator simulator(scenario);
  RigTrial trial{simulator.body_names(), {}};
  while (auto sample = simulator.next()) trial.samples.push_back(std::move(*sample));
  return trial;
}

template <class Pose>
geometry_msgs::PoseStamped pose_message(const Pose& pose, ros::Time stamp) {
  geometry_msgs::PoseStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = "mocap";
  message.pose.position.x = pose.p.x();
  message.pose.position.y = pose.p.y();
  message.pose.position.z = pose.p.z();
  message.pose.orientation.w = pose.q.w();
  message.pose.orientation.x = pose.q.x();
  message.pose.orientation.y = pose.q.y();
  message.pose.orientation.z = pose.q.z();
  return message;
}

}  // namespace softarm
