// Trials of arms whose constants are known, made with the rod.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "softarm/arm/arm_file.h"
#include "softarm/identify/identify.h"
#include "softarm/rod/solver.h"

namespace softarm::identify::testing {

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

inline bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

inline Eigen::Vector3d normal3(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

inline Eigen::Isometry3d hanging() {
  return Eigen::Isometry3d(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0));
}
inline Eigen::Isometry3d standing() {
  return Eigen::Isometry3d::Identity();
}
inline Eigen::Isometry3d horizontal() {
  return Eigen::Isometry3d(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
}

inline arm::Arm shipped(const std::string& name) {
  return arm::load_arm_file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/" + name + ".yaml");
}

/// The semi-physical paper's arm, its elongations a tenth of the printed ones (which would double its length)
/// and a constant added to a chamber that the paper finds to be zero.
inline arm::Arm pneumatic_arm() {
  arm::Arm arm = shipped("semi_physical_200mm");
  for (arm::Chamber& chamber : arm.segments[0].chambers) {
    chamber.near_elongation_m_per_pa *= 0.1;
    chamber.far_elongation_m_per_pa *= 0.1;
  }
  return arm;
}

/// Makes frames of an arm as its motion capture would see them.
class FrameMaker {
 public:
  explicit FrameMaker(const arm::Arm& arm)
      : arm_(arm), rod_(rod::make_rod(arm)), solver_(rod_, stations(arm), {}) {}

  /// Nothing where the arm has no stable equilibrium or its tip bends beyond 150 degrees.
  std::optional<trial::Frame> make(const arm::InputValues& inputs, double payload_kg,
                                   const Eigen::Isometry3d& rod_base) {
    return make_lagging(inputs, payload_kg, rod_base, Eigen::Vector3d::Zero());
  }

  /// @param lag curvature (x, y) and length of the first segment that are still to come
  std::optional<trial::Frame> make_lagging(const arm::InputValues& inputs, double payload_kg,
                                           const Eigen::Isometry3d& rod_base, const Eigen::Vector3d& lag) {
    auto laws = predict(arm_, inputs);
    if (!laws) return std::nullopt;
    laws->front().curvature_per_m -= lag.head<2>();
    laws->front().length_m -= lag.z();
    rod::actuate(arm_, *laws, rod_);
    for (std::size_t i = 0; i < arm_.segments.size(); ++i)
      rod_.segments[i].rest_curvature_per_m = arm_.segments[i].rest_curvature_per_m;
    rod_.loads[rod::kPayloadLoad].mass_kg = payload_kg;
    rod_.p_base = rod_base.translation();
    rod_.q_base = Eigen::Quaterniond(rod_base.linear());
    if (solver_.solve(rod_) != rod::SolveStatus::kConverged || !solver_.stable()) return std::nullopt;
    const rod::RodState tip = solver_.at(rod_.rest_length_m());
    if ((rod_.q_base.conjugate() * tip.q * Eigen::Vector3d::UnitZ()).z() < std::cos(2.6)) return std::nullopt;
    trial::Frame frame;
    frame.inputs = inputs;
    frame.payload_kg = payload_kg;
    frame.base_body = rod_base * arm_.base.rod_in_body.inverse();
    for (int i = 0; i < static_cast<int>(arm_.bodies.size()); ++i) {
      const arm::MeasuredBody& body = arm_.bodies[static_cast<std::size_t>(i)];
      const rod::RodState& at = solver_.station(i);
      trial::BodyObservation seen;
      seen.body = i;
      if (body.kind == arm::BodyKind::kRing) {
        Eigen::Isometry3d section = Eigen::Isometry3d(at.q);
        section.translation() = at.p;
        const Eigen::Isometry3d pose = section * body.section_in_body.inverse();
        seen.p_mocap = pose.translation();
        seen.q_mocap = Eigen::Quaterniond(pose.linear());
      } else {
        seen.p_mocap = at.p + body.radius_m * (at.q * Eigen::Vector3d(std::cos(body.angle_rad),
                                                                      std::sin(body.angle_rad), 0.0));
      }
      frame.bodies.push_back(seen);
    }
    return frame;
  }

 private:
  static std::vector<double> stations(const arm::Arm& arm) {
    std::vector<double> list;
    for (const arm::MeasuredBody& body : arm.bodies) list.push_back(body.arclength_m);
    return list;
  }

  const arm::Arm arm_;
  rod::Rod rod_;
  rod::Solver solver_;
};

/// The frame with each body's stated noise on its position and, as a small turn, on its orientation.
inline trial::Frame with_noise(const arm::Arm& arm, trial::Frame frame, std::mt19937_64& random) {
  for (trial::BodyObservation& seen : frame.bodies) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
    seen.p_mocap += body.position_sd_m * normal3(random);
    if (!seen.q_mocap) continue;
    const Eigen::Vector3d turn = body.orientation_sd_rad * normal3(random);
    seen.q_mocap = *seen.q_mocap * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  return frame;
}

struct Protocol {
  int trials = 30;  ///< static conditions, each of them one trial
  int repeats = 1;  ///< frames of each load in a trial
  std::vector<double> payloads_kg{0.0, 0.2};
  std::function<arm::InputValues(std::mt19937_64&)> draw;
  Eigen::Isometry3d base = hanging();
};

/// The semi-physical paper's inputs: each chamber 10 to 50 kPa, off with 30 % chance; vacuum on or off.
inline arm::InputValues paper_inputs(std::mt19937_64& random) {
  arm::InputValues inputs;
  for (int i = 0; i < 3; ++i) {
    const double pressure = uniform(random, 10e3, 50e3);
    inputs.push_back(uniform(random, 0.0, 1.0) < 0.3 ? 0.0 : pressure);
  }
  inputs.push_back(uniform(random, 0.0, 1.0) < 0.5 ? 0.0 : 60e3);
  return inputs;
}

/// Trials of one static condition each under every payload; conditions without a stable shape are redrawn.
inline std::vector<trial::Trial> make_trials(const arm::Arm& truth, const Protocol& protocol,
                                             std::mt19937_64& random) {
  FrameMaker maker(truth);
  std::vector<trial::Trial> trials;
  while (static_cast<int>(trials.size()) < protocol.trials) {
    const arm::InputValues inputs = protocol.draw(random);
    trial::Trial trial;
    trial.name = "trial_" + std::to_string(trials.size() + 1);
    for (const double payload_kg : protocol.payloads_kg) {
      const auto frame = maker.make(inputs, payload_kg, protocol.base);
      if (!frame) break;
      for (int i = 0; i < protocol.repeats; ++i) {
        trial.frames.push_back(with_noise(truth, *frame, random));
        trial.frames.back().stamp_ns = trial::to_nanoseconds(2.0 * static_cast<double>(trial.frames.size()));
      }
    }
    if (trial.frames.size() == protocol.payloads_kg.size() * static_cast<std::size_t>(protocol.repeats))
      trials.push_back(std::move(trial));
  }
  return trials;
}

/// The arm with each of these constants changed by up to a share of its value.
inline arm::Arm perturbed(arm::Arm arm, const std::vector<identify::ConstantRef>& constants, double share,
                          std::mt19937_64& random) {
  for (const identify::ConstantRef& constant : constants)
    identify::set_value(arm, constant,
                        identify::value_of(arm, constant) * (1.0 + uniform(random, -share, share)));
  return arm;
}

inline const identify::Constant* find(const identify::Result& result, const std::string& name) {
  for (const identify::Constant& constant : result.constants) {
    if (constant.name == name) return &constant;
  }
  return nullptr;
}

}  // namespace softarm::identify::testing
