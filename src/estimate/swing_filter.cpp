#include "swing_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "math/distributions.h"
#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();
constexpr const Policy::Swing& kSwing = kPolicy.swing;

}  // namespace

SwingFilter::SwingFilter(const arm::Arm& arm) : length_m_(arm.total_length_m()), bodies_(arm.bodies.size()) {
  forget();
}

void SwingFilter::forget() {
  modes_ = model::Modes();
  reference_ = last_ = Matrix3Xd::Constant(3, static_cast<Index>(bodies_), kNotSeen);
  last_s_.reset();
  known_ = moving_ = false;
  moving_until_s_ = -1e300;
}

void SwingFilter::set_modes(const model::Modes& modes, double lag_s) {
  const Index r = modes.stiffness.size();
  std::optional<InModes> here;
  if (known_ && modes_.stiffness.size() == r) here = in_modes(last_, nullptr);
  if (here) {
    // Counted from where the bodies are now.
    reference_ += last_;
    last_ *= 0.0;  // what was not seen stays so
    state_.head(r) -= here->s;
    state_.tail(r) -= here->s;
    MatrixXd turn = MatrixXd::Zero(3 * r, 3 * r);
    for (Index k = 0; k < 3; ++k) turn.block(k * r, k * r, r, r) = modes.project * modes_.shape;
    state_ = turn * state_;
    covariance_ = turn * covariance_ * turn.transpose();
  } else {
    known_ = false;
  }
  modes_ = modes;
  damping_ = lag_s * modes.elastic;
  const Index n = modes.project.cols() / 3;
  by_gravity_ = modes.stiffness.cwiseInverse().asDiagonal() * modes.project *
                Eigen::Matrix3d::Identity().replicate(n, 1);
}

double SwingFilter::largest_m(Index mode) const {
  double most = 0.0;
  for (Index b = 0; b < static_cast<Index>(bodies_); ++b)
    most = std::max(most, modes_.bodies.block<3, 1>(3 * b, mode).norm());
  return std::max(most, 1e-9);
}

void SwingFilter::begin(const VectorXd& s) {
  const Index r = s.size();
  state_ = VectorXd::Zero(3 * r);
  state_.head(r) = state_.tail(r) = s;
  covariance_ = MatrixXd::Zero(3 * r, 3 * r);
  for (Index i = 0; i < r; ++i) {
    const double unknown = kSwing.unknown * length_m_ / largest_m(i);
    covariance_(i, i) = unknown * unknown;
    covariance_(r + i, r + i) = modes_.stiffness[i] * unknown * unknown;
    covariance_(2 * r + i, 2 * r + i) = unknown * unknown;
  }
  known_ = true;
}

void SwingFilter::predict(double dt_s, const VectorXd& moved) {
  const Index r = moved.size();
  MatrixXd f = MatrixXd::Zero(3 * r, 3 * r);
  VectorXd driven = VectorXd::Zero(3 * r);
  for (Index i = 0; i < r; ++i) {
    const model::Oscillator oscillator(modes_.stiffness[i], damping_[i], dt_s);
    const Index of[3] = {i, r + i, 2 * r + i};
    const model::Oscillator::State by[3] = {oscillator.step({1.0, 0.0}, 0.0, 0.0),
                                            oscillator.step({0.0, 1.0}, 0.0, 0.0),
                                            oscillator.step({0.0, 0.0}, 1.0, 1.0)};
    for (int k = 0; k < 3; ++k) {
      f(of[0], of[k]) = by[k].x;
      f(of[1], of[k]) = by[k].rate;
    }
    f(of[2], of[2]) = 1.0;
    const model::Oscillator::State on_the_way = oscillator.step({0.0, 0.0}, 0.0, moved[i]);
    driven[of[0]] = on_the_way.x;
    driven[of[1]] = on_the_way.rate;
    driven[of[2]] = moved[i];
  }
  const VectorXd d = beyond();
  const MatrixXd spread = covariance_beyond();
  state_ = f * state_ + driven;
  covariance_ = f * covariance_ * f.transpose();
  for (Index i = 0; i < r; ++i) {
    const double walk = kSwing.walk * length_m_ / largest_m(i), by_inputs = kSwing.inputs_rel * moved[i];
    covariance_(2 * r + i, 2 * r + i) += walk * walk * dt_s + by_inputs * by_inputs;
    // Of the spring, as if its error came and went.
    const double off = kSwing.spring_rel * modes_.stiffness[i];
    covariance_(r + i, r + i) += off * off * (d[i] * d[i] + spread(i, i)) * kSwing.spring_s * dt_s;
  }
}

