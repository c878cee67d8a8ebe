// Frames for the benchmarks: those of the baselines where SOFTARM_FRAMES names them, else alike ones made
// here.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "softarm/arm/arm_file.h"
#include "softarm/rod/solver.h"
#include "softarm/trial/trial.h"

namespace softarm::bench {

inline arm::Arm paper_arm() {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
  std::stringstream text;
  text << file.rdbuf();
  arm::Arm arm = arm::parse_arm(text.str(), "online_200mm.yaml");
  arm.gravity_m_s2 = {0.0, 0.0, -9.81};
  return arm;
}

struct Truth {
  double moment = 0.3, phi = 0.5, stiffness = 0.03, length = 0.205, payload = 0.2;
};

/// The rod of the paper's arm with these values, in its base frame.
inline rod::Rod rod_of(const arm::Arm& arm, const Truth& t, const Eigen::Vector3d& gravity_base) {
  rod::Rod rod = rod::make_rod(arm);
  rod.gravity_m_s2 = gravity_base;
  rod.segments[0].length_m = t.length;
  rod.segments[0].bending_compliance = 1.0 / t.stiffness;
  rod.segments[0].moment_nm = t.moment * Eigen::Vector3d(-std::sin(t.phi), std::cos(t.phi), 0.0);
  rod.loads[rod::kPayloadLoad].mass_kg = t.payload;
  return rod;
}

inline Truth random_truth(std::mt19937_64& random) {
  const auto draw = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  return {draw(0.05, 0.6), draw(-M_PI, M_PI), draw(0.02, 0.06), draw(0.19, 0.22), draw(0.15, 0.24)};
}

/// A smooth motion through the shapes of the arm, at 120 Hz.
inline Truth moving_truth(int i) {
  const double t = i / 120.0;
  Truth truth;
  truth.moment = 0.3 - 0.2 * std::cos(2.0 * t);
  truth.phi = 0.5 + 2.0 * std::sin(0.7 * t);
  truth.stiffness = 0.035 + 0.01 * std::sin(0.9 * t);
  truth.length = 0.205 - 0.01 * std::cos(2.0 * t);
  return truth;
}

/// Frames of given truths with 0.5 mm of noise; the base at this attitude in mocap. Truths without
/// equilibrium or with a tip angle beyond 150 degrees are left out.
template <typename TruthOf>
std::vector<trial::Frame> make_frames(const arm::Arm& arm, int count, const Eigen::Quaterniond& q_base,
                                      TruthOf truth_of) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.0005);
  std::vector<double> stations;
  for (const arm::MeasuredBody& body : arm.bodies) stations.push_back(body.arclength_m);
  const Eigen::Vector3d gravity = q_base.conjugate() * arm.gravity_m_s2;
  rod::Solver solver(rod::make_rod(arm), stations, {});
  std::vector<trial::Frame> frames;
  for (int i = 0; static_cast<int>(frames.size()) < count; ++i) {
    const Truth truth = truth_of(i, random);
    if (solver.solve(rod_of(arm, truth, gravity)) != rod::SolveStatus::kConverged) continue;
    if ((solver.station(solver.stations() - 1).q * Eigen::Vector3d::UnitZ()).z() < std::cos(2.6)) continue;
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(i / 120.0);
    frame.base_body = Eigen::Isometry3d(q_base);
    frame.payload_kg = truth.payload;
    for (int k = 0; k < solver.stations(); ++k) {
      const Eigen::Vector3d error(noise(random), noise(random), noise(random));
      frame.bodies.push_back({k, q_base * solver.station(k).p + error, std::nullopt});
    }
    frames.push_back(frame);
  }
  return frames;
}

/// Hanging: the base's z axis points down.
inline Eigen::Quaterniond hanging() {
  return Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
}

/// The baselines' frames (base at the origin, tangent along +z, gravity along +z), or nothing.
inline std::vector<trial::Frame> read_frames(const std::string& path) {
  std::vector<trial::Frame> frames;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::stringstream row(line);
    double id, payload, weight, fraction[4];
    row >> id >> payload >> weight;
    for (double& f : fraction) row >> f;
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(id / 120.0);
    frame.base_body = Eigen::Isometry3d(hanging());
    frame.payload_kg = payload;
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector3d p;
      row >> p.x() >> p.y() >> p.z();
      frame.bodies.push_back({k, hanging() * p, std::nullopt});
    }
    if (row) frames.push_back(frame);
  }
  return frames;
}

inline std::vector<trial::Frame> random_frames(const arm::Arm& arm) {
  const char* path = std::getenv("SOFTARM_FRAMES");
  std::vector<trial::Frame> frames = path != nullptr ? read_frames(path) : std::vector<trial::Frame>();
  if (!frames.empty()) return frames;
  return make_frames(arm, 200, hanging(), [](int, std::mt19937_64& random) { return random_truth(random); });
}

/// Times of many calls, for their median and tail.
class Times {
 public:
  void add(double seconds) { seconds_.push_back(seconds); }
  /// @param fraction 0.5 for the median
  double quantile_us(double fraction) {
    std::sort(seconds_.begin(), seconds_.end());
    const auto i = static_cast<std::size_t>(fraction * static_cast<double>(seconds_.size() - 1));
    return seconds_.empty() ? 0.0 : 1e6 * seconds_[i];
  }

 private:
  std::vector<double> seconds_;
};

}  // namespace softarm::bench
