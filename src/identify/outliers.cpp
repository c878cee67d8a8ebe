// How far off a body must lie to be bounded, and to be dropped.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <vector>

#include "joint_fit.h"
#include "math/statistics.h"

namespace softarm::identify {
namespace {

constexpr double kMedianOfChi2 = 1.1774;  // of the distance of a tangent, in standard deviations
// More of a body's observations than the rest of this share are no outliers: the model is wrong there.
constexpr double kShareThatScales = 0.85;
constexpr double kShareOfChi3 = 2.3059, kShareOfChi2 = 1.9479;  // distances below which that share lies
constexpr std::size_t kFewestOfTrial = 5;  // observations of a body from which their trial has a scale
constexpr double kMisfitShare = 0.1;       // of a body's observations, to be said

/// The distance below which most of them lie; of few, all but one.
double most_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const std::size_t n = values.size();
  const auto share = static_cast<std::size_t>(kShareThatScales * static_cast<double>(n));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n < 2 ? 0 : std::min(share, n - 2));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double JointProblem::weight(const ResidualBlock& block, double squared_distance) const {
  if (!options_.robust) return 1.0;
  const int body = frames_[block.frame].bodies[static_cast<std::size_t>(block.body)].body;
  const double threshold = kHuber * scale_of(body, block.tangent);
  const double distance = std::sqrt(squared_distance);
  return distance > threshold ? threshold / distance : 1.0;
}

void JointProblem::measure_scales() {
  std::vector<double> position, tangent;
  std::map<int, std::vector<double>> by_body[2];
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!active_[i] || !solved_[i]) continue;
    for (std::size_t k = 0; k < frames_[i].bodies.size(); ++k) {
      const trial::SeenBody& seen = frames_[i].bodies[k];
      for (const bool is_tangent : {false, true}) {
        if (is_tangent && !seen.tangent_base) continue;
        const double distance = residual({i, static_cast<int>(k), is_tangent}).norm();
        by_body[is_tangent ? 1 : 0][seen.body].push_back(distance);  // those set aside as well
        if (seen.used) (is_tangent ? tangent : position).push_back(distance);
      }
    }
  }
  position_scale_ = std::max(1.0, math::median(position) / math::kMedianOfChi3);
  tangent_scale_ = std::max(1.0, math::median(tangent) / kMedianOfChi2);
  for (const int kind : {0, 1}) {
    body_scale_[kind].clear();
    for (const auto& [body, distances] : by_body[kind])
      body_scale_[kind][body] = most_of(distances) / (kind == 1 ? kShareOfChi2 : kShareOfChi3);
  }
}

double JointProblem::scale_of(int body, bool tangent) const {
  const double all = tangent ? tangent_scale_ : position_scale_;
  const auto own = body_scale_[tangent ? 1 : 0].find(body);
  return own == body_scale_[tangent ? 1 : 0].end() ? all : std::max(all, own->second);
}

/// An outlier lies off against the body's other observations, and those of its own trial: where a body is off
/// in many frames, or throughout a trial, that is the model's fault, not that of single frames.
/// @return whether another set of bodies is used now
bool JointProblem::set_outliers_aside() {
  std::map<std::tuple<std::size_t, int, bool>, std::vector<double>> by_trial;
  const auto each = [&](const auto& visit) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!active_[i] || !solved_[i]) continue;
      for (std::size_t k = 0; k < frames_[i].bodies.size(); ++k) visit(i, k, frames_[i].bodies[k]);
    }
  };
  const auto distance = [&](std::size_t i, std::size_t k, bool tangent) {
    return residual({i, static_cast<int>(k), tangent}).norm();
  };
  each([&](std::size_t i, std::size_t k, const trial::SeenBody& seen) {
    by_trial[{frames_[i].trial, seen.body, false}].push_back(distance(i, k, false));
    if (seen.tangent_base) by_trial[{frames_[i].trial, seen.body, true}].push_back(distance(i, k, true));
  });
  std::map<std::tuple<std::size_t, int, bool>, double> trial_scale;
  for (const auto& [which, distances] : by_trial) {
    if (distances.size() >= kFewestOfTrial)
      trial_scale[which] =
          math::median(distances) / (std::get<2>(which) ? kMedianOfChi2 : math::kMedianOfChi3);
  }
  bool changed = false;
  each([&](std::size_t i, std::size_t k, trial::SeenBody& seen) {
    const auto gross = [&](bool tangent) {
      const auto trial = trial_scale.find({frames_[i].trial, seen.body, tangent});
      const double scale =
          std::max(scale_of(seen.body, tangent), trial == trial_scale.end() ? 0.0 : trial->second);
      return distance(i, k, tangent) > kGross * scale;
    };
    const bool good = !gross(false) && !(seen.tangent_base && gross(true));
    changed = changed || good != seen.used;
    seen.used = good;
  });
  return changed;
}

std::map<int, std::uint64_t> JointProblem::beyond_the_model() const {
  std::map<int, std::uint64_t> off, all;
  for (const ResidualBlock& block : blocks()) {
    if (block.tangent) continue;
    const int body = frames_[block.frame].bodies[static_cast<std::size_t>(block.body)].body;
    ++all[body];
    if (residual(block).norm() > kGross * position_scale_) ++off[body];
  }
  for (auto body = off.begin(); body != off.end();) {
    const bool many =
        static_cast<double>(body->second) > kMisfitShare * static_cast<double>(all[body->first]);
    body = many ? std::next(body) : off.erase(body);
  }
  return off;
}

}  // namespace softarm::identify