std::optional<SwingFilter::InModes> SwingFilter::in_modes(const Matrix3Xd& displaced,
                                                          const WhiteNoise* noise) const {
  const Index r = modes_.stiffness.size();
  MatrixXd information = MatrixXd::Zero(r, r);
  VectorXd weighted = VectorXd::Zero(r);
  for (Index b = 0; b < displaced.cols(); ++b) {
    if (!displaced.col(b).allFinite()) continue;
    const auto shape = modes_.bodies.middleRows<3>(3 * b);
    const double weight = noise == nullptr ? 1.0 : 1.0 / noise->position_variance(static_cast<int>(b));
    information += weight * shape.transpose() * shape;
    weighted += weight * shape.transpose() * displaced.col(b);
  }
  const math::SymmetricSolver solver(information);
  if (!solver.ok() || !(solver.least_pivot() > kSwing.least_information * information.trace()))
    return std::nullopt;
  return InModes{solver.solve(weighted), solver.inverse()};
}

Matrix3Xd SwingFilter::displaced(const std::vector<Observation>& bodies) {
  Matrix3Xd list = Matrix3Xd::Constant(3, static_cast<Index>(bodies_), kNotSeen);
  for (const Observation& o : bodies) {
    const auto shape = modes_.bodies.middleRows<3>(3 * o.body);
    if (known_ && !reference_.col(o.body).allFinite())
      reference_.col(o.body) = o.p - shape * state_.head(shape.cols());
    if (!known_) reference_.col(o.body) = o.p;
    const Vector3d off = o.p - reference_.col(o.body);
    // One that jumps as no swing does is a wrong one.
    const Vector3d before = last_.col(o.body);
    const bool jumps = known_ && before.allFinite() && (off - before).norm() > kSwing.jump * length_m_;
    if (!jumps) list.col(o.body) = off;
    last_.col(o.body) = off;
  }
  return list;
}

void SwingFilter::update(const VectorXd& s, const MatrixXd& variance) {
  const Index r = s.size();
  const VectorXd off = s - state_.head(r);
  const MatrixXd expected = covariance_.topLeftCorner(r, r) + variance;
  const double surprise = off.dot(math::solve_symmetric(expected, off));
  static const double kLimit = math::chi_squared_upper_quantile(2.0, kSwing.by_chance);
  if (surprise > kLimit) {
    for (Index i = 0; i < r; ++i) {
      const double unknown = kSwing.unknown * length_m_ / largest_m(i);
      covariance_(2 * r + i, 2 * r + i) += unknown * unknown;
      covariance_(r + i, r + i) += modes_.stiffness[i] * unknown * unknown;
    }
    moving_ = true;
    moving_until_s_ = *last_s_ + M_PI / std::sqrt(modes_.stiffness.minCoeff());
  }
  const MatrixXd seen = covariance_.topLeftCorner(r, r) + variance;
  const MatrixXd gain =
      math::SymmetricSolver(seen).solve_columns(covariance_.topRows(r)).transpose();  // 3r x r
  state_ += gain * off;
  MatrixXd rest = MatrixXd::Identity(3 * r, 3 * r);
  rest.leftCols(r) -= gain;
  covariance_ = rest * covariance_ * rest.transpose() + gain * variance * gain.transpose();
}

