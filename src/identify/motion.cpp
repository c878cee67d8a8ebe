#include "motion.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include "math/linear_algebra.h"
#include "model/inertia.h"

namespace softarm::identify {
namespace {

constexpr double kHalfSpan_s = 0.15;  // of a parabola: half a swing of a soft arm
constexpr int kFewest = 6;            // frames in it, and some on either side
constexpr double kOpenLag = 0.5;

struct Parabola {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), acceleration = Eigen::Vector3d::Zero();
};

const trial::SeenBody* seen(const trial::StaticFrame& frame, int body) {
  const auto found = std::find_if(frame.bodies.begin(), frame.bodies.end(),
                                  [&](const trial::SeenBody& b) { return b.body == body; });
  return found == frame.bodies.end() ? nullptr : &*found;
}

/// Of one body about a time.
Parabola parabola(const std::vector<trial::StaticFrame>& all, double stamp_s, int body) {
  const auto first =
      std::lower_bound(all.begin(), all.end(), stamp_s - kHalfSpan_s,
                       [](const trial::StaticFrame& frame, double at_s) { return frame.stamp_s < at_s; });
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> places;
  for (auto frame = first; frame != all.end() && frame->stamp_s <= stamp_s + kHalfSpan_s; ++frame) {
    const trial::SeenBody* there = seen(*frame, body);
    if (there == nullptr) continue;
    t_s.push_back(frame->stamp_s - stamp_s);
    places.push_back(there->p_base);
  }
  const auto count = static_cast<Eigen::Index>(t_s.size());
  if (count < kFewest || t_s.front() > -0.5 * kHalfSpan_s || t_s.back() < 0.5 * kHalfSpan_s) return {};
  Eigen::MatrixXd powers(count, 3), p(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = t_s[static_cast<std::size_t>(k)];
    powers.row(k) << 1.0, t, 0.5 * t * t;
    p.row(k) = places[static_cast<std::size_t>(k)].transpose();
  }
  const Eigen::Matrix3d fit = math::least_squares_columns(powers, p);
  return {fit.row(1).transpose(), fit.row(2).transpose()};
}

}  // namespace

double open_lag_s(const arm::Arm& arm) {
  double sum_s = 0.0;
  for (const arm::Segment& segment : arm.segments)
    sum_s += segment.length_m * segment.wall.lag_s.value_or(arm::Wall::kUsualLag_s);
  return kOpenLag * sum_s / arm.total_length_m();
}

std::vector<FrameMotion> motion_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                   const std::vector<trial::StaticFrame>& frames) {
  double own_kg = 0.0;
  for (const arm::Segment& segment : arm.segments) own_kg += segment.mass_per_length_kg_m * segment.length_m;
  std::map<std::size_t, std::vector<trial::StaticFrame>> all;
  std::vector<FrameMotion> motion;
  for (const trial::StaticFrame& frame : frames) {
    auto known = all.find(frame.trial);
    if (known == all.end()) {
      std::map<std::string, std::uint64_t> left_out;
      known = all.emplace(frame.trial, trial::known_frames(arm, frame.trial, trials[frame.trial], left_out,
                                                           trial::InputsOf::kFrames))
                  .first;
    }
    FrameMotion made;
    made.velocity = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(frame.bodies.size()));
    double farthest_m = -1.0;
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const Parabola course = parabola(known->second, frame.stamp_s, frame.bodies[k].body);
      made.velocity.col(static_cast<Eigen::Index>(k)) = course.velocity;
      const double arclength_m = arm.bodies[static_cast<std::size_t>(frame.bodies[k].body)].arclength_m;
      if (arclength_m <= farthest_m) continue;
      farthest_m = arclength_m;
      const double end_kg = arm.tip_mass_kg + frame.payload_kg;
      made.gravity = -model::inertia_over_weight(own_kg, end_kg) * course.acceleration;
    }
    motion.push_back(std::move(made));
  }
  return motion;
}

}  // namespace softarm::identify
