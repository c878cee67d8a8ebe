#include "shape_mixer.h"

#include <Eigen/Dense>
#include <algorithm>

#include "math/linear_algebra.h"

namespace softarm::model {
namespace {

rod::RodState mix(const std::vector<const rod::RodState*>& states, const Eigen::VectorXd& weights) {
  rod::RodState out = *states.back();
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  out.p.setZero();
  out.n.setZero();
  out.m.setZero();
  out.u.setZero();
  out.v.setZero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    const rod::RodState& a = *states[i];
    out.p += w * a.p;
    out.n += w * a.n;
    out.m += w * a.m;
    out.u += w * a.u;
    out.v += w * a.v;
    const double sign = a.q.coeffs().dot(states.back()->q.coeffs()) < 0.0 ? -1.0 : 1.0;
    q += sign * w * a.q.coeffs();
  }
  out.q.coeffs() = q.normalized();
  return out;
}

/// Sum of shapes, the weights' sum being 1.
Shape mix(const std::vector<Shape>& shapes, const Eigen::VectorXd& weights) {
  Shape out = shapes.back();
  std::vector<const rod::RodState*> states(shapes.size());
  for (std::size_t k = 0; k < out.middles.size(); ++k) {
    for (std::size_t i = 0; i < shapes.size(); ++i) states[i] = &shapes[i].middles[k];
    out.middles[k] = mix(states, weights);
  }
  for (std::size_t k = 0; k < out.stations.size(); ++k) {
    for (std::size_t i = 0; i < shapes.size(); ++i) states[i] = &shapes[i].stations[k];
    out.stations[k] = mix(states, weights);
  }
  out.base_moment_nm.setZero();
  out.base_force_n.setZero();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    out.base_moment_nm += w * shapes[i].base_moment_nm;
    out.base_force_n += w * shapes[i].base_force_n;
  }
  return out;
}

}  // namespace

Eigen::VectorXd difference_m(const Shape& a, const Shape& b) {
  Eigen::VectorXd d(3 * static_cast<Eigen::Index>(a.stations.size()));
  for (std::size_t k = 0; k < a.stations.size(); ++k)
    d.segment<3>(3 * static_cast<Eigen::Index>(k)) = a.stations[k].p - b.stations[k].p;
  return d;
}

bool ShapeMixer::next(const Shape& assumed, const Shape* followed, Shape& out) {
  const Eigen::VectorXd error =
      followed != nullptr ? difference_m(*followed, assumed) : Eigen::VectorXd(Eigen::VectorXd::Zero(1));
  const double size = error.lpNorm<Eigen::Infinity>();
  if (followed == nullptr || (best_ && size > kWorse * least_)) {
    // Back to the best, and a smaller step from there.
    if (!best_ || ++resets_ > kMostResets) return false;
    share_ *= 0.2;
    assumed_ = {best_->first};
    followed_ = {best_->second};
    errors_ = {difference_m(best_->second, best_->first)};
  } else {
    if (!best_ || size < least_) {
      best_.emplace(assumed, *followed);
      least_ = size;
    }
    assumed_.push_back(assumed);
    followed_.push_back(*followed);
    errors_.push_back(error);
    if (errors_.size() > kHistory) {
      assumed_.erase(assumed_.begin());
      followed_.erase(followed_.begin());
      errors_.erase(errors_.begin());
    }
  }
  const auto count = static_cast<Eigen::Index>(errors_.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);
  weights[count - 1] = 1.0;
  if (count > 1) {
    Eigen::MatrixXd steps(errors_.back().size(), count - 1);
    for (Eigen::Index i = 0; i + 1 < count; ++i)
      steps.col(i) = errors_[static_cast<std::size_t>(i)] - errors_.back();
    const Eigen::VectorXd w = math::least_squares(steps, -errors_.back(), kAlike);
    if (w.allFinite() && w.lpNorm<Eigen::Infinity>() < kMostWeight) {
      weights.head(count - 1) = w;
      weights[count - 1] = 1.0 - w.sum();
    }
  }
  std::vector<Shape> shapes = assumed_;
  shapes.insert(shapes.end(), followed_.begin(), followed_.end());
  Eigen::VectorXd both(2 * count);
  both << (1.0 - share_) * weights, share_ * weights;
  out = mix(shapes, both);
  return true;
}

}  // namespace softarm::model
