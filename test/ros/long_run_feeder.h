// A trial of the rig, played over and over with the faults of drivers, trackers and networks.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "rig_trial.h"

namespace softarm::testing_long_run {

constexpr double kRateHz = 240.0;

/// Plays the trial over and over with faults of drivers, trackers and networks.
class Feeder {
 public:
  Feeder(ros::NodeHandle& nh, const RigTrial& trial, ros::Time start, unsigned seed)
      : nh_(nh), trial_(trial), start_(start), random_(seed), state_(trial.bodies.size()) {
    for (const std::string& body : trial.bodies)
      bodies_.push_back(nh.advertise<geometry_msgs::PoseStamped>("/mocap/" + body + "/pose", 1000));
    for (int i = 0; i < 3; ++i) {
      pressures_.push_back(
          nh.advertise<sensor_msgs::FluidPressure>(rig::topic_of(rig::InputKind::kChamber, i), 1000));
    }
    payload_ = nh.advertise<std_msgs::Float64>("/payload", 10, true);
  }

  bool connected() const {
    return std::all_of(bodies_.begin(), bodies_.end(),
                       [](const auto& p) { return p.getNumSubscribers() > 0; });
  }

  /// Distinct instants of which at least one body was sent with a stamp that is one.
  std::uint64_t sent() const { return sent_; }
  const std::map<std::string, std::uint64_t>& faults() const { return faults_; }

  void frame(std::uint64_t k) {
    const rig::Sample& sample = trial_.samples[k % trial_.samples.size()];
    if (sample.payload) publish_payload(sample.payload->kg);
    for (const rig::InputSample& input : sample.inputs) press(k, input, sample.stamp_s);
    if (pause_until_ > k) return;
    if (dice(2e-5)) {
      pause_until_ = k + between(100, 400);  // the driver stops, for more than a second now and then
      ++faults_["pauses of the driver"];
      return;
    }
    if (dice(2e-4)) swap_until_ = k + between(1, 40);
    bool any = false;
    for (std::size_t i = 0; i < bodies_.size(); ++i) any = send(k, i, sample) || any;
    sent_ += any;
  }

 private:
  struct State {
    std::uint64_t lost_until = 0, frozen_until = 0, ghost_until = 0;
    geometry_msgs::Pose frozen;
  };

  bool dice(double probability) { return std::uniform_real_distribution<double>()(random_) < probability; }
  std::uint64_t between(std::uint64_t low, std::uint64_t high) {
    return std::uniform_int_distribution<std::uint64_t>(low, high)(random_);
  }
  ros::Time stamp(std::uint64_t k) const {
    return start_ + ros::Duration().fromNSec(static_cast<std::int64_t>(std::llround(1e9 / kRateHz * k)));
  }

  void publish_payload(double kg) {
    std_msgs::Float64 message;
    message.data = kg;
    payload_.publish(message);
  }

  void press(std::uint64_t k, const rig::InputSample& input, double frame_s) {
    if (input.kind != rig::InputKind::kChamber) return;
    const auto i = static_cast<std::size_t>(input.number);
    if (silent_until_ > k) return;
    if (i == 0 && dice(2e-4)) {
      silent_until_ = k + between(60, 400);
      ++faults_["pressures fall silent"];
      return;
    }
    if (dice(0.01)) return;  // lost on its way
    sensor_msgs::FluidPressure message;
    message.header.stamp = stamp(k) + ros::Duration(input.stamp_s - frame_s);
    message.fluid_pressure = dice(1e-3) ? std::numeric_limits<double>::quiet_NaN() : input.value;
    pressures_[i].publish(message);
  }

  bool send(std::uint64_t k, std::size_t i, const rig::Sample& sample) {
    State& state = state_[i];
    // What was held back comes now, after the frames that followed it.
    if (i < late_.size() && !late_[i].empty()) {
      for (const auto& message : late_[i]) bodies_[i].publish(message);
      late_[i].clear();
    }
    const bool swapped = swap_until_ > k && (i == 2 || i == 3);
    const auto& pose = sample.bodies[swapped ? 5 - i : i];
    if (state.lost_until > k || !pose) return false;
    geometry_msgs::PoseStamped message = pose_message(*pose, stamp(k));
    faults_["samples with labels exchanged"] += swapped;
    if (state.frozen_until > k) message.pose = state.frozen;
    if (state.ghost_until > k) message.pose.position.y += 0.3;
    bool counts = true;
    const double fault = std::uniform_real_distribution<double>()(random_);
    auto happened = [&, low = 0.0](const char* name, double probability) mutable {
      const bool hit = fault >= low && fault < low + probability;
      low += probability;
      if (hit) ++faults_[name];
      return hit;
    };
    if (happened("bodies lost for long", 1e-4)) {
      state.lost_until = k + between(20, 700);
      return false;
    }
    if (happened("bodies frozen", 1e-4)) {
      state.frozen = message.pose;
      state.frozen_until = k + between(60, 500);
    } else if (happened("ghosts", 2e-4)) {
      state.ghost_until = k + between(1, 10);
    } else if (happened("samples of NaN", 2e-3)) {
      message.pose.position.z = std::numeric_limits<double>::quiet_NaN();
    } else if (happened("samples of zero", 2e-3)) {
      message.pose.position = geometry_msgs::Point();
    } else if (happened("quaternions of zero", 2e-3)) {
      message.pose.orientation = geometry_msgs::Quaternion();
    } else if (happened("stamps of zero", 1e-3)) {
      message.header.stamp = ros::Time();
      counts = false;
    } else if (happened("samples twice", 5e-3)) {
      bodies_[i].publish(message);
    } else if (happened("samples late by a frame or more", 1e-3)) {
      late_.resize(bodies_.size());
      late_[i].push_back(message);
      return true;  // the instant exists: it comes, be it late
    }
    bodies_[i].publish(message);
    return counts;
  }

  ros::NodeHandle nh_;
  const RigTrial& trial_;
  ros::Time start_;
  std::mt19937_64 random_;
  std::vector<State> state_;
  std::vector<std::vector<geometry_msgs::PoseStamped>> late_;
  std::vector<ros::Publisher> bodies_, pressures_;
  ros::Publisher payload_;
  std::uint64_t sent_ = 0, pause_until_ = 0, swap_until_ = 0, silent_until_ = 0;
  std::map<std::string, std::uint64_t> faults_;
};

}  // namespace softarm::testing_long_run
