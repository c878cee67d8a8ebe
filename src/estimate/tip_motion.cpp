#include "tip_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "math/distributions.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

constexpr double kSwing_s = 2.0 * kPolicy.window.acceleration_s;
constexpr std::size_t kParabola = 3;  // frames that it goes through
constexpr double kShortest = 0.8;     // of the time over which it goes

}  // namespace

double TipMotion::span_s(double spacing_s) {
  return std::max(kPolicy.window.acceleration_s, (kParabola - 0.5) * spacing_s);
}

void TipMotion::forget() {
  path_.clear();
  accelerations_.clear();
}

void TipMotion::add(double stamp_s, const Eigen::Vector3d& p_tip) {
  if (!p_tip.allFinite()) return;
  if (!path_.empty() && path_.back().stamp_s == stamp_s) {  // the same frame again
    path_.pop_back();
    accelerations_.pop_back();
  }
  if (!path_.empty() && !(path_.back().stamp_s < stamp_s)) forget();
  path_.push_back({stamp_s, p_tip});
  accelerations_.push_back({stamp_s, newest()});
  while (path_.front().stamp_s < stamp_s - kSwing_s) {
    path_.pop_front();
    accelerations_.pop_front();
  }
}

Eigen::Vector3d TipMotion::newest() const {
  std::vector<const At*> recent;
  for (auto at = path_.rbegin(); at != path_.rend(); ++at) {
    const double age_s = path_.back().stamp_s - at->stamp_s;
    // Of a slow recording the newest few frames, if they are not much older.
    if (age_s > (recent.size() < kParabola ? kSwing_s : kPolicy.window.acceleration_s)) break;
    recent.push_back(&*at);
  }
  const auto n = static_cast<Eigen::Index>(recent.size());
  // Over a shorter time it is all noise.
  if (recent.size() < kParabola ||
      recent.front()->stamp_s - recent.back()->stamp_s < kShortest * kPolicy.window.acceleration_s)
    return Eigen::Vector3d::Zero();
  // p = p0 + v t + a t^2 / 2 by least squares; its own residual gives its noise.
  const double middle_s = 0.5 * (recent.front()->stamp_s + recent.back()->stamp_s);
  Eigen::MatrixX3d t(n, 3), p(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const At& at = *recent[static_cast<std::size_t>(i)];
    const double dt = at.stamp_s - middle_s;
    t.row(i) << 1.0, dt, 0.5 * dt * dt;
    p.row(i) = at.value;
  }
  const Eigen::Matrix3d inverse = (t.transpose() * t).inverse();
  const Eigen::Matrix3d fit = inverse * (t.transpose() * p);
  // Noise as it is stated, or less as the path shows; what no parabola follows of a swing is none.
  constexpr double kByChance = kPolicy.window.acceleration_by_chance;
  double variance = noise_sd_m_ * noise_sd_m_;
  double limit = math::chi_squared_upper_quantile(3.0, kByChance) / 3.0 * variance;
  if (const auto dof = static_cast<double>(3 * (n - 3)); dof > 0.0) {
    const double shown = (p - t * fit).squaredNorm() / dof;
    variance = std::min(variance, shown);
    limit = std::min(limit, math::f_upper_quantile(3.0, dof, kByChance) * shown);
  }
  const double of_fit = 3.0 * inverse(2, 2), squared = fit.row(2).squaredNorm(), noise = of_fit * variance;
  if (!(squared > of_fit * limit)) return Eigen::Vector3d::Zero();
  return std::sqrt(1.0 - noise / squared) * fit.row(2).transpose();
}

Eigen::Vector3d TipMotion::acceleration() const {
  return accelerations_.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : accelerations_.back().value;
}

Eigen::Vector3d TipMotion::acceleration_variance() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const At& at : accelerations_) sum += at.value.cwiseAbs2();
  return accelerations_.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(accelerations_.size()));
}

}  // namespace softarm::estimate