void SwingFilter::add(double stamp_s, const std::vector<Observation>& bodies, const WhiteNoise& noise,
                      const Matrix3Xd& moved) {
  const bool again = last_s_ && *last_s_ == stamp_s;
  if (last_s_ && !again && !(stamp_s > *last_s_ && stamp_s - *last_s_ < kPolicy.window.longest_spacing_s))
    known_ = moving_ = false;
  const double dt_s = last_s_ ? stamp_s - *last_s_ : 0.0;
  last_s_ = stamp_s;
  if (!has_modes() || again) return;
  if (!known_) {
    reference_.setConstant(kNotSeen);
    last_.setConstant(kNotSeen);
  } else {
    const std::optional<InModes> g = moved.isZero(0.0) ? std::nullopt : in_modes(moved, nullptr);
    predict(dt_s, g ? g->s : VectorXd(VectorXd::Zero(modes_.stiffness.size())));
  }
  const std::optional<InModes> seen = in_modes(displaced(bodies), &noise);
  if (!seen) return;
  if (!known_) begin(seen->s);
  update(seen->s, seen->variance);
  judge(stamp_s);
}

VectorXd SwingFilter::beyond() const {
  const Index r = modes_.stiffness.size();
  return state_.head(r) - state_.tail(r);
}

VectorXd SwingFilter::most_probable() const {
  const VectorXd d = beyond();
  const double sure = d.dot(math::solve_symmetric(covariance_beyond(), d));
  return std::max(0.0, 1.0 - static_cast<double>(d.size()) / std::max(sure, 1e-12)) * d;
}

MatrixXd SwingFilter::covariance_beyond() const {
  const Index r = modes_.stiffness.size();
  return covariance_.topLeftCorner(r, r) + covariance_.bottomRightCorner(r, r) -
         covariance_.topRightCorner(r, r) - covariance_.bottomLeftCorner(r, r);
}

MatrixXd SwingFilter::root_beyond() const {
  return Eigen::LLT<MatrixXd>(covariance_beyond()).matrixL();
}

void SwingFilter::judge(double stamp_s) {
  const VectorXd d = beyond();
  static const double kLimit = math::chi_squared_upper_quantile(2.0, kSwing.by_chance);
  if (d.dot(math::solve_symmetric(covariance_beyond(), d)) > kLimit)
    moving_until_s_ = stamp_s + M_PI / std::sqrt(modes_.stiffness.minCoeff());
  moving_ = stamp_s < moving_until_s_;
}

Vector3d SwingFilter::gravity() const {
  if (!moving_ || !known_) return Vector3d::Zero();
  const MatrixXd square = by_gravity_ * by_gravity_.transpose();
  return by_gravity_.transpose() * math::solve_symmetric(square, most_probable());
}

MatrixXd SwingFilter::gravity_by_error() const {
  const Index r = modes_.stiffness.size();
  if (!moving_ || !known_) return MatrixXd::Zero(3, 0);
  const MatrixXd square = by_gravity_ * by_gravity_.transpose();
  MatrixXd root = root_beyond();
  for (Index i = 0; i < r; ++i) root.col(i) = math::solve_symmetric(square, root.col(i));
  return by_gravity_.transpose() * root;
}

Matrix3Xd SwingFilter::position_by_error(int body) const {
  if (!moving_ || !known_) return Matrix3Xd::Zero(3, 0);
  return modes_.bodies.middleRows<3>(3 * body) * root_beyond();
}

Matrix3Xd SwingFilter::tangent_by_error(int body) const {
  if (!moving_ || !known_) return Matrix3Xd::Zero(3, 0);
  return modes_.bodies.middleRows<3>(3 * (static_cast<Index>(bodies_) + body)) * root_beyond();
}

}  // namespace softarm::estimate
