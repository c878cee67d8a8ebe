#include "window.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Numbers of newest frames that are held against the rest.
constexpr std::size_t kNewest[] = {2, 4, 8, 16, 32, 64};
// Information on a direction relative to its scale below which nothing is said of it.
constexpr double kNothing = 1e-10;

}  // namespace

Window::Window(double length_s, std::vector<int> changing)
    : length_s_(length_s),
      changing_(std::move(changing)),
      changed_(changing_.empty()
                   ? 0.0
                   : quantile(complement(boost::math::chi_squared(static_cast<double>(changing_.size())),
                                         kPolicy.window.change_probability))) {}

void Window::advance(double stamp_s) {
  while (!frames_.empty() && frames_.front().stamp_s < stamp_s - length_s_) frames_.pop_front();
  if (!frames_.empty() && frames_.back().stamp_s == stamp_s) frames_.pop_back();  // the same frame again
  if (!frames_.empty() && !(frames_.back().stamp_s < stamp_s)) frames_.clear();
  const double spacing = last_stamp_s_ ? stamp_s - *last_stamp_s_ : 0.0;
  if (spacing > 0.0 && spacing < kPolicy.window.longest_spacing_s) spacing_s_ = spacing;
  last_stamp_s_ = stamp_s;
}

Evidence Window::sum(std::size_t from, std::size_t to) const {
  Evidence total{MatrixXd::Zero(frames_.front().evidence.information.rows(),
                                frames_.front().evidence.information.cols()),
                 VectorXd::Zero(frames_.front().evidence.weighted.size())};
  double chi2 = 0.0;
  double dof = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    total.information += frames_[i].evidence.information;
    total.weighted += frames_[i].evidence.weighted;
    chi2 += frames_[i].misfit * frames_[i].degrees_of_freedom;
    dof += frames_[i].degrees_of_freedom;
  }
  // Misfit beyond the noise does not average out: it is the same error in every frame. With noise of variance
  // 1 and an error of variance k in all of n frames, n frames say as much as n / (1 + n k).
  const double expected =
      dof > 0.0 ? quantile(boost::math::chi_squared(dof), kPolicy.window.misfit_level) : 0.0;
  if (dof > 0.0 && chi2 > expected) {
    const double weight = 1.0 / (1.0 + static_cast<double>(to - from) * (chi2 - expected) / dof);
    total.information *= weight;
    total.weighted *= weight;
  }
  return total;
}

Evidence Window::belief(const VectorXd& law_information) const {
  Evidence belief{law_information.asDiagonal(), VectorXd::Zero(law_information.size())};
  if (frames_.empty()) return belief;
  const Evidence said = sum(0, frames_.size());
  belief.information += said.information;
  belief.weighted += said.weighted;
  return belief;
}

std::optional<VectorXd> Window::actuation_nm() const {
  if (frames_.empty()) return std::nullopt;
  VectorXd sum = VectorXd::Zero(frames_.front().actuation_nm.size());
  for (const Entry& entry : frames_) sum += entry.actuation_nm;
  return sum / static_cast<double>(frames_.size());
}

Eigen::Vector3d Window::tip_acceleration_m_s2() const {
  const double now = frames_.empty() ? 0.0 : frames_.back().stamp_s;
  std::vector<const Entry*> recent;
  for (const Entry& entry : frames_) {
    if (entry.stamp_s >= now - kPolicy.window.acceleration_s) recent.push_back(&entry);
  }
  const auto n = static_cast<Eigen::Index>(recent.size());
  if (n < kPolicy.window.acceleration_frames) return Eigen::Vector3d::Zero();
  // p = p0 + v t + a t^2 / 2 by least squares; its own residual gives its noise.
  Eigen::MatrixX3d t(n, 3), p(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double dt =
        recent[static_cast<std::size_t>(i)]->stamp_s - now + 0.5 * kPolicy.window.acceleration_s;
    t.row(i) << 1.0, dt, 0.5 * dt * dt;
    p.row(i) = recent[static_cast<std::size_t>(i)]->p_tip;
  }
  const Eigen::Matrix3d inverse = (t.transpose() * t).inverse();
  const Eigen::Matrix3d fit = inverse * (t.transpose() * p);
  const double variance = (p - t * fit).squaredNorm() / static_cast<double>(3 * (n - 3));
  const double noise = 3.0 * variance * inverse(2, 2), squared = fit.row(2).squaredNorm();
  if (!(squared > kPolicy.window.acceleration_chi2 * noise)) return Eigen::Vector3d::Zero();
  return std::sqrt(1.0 - noise / squared) * fit.row(2).transpose();
}

void Window::add(Entry entry) {
  if (!std::isfinite(entry.stamp_s) || !entry.evidence.information.allFinite() ||
      !entry.evidence.weighted.allFinite())
    return;
  frames_.push_back(std::move(entry));
}

bool Window::forget_before_change(const VectorXd& law_information) {
  const auto n = law_information.size();
  const auto m = static_cast<Eigen::Index>(changing_.size());
  if (m == 0) return false;
  // A frame may not contradict those before it by more than its own misfit allows, whatever the split: all
  // splits are tried, and the most improbable decides.
  std::size_t best = 0;
  double largest = changed_;
  for (const std::size_t newest : kNewest) {
    if (newest + 2 > frames_.size()) break;
    const std::size_t split = frames_.size() - newest;
    const Evidence before = sum(0, split), after = sum(split, frames_.size());
    // z of before; the newest frames' own is z + d on what may change.
    MatrixXd a = MatrixXd::Zero(n + m, n + m);
    VectorXd b = VectorXd::Zero(n + m);
    a.topLeftCorner(n, n) = before.information + after.information;
    a.topLeftCorner(n, n).diagonal() += law_information;
    b.head(n) = before.weighted + after.weighted;
    for (Eigen::Index i = 0; i < m; ++i) {
      const int ci = changing_[static_cast<std::size_t>(i)];
      a.col(n + i).head(n) = after.information.col(ci);
      a.row(n + i).head(n) = after.information.row(ci);
      for (Eigen::Index k = 0; k < m; ++k) {
        a(n + i, n + k) = after.information(ci, changing_[static_cast<std::size_t>(k)]);
      }
      b[n + i] = after.weighted[ci];
    }
    VectorXd scale(n + m);
    for (Eigen::Index i = 0; i < n + m; ++i) scale[i] = a(i, i) > 0.0 ? 1.0 / std::sqrt(a(i, i)) : 1.0;
    a = (scale.asDiagonal() * a * scale.asDiagonal()).eval();
    b = scale.cwiseProduct(b);
    // What nothing is said of stays where it is.
    a.diagonal().array() += kNothing;
    const math::SymmetricSolver with(a);
    const math::SymmetricSolver without(a.topLeftCorner(n, n));
    if (!with.ok() || !without.ok()) continue;
    const double gain = b.dot(with.solve(b)) - b.head(n).dot(without.solve(b.head(n)));
    if (gain > largest) {
      largest = gain;
      best = split;
    }
  }
  if (best == 0) return false;
  frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(best));
  return true;
}

}  // namespace softarm::estimate
