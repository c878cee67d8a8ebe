// A clean recording of a simple arm, to be spoilt by tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "softarm/check/check.h"

namespace softarm::testing_check {

constexpr double kStart = 1000.0;
constexpr double kRate = 100.0;
constexpr double kSeconds = 20.0;
constexpr double kNoiseM = 2e-4;

/// Number of the frame at this time of the recording.
constexpr std::size_t at(double t_s) {
  return static_cast<std::size_t>(t_s * kRate);
}

/// Three rings and a base, hanging, driven by two opposed chambers.
inline arm::Arm hanging_arm() {
  arm::Arm arm;
  arm.name = "hanging";
  arm.base.body = "base";
  arm.segments.resize(1);
  arm::Segment& segment = arm.segments[0];
  segment.length_m = 0.2;
  segment.mass_per_length_kg_m = 0.1;
  segment.diameter_m = 0.04;
  segment.bending_stiffness.base_nm2 = 0.03;
  segment.length_range_m = {0.15, 0.25};
  for (int i = 0; i < 2; ++i) {
    const std::string name = "chamber_" + std::to_string(i + 1);
    segment.chambers.push_back({name, i * M_PI, 8e-6, 0.0, 0.0});
    arm::ScalarInput input;
    input.name = name;
    input.topic = "/pressure/" + name;
    input.type = "sensor_msgs/FluidPressure";
    arm.inputs.scalars.push_back(input);
  }
  for (int i = 0; i < 3; ++i) {
    arm::MeasuredBody body;
    body.name = "ring_" + std::to_string(i + 1);
    body.arclength_m = 0.2 * (i + 1) / 3.0;
    body.position_sd_m = kNoiseM;
    body.orientation_sd_rad = 0.01;
    body.orientation_usable = true;
    arm.bodies.push_back(body);
  }
  arm.payload.arclength_m = 0.2;
  return arm;
}

/// Gauge pressure: rest for a second at both ends, two quick cycles of unequal speed between.
inline double pressure_pa(int chamber, double t_s) {
  const double envelope = std::clamp(std::min(t_s - 1.0, kSeconds - 1.5 - t_s), 0.0, 1.0);
  const double phase = chamber == 0 ? 0.0 : 1.3;
  return 15e3 * envelope * envelope * (3.0 - 2.0 * envelope) *
         (1.0 + 0.5 * std::sin(1.9 * t_s + phase) + 0.45 * std::sin(0.7 * t_s - 2.0 * phase));
}

/// What drives an arm, and for how long: gauge pressure of a chamber at a time, before the beginning too.
struct Course {
  double seconds = kSeconds;
  std::function<double(int, double)> pressure_pa = testing_check::pressure_pa;
};

/// Base pose of the body `base`: z down along the arm.
inline Eigen::Isometry3d base_pose() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 1.0);
  pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

/// @param lag_s the arm answers so much later than its inputs
inline trial::CheckRecording clean(unsigned seed = 1, double lag_s = 0.0, const Course& course = {}) {
  const arm::Arm arm = hanging_arm();
  trial::CheckRecording recording;
  recording.name = "clean";
  recording.bodies.resize(4);
  recording.inputs.resize(2);
  for (int b = 0; b < 4; ++b) {
    const std::string name = b == 0 ? "base" : arm.bodies[static_cast<std::size_t>(b - 1)].name;
    recording.topics.push_back({"/mocap/" + name + "/pose", "geometry_msgs/PoseStamped", name,
                                "geometry_msgs/PoseStamped", 2000, true, false, b == 0});
  }
  recording.topics.push_back(
      {"/payload", "std_msgs/Float64", "payload", "std_msgs/Float64", 1, false, true, false});
  recording.payload.push_back({kStart, kStart, 0.0});
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto normal3 = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  for (int k = 0; k < static_cast<int>(course.seconds * kRate); ++k) {
    const double t = k / kRate, stamp = kStart + t;
    const double kappa = 2.0e-4 * (course.pressure_pa(0, t - lag_s) - course.pressure_pa(1, t - lag_s));
    for (int b = 0; b < 4; ++b) {
      const double s = b == 0 ? 0.0 : arm.bodies[static_cast<std::size_t>(b - 1)].arclength_m;
      const double angle = kappa * s;
      const double small = std::abs(angle) < 1e-6 ? 0.5 * angle * s : (1.0 - std::cos(angle)) / kappa;
      const double along = std::abs(angle) < 1e-6 ? s : std::sin(angle) / kappa;
      Eigen::Isometry3d section = Eigen::Isometry3d::Identity();
      section.translation() = Eigen::Vector3d(small, 0.0, along);
      section.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
      const Eigen::Isometry3d pose = base_pose() * section;
      const Eigen::Vector3d turn = (b == 0 ? 3e-4 : 5e-3) * normal3();
      const Eigen::Quaterniond q(Eigen::Quaterniond(pose.linear()) *
                                 Eigen::AngleAxisd(turn.norm(), turn.normalized()));
      recording.bodies[static_cast<std::size_t>(b)].push_back(
          {stamp, stamp, pose.translation() + (b == 0 ? 0.1 : 1.0) * kNoiseM * normal3(), q});
    }
    if (k % 2 == 0) {
      for (int i = 0; i < 2; ++i) {
        recording.inputs[static_cast<std::size_t>(i)].push_back(
            {stamp, stamp, 101325.0 + course.pressure_pa(i, t)});
      }
    }
    if (k % 10 == 0) {
      trial::Frame frame;
      frame.stamp_ns = trial::to_nanoseconds(stamp);
      const trial::RecordedPose& base = recording.bodies[0].back();
      frame.base_body = Eigen::Translation3d(base.p_mocap) * *base.q_mocap;
      for (int b = 1; b < 4; ++b) {
        const trial::RecordedPose& body = recording.bodies[static_cast<std::size_t>(b)].back();
        frame.bodies.push_back({b - 1, body.p_mocap, body.q_mocap});
      }
      frame.payload_kg = 0.0;
      recording.frames.push_back(frame);
    }
  }
  return recording;
}

inline const check::CheckFinding* find(const check::CheckReport& report, const std::string& id,
                                       const std::string& where = "") {
  for (const check::CheckFinding& f : report.findings) {
    if (f.id == id && (where.empty() || f.where.find(where) != std::string::npos)) return &f;
  }
  return nullptr;
}

/// Ids and places of all that is more than information: for messages of failing tests.
inline std::string complaints(const check::CheckReport& report) {
  std::string text;
  for (const check::CheckFinding& f : report.findings) {
    if (f.severity != check::Severity::kInformation) text += f.id + " " + f.where + ": " + f.what + "\n";
  }
  return text;
}

}  // namespace softarm::testing_check
