#include "monitor_reference.h"

#include <algorithm>
#include <cmath>

#include "policy.h"

namespace softarm::monitor {
namespace {

constexpr int kPerSegment = 7;
constexpr int kFreePerSegment = 4;
constexpr double kUnseen_m2 = 1.0;  // variance of what is not seen: any

}  // namespace

SlowReference::SlowReference(const arm::Arm& arm, double memory_s, double position_sd_m)
    : arm_(arm),
      memory_s_(memory_s),
      noise_m_(position_sd_m),
      floor_m2_(std::pow(kPolicy.expected.floor * arm.total_length_m(), 2) +
                std::pow(kPolicy.expected.floor_noise * position_sd_m, 2)) {
  const auto segments = static_cast<Eigen::Index>(arm.segments.size());
  const auto rows = static_cast<Eigen::Index>(3 * arm.bodies.size());
  const Eigen::Index states = segments * kPerSegment + 1 + rows;
  prior_sd_.resize(states);
  const arm::LawPrior& prior = arm.estimator.prior;
  for (Eigen::Index i = 0; i < segments; ++i) {
    prior_sd_.segment<kPerSegment>(kPerSegment * i) << prior.moment_sd_nm, prior.moment_sd_nm,
        std::hypot(kPolicy.laws.gain, prior.moment_sd_rel), kPolicy.laws.turn_rad,
        prior.bending_stiffness_sd_rel, prior.length_sd_m, kPolicy.laws.length_per_nm * arm.total_length_m();
  }
  prior_sd_[segments * kPerSegment] = kPolicy.laws.lag_s;
  prior_sd_.tail(rows).setConstant(kPolicy.laws.offset * noise_m_);
  jacobian_.resize(rows, states);
  column_.resize(rows);
  free_.resize(rows, segments * kFreePerSegment + 1);
  reset();
}

void SlowReference::reset() {
  state_.setZero(prior_sd_.size());
  covariance_.setIdentity(prior_sd_.size(), prior_sd_.size());
  learned_s_ = 0.0;
  noise_ = Eigen::MatrixXd::Identity(jacobian_.rows(), jacobian_.rows()) *
           std::pow(kPolicy.expected.at_first * noise_m_, 2);
  jacobian_.setZero();
  velocity_.setZero(jacobian_.rows());
  law_change_.setZero(jacobian_.rows());
  free_columns_ = 0;
}

void SlowReference::set_shape(const MonitorShape& shape,
                              const std::vector<arm::SegmentPrediction>* predictions,
                              const std::vector<arm::SegmentPrediction>& before,
                              const Displacements& velocity, bool payload_is_free) {
  const auto segments = static_cast<Eigen::Index>(arm_.segments.size());
  jacobian_.setZero();
  free_columns_ = 0;
  law_change_.setZero();
  const double free_curvature_per_m = kPolicy.laws.free_curvature / arm_.total_length_m();
  for (Eigen::Index i = 0; i < segments; ++i) {
    const int segment = static_cast<int>(i);
    auto x = jacobian_.col(kPerSegment * i), y = jacobian_.col(kPerSegment * i + 1);
    auto flexibility = jacobian_.col(kPerSegment * i + 4), length = jacobian_.col(kPerSegment * i + 5);
    // Towards phi = 0 an arm bends about +y, towards 90 degrees about -x.
    shape.by_curvature(segment, 1, x);
    shape.by_curvature(segment, 0, y);
    y = -y;
    shape.by_flexibility(segment, flexibility);
    shape.by_length(segment, length);
    if (!predictions) {
      free_.col(free_columns_++) = free_curvature_per_m * x;
      free_.col(free_columns_++) = free_curvature_per_m * y;
      free_.col(free_columns_++) = kPolicy.laws.free_flexibility * flexibility;
      free_.col(free_columns_++) = kPolicy.laws.free_length * arm_.total_length_m() * length;
      jacobian_.middleCols(kPerSegment * i, kPerSegment).setZero();
      continue;
    }
    const arm::SegmentPrediction& law = (*predictions)[static_cast<std::size_t>(i)];
    const double k = law.length_m / arm_.segments[static_cast<std::size_t>(i)].length_m;
    const double per_moment = k / law.bending_stiffness_nm2;
    const Eigen::Vector2d curvature = k * (law.moment_nm / law.bending_stiffness_nm2 + law.curvature_per_m);
    jacobian_.col(kPerSegment * i + 2) = curvature.x() * x + curvature.y() * y;
    jacobian_.col(kPerSegment * i + 3) = -curvature.y() * x + curvature.x() * y;
    flexibility += k / law.bending_stiffness_nm2 * (law.moment_nm.x() * x + law.moment_nm.y() * y);
    jacobian_.col(kPerSegment * i + 6) = law.actuation_nm().norm() * length;
    x *= per_moment;
    y *= per_moment;
    if (i < static_cast<Eigen::Index>(before.size())) {
      const arm::SegmentPrediction& was = before[static_cast<std::size_t>(i)];
      const Eigen::Vector2d change = law.moment_nm - was.moment_nm +
                                     law.bending_stiffness_nm2 * (law.curvature_per_m - was.curvature_per_m);
      law_change_ += change.x() * x + change.y() * y + (law.length_m - was.length_m) * length +
                     std::log(was.bending_stiffness_nm2 / law.bending_stiffness_nm2) * flexibility;
    }
  }
  if (predictions) jacobian_.col(segments * kPerSegment) = -velocity;
  for (int body = 0; body < shape.bodies(); ++body) {
    jacobian_.block<3, 3>(3 * body, segments * kPerSegment + 1 + 3 * body) = shape.section(body);
  }
  jacobian_ *= prior_sd_.asDiagonal();
  velocity_ = velocity;
  if (!predictions) velocity_.setZero();
  if (predictions && payload_is_free) {
    shape.by_payload(column_);
    free_.col(free_columns_++) = (arm_.payload.range_kg.high + kPolicy.laws.free_payload_kg) * column_;
  }
}

const math::CholeskyFactor& SlowReference::innovation_covariance(const std::vector<char>& usable,
                                                                 const Displacements& inertia) {
  work_.noalias() = jacobian_ * covariance_;
  total_ = noise_;
  total_.noalias() += work_ * jacobian_.transpose();
  total_.diagonal().array() += floor_m2_;
  column_.noalias() = jacobian_ * state_;
  allow(kPolicy.expected.correction_share);
  column_ = velocity_;
  allow(kPolicy.expected.lag_jitter_s);
  column_ = law_change_;
  allow(kPolicy.expected.law_change_share);
  column_ = inertia;
  allow(kPolicy.expected.inertia_share);
  expected_m2_ = total_.trace();
  if (free_columns_ > 0) {
    total_.noalias() += free_.leftCols(free_columns_) * free_.leftCols(free_columns_).transpose();
  }
  for (std::size_t i = 0; i < usable.size(); ++i) {
    if (!usable[i]) total_.diagonal().segment<3>(static_cast<Eigen::Index>(3 * i)).array() += kUnseen_m2;
  }
  factor_.compute(total_);
  return factor_;
}

void SlowReference::allow(double share) {
  // As it is, less or more, and a little of it in any direction.
  total_.noalias() += (share * share) * (column_ * column_.transpose());
  total_.diagonal().array() += (kPolicy.expected.any_direction * share * share) * column_.array().square();
}

void SlowReference::update(const Displacements& innovation) {
  // A window far off is more likely something of the moment than the laws' error of a lifetime.
  const double far = factor_.whiten_vector(innovation).squaredNorm() / static_cast<double>(innovation.size());
  total_ += (kPolicy.expected.common * std::max(1.0, far / kPolicy.expected.outlier) - 1.0) * noise_;
  factor_.compute(total_);
  // work_ is J P.
  gain_ = factor_.solve_columns(work_);
  state_.noalias() += gain_.transpose() * innovation;
  covariance_.noalias() -= gain_.transpose() * work_;
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

void SlowReference::learn_noise(const Displacements& innovation, const std::vector<char>& usable,
                                double dt_s) {
  learned_s_ += dt_s;
  const double rate =
      std::min(1.0, dt_s / std::min(kPolicy.expected.learn_s, kPolicy.expected.first_weight_s + learned_s_));
  double seen = 0.0;
  for (const char is_usable : usable) seen += is_usable ? 3.0 : 0.0;
  const double far = factor_.whiten_vector(innovation).squaredNorm();
  // Of what is off only the share that nothing else accounts for is noise.
  const double own = noise_.trace() + floor_m2_ * static_cast<double>(noise_.rows());
  const double share = std::sqrt(own / std::max(own, expected_m2_));
  const double weight = rate * share * std::min(1.0, kPolicy.expected.outlier * seen / std::max(1e-9, far));
  // Row by row and column by column: what is not seen keeps its own, and the whole stays a covariance.
  for (std::size_t i = 0; i < usable.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    column_.segment<3>(row).setZero();
    if (!usable[i]) continue;
    column_.segment<3>(row) = innovation.segment<3>(row);
    noise_.middleRows<3>(row) *= std::sqrt(1.0 - rate);
    noise_.middleCols<3>(row) *= std::sqrt(1.0 - rate);
  }
  noise_.noalias() += weight * column_ * column_.transpose();
}

void SlowReference::age(double dt_s) {
  // Information counts less with time; the prior's own does not.
  const double keep = std::exp(-dt_s / memory_s_);
  information_ = math::inverse_of_symmetric(covariance_) * keep;
  // With it the state goes back to the prior's where nothing is seen of it. Else it would wander off there.
  column_of_states_.noalias() = information_ * state_;
  information_.diagonal().array() += 1.0 - keep;
  covariance_ = math::inverse_of_symmetric(information_);
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  state_.noalias() = covariance_ * column_of_states_;
}

void SlowReference::doubt(double share) {
  // A step of a process whose stationary distribution is the prior: what is doubted often does not go astray.
  covariance_ *= 1.0 - share;
  covariance_.diagonal().array() += share;
  state_ *= std::sqrt(1.0 - share);
}

}  // namespace softarm::monitor
