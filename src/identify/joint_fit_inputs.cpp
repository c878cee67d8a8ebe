// Errors of inputs in the fit of all frames.
#include <algorithm>
#include <cmath>

#include "joint_fit.h"
#include "math/linear_algebra.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kScaleSteps = 20;  // of misfit and weights, which follow each other
constexpr double kScaleSettled = 0.01;
constexpr double kInputSettled = 0.02;  // change of an input's noise, in its sd, that needs no other pass

}  // namespace

void JointProblem::add(SensorErrors errors) {
  if (!errors.any()) return;
  errors_ = std::move(errors);
  for (const trial::StaticFrame& frame : frames_) {
    inputs_.emplace_back(frame, errors_.noise_sd.row(static_cast<Eigen::Index>(frame.trial)).transpose(),
                         errors_.zero_sd);
    zeros_[frame.trial] = VectorXd::Zero(errors_.zero_sd.size());
  }
  if (!has_zeros()) zeros_.clear();
  reduced_.resize(frames_.size());
}

VectorXd JointProblem::rows(std::size_t i) const {
  const trial::StaticFrame& frame = frames_[i];
  VectorXd rows = VectorXd::Zero(static_cast<Eigen::Index>(6 * frame.bodies.size()));
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const auto body = static_cast<int>(k);
    const trial::SeenBody& seen = frame.bodies[k];
    rows.segment<3>(6 * body) = (predictions_[i].p.col(body) - seen.p_base) / sd({i, body, false});
    if (seen.tangent_base)
      rows.segment<3>(6 * body + 3) =
          (predictions_[i].tangent.col(body) - *seen.tangent_base) / sd({i, body, true});
  }
  return rows;
}

MatrixXd JointProblem::rows_by_x(std::size_t i) const {
  const trial::StaticFrame& frame = frames_[i];
  MatrixXd rows = MatrixXd::Zero(static_cast<Eigen::Index>(6 * frame.bodies.size()), scale_.size());
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const auto body = static_cast<int>(k);
    rows.middleRows(6 * body, 3) =
        predictions_[i].dp.middleRows(3 * body, 3) * scale_.asDiagonal() / sd({i, body, false});
    if (frame.bodies[k].tangent_base)
      rows.middleRows(6 * body + 3, 3) =
          predictions_[i].dtangent.middleRows(3 * body, 3) * scale_.asDiagonal() / sd({i, body, true});
  }
  return rows;
}

void JointProblem::predict_motion() {
  by_motion_.clear();
  if (motion_.empty()) return;
  const double lag_s = open_lag_s(arm_);
  Prediction heavier;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    trial::StaticFrame frame = inputs_.empty() ? frames_[i] : inputs_[i].frame();
    MatrixXd rows = MatrixXd::Zero(static_cast<Eigen::Index>(6 * frame.bodies.size()), 2);
    std::optional<model::Equilibrium> equilibrium = equilibria_[i];
    Prediction as_is;
    // Both without what line_ adds: it is alike in the two.
    const bool solved = solved_[i] && model_.predict(frame, equilibrium, as_is);
    frame.gravity_base += motion_[i].gravity;
    if (solved && model_.predict(frame, equilibrium, heavier)) {
      for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
        const auto body = static_cast<int>(k);
        rows.block<3, 1>(6 * body, 0) = (heavier.p.col(body) - as_is.p.col(body)) / sd({i, body, false});
        rows.block<3, 1>(6 * body, 1) = lag_s * motion_[i].velocity.col(body) / sd({i, body, false});
        if (frame.bodies[k].tangent_base)
          rows.block<3, 1>(6 * body + 3, 0) =
              (heavier.tangent.col(body) - as_is.tangent.col(body)) / sd({i, body, true});
      }
    }
    by_motion_.push_back(rows);
  }
}

MatrixXd JointProblem::by_motion(const ResidualBlock& block) const {
  if (by_motion_.empty()) return MatrixXd(3, 0);
  const int row = 6 * block.body + (block.tangent ? 3 : 0);
  const MatrixXd& rows = by_motion_[block.frame];
  return inputs_.empty() ? MatrixXd(rows.middleRows(row, 3))
                         : MatrixXd(inputs_[block.frame].whitening().middleRows(row, 3) * rows);
}

/// The whitened residual of a frame that was predicted.
void JointProblem::reduce(std::size_t i) {
  if (inputs_.empty()) return;
  const auto zero = zeros_.find(frames_[i].trial);
  const VectorXd none = VectorXd::Zero(errors_.zero_sd.size());
  reduced_[i] =
      inputs_[i].whitening() * inputs_[i].reduced(rows(i), zero == zeros_.end() ? none : zero->second);
}

/// Of positions and tangents together, over what is stated.
double JointProblem::misfit() const {
  double positions = 0.0, tangents = 0.0;
  for (const ResidualBlock& block : blocks()) (block.tangent ? tangents : positions) += 1.0;
  if (!(positions > 0.0)) return 1.0;
  const double square = (3.0 * positions * position_scale_ * position_scale_ +
                         2.0 * tangents * tangent_scale_ * tangent_scale_) /
                        (3.0 * positions + 2.0 * tangents);
  return std::sqrt(square);
}

/// Derivatives by the inputs, weights and noise at the present constants. @return whether they changed
bool JointProblem::update_inputs() {
  if (inputs_.empty()) return false;
  const VectorXd none = VectorXd::Zero(errors_.zero_sd.size());
  const double before = misfit();
  double misfit_now = before;
  std::vector<MatrixXd> by_inputs(frames_.size());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!active_[i] || !evaluate_frame(i, false)) continue;
    const VectorXd steps =
        (0.5 * errors_.noise_sd.row(static_cast<Eigen::Index>(frames_[i].trial)).transpose())
            .cwiseMax(0.5 * errors_.zero_sd);
    MatrixXd dp, dtangent;
    model_.derivative_by_laws(inputs_[i].frame(), dp, dtangent);
    const MatrixXd laws = model_.laws_by_inputs(inputs_[i].frame(), steps);
    by_inputs[i].setZero(static_cast<Eigen::Index>(6 * frames_[i].bodies.size()), steps.size());
    for (std::size_t k = 0; k < frames_[i].bodies.size(); ++k) {
      const auto body = static_cast<int>(k);
      if (!frames_[i].bodies[k].used) continue;
      by_inputs[i].middleRows(6 * body, 3) = dp.middleRows(3 * body, 3) * laws / sd({i, body, false});
      if (frames_[i].bodies[k].tangent_base)
        by_inputs[i].middleRows(6 * body + 3, 3) =
            dtangent.middleRows(3 * body, 3) * laws / sd({i, body, true});
    }
  }
  for (int step = 0; step < kScaleSteps; ++step) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (by_inputs[i].size() == 0) continue;
      const auto zero = zeros_.find(frames_[i].trial);
      inputs_[i].update(rows(i), by_inputs[i], misfit_now, zero == zeros_.end() ? none : zero->second);
      reduce(i);
    }
    measure_scales();
    const double next = misfit();
    const bool settled = std::abs(next - misfit_now) < kScaleSettled * misfit_now;
    misfit_now = next;
    if (settled) break;
  }
  double change = 0.0;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (by_inputs[i].size() == 0) continue;
    change = std::max(change, inputs_[i].step(frames_[i]));
    evaluate_frame(i, false);
  }
  return change > kInputSettled || std::abs(misfit_now - before) > 0.02 * before;
}

MatrixXd JointProblem::jacobian_by_zero(const ResidualBlock& block) const {
  const FrameInputs& inputs = inputs_[block.frame];
  return inputs.whitening().middleRows(6 * block.body + (block.tangent ? 3 : 0), 3) * inputs.by_zero();
}

/// At the fit's end: what the zeros follow the constants by, and what their prior knows.
void JointProblem::eliminate_zeros() {
  zeros_by_x_.clear();
  zeros_information_.clear();
  const auto count = scale_.size(), sensors = errors_.zero_sd.size();
  const double prior = misfit() * misfit();
  std::map<std::size_t, MatrixXd> mixed;
  for (const auto& [trial, zero] : zeros_) {
    zeros_information_[trial] = prior * MatrixXd::Identity(sensors, sensors);
    mixed[trial] = MatrixXd::Zero(sensors, count);
  }
  for (const ResidualBlock& block : blocks()) {
    const std::size_t trial = frames_[block.frame].trial;
    const double w = weight(block, residual(block).squaredNorm());
    const MatrixXd by_zero = jacobian_by_zero(block);
    zeros_information_[trial] += w * by_zero.transpose() * by_zero;
    mixed[trial] += w * by_zero.transpose() * jacobian(block);
  }
  information_of_zeros_ = MatrixXd::Zero(count, count);
  std::map<std::size_t, MatrixXd> follows;
  for (const auto& [trial, information] : zeros_information_) {
    follows[trial] = math::SymmetricSolver(information).solve_columns(mixed[trial]);
    information_of_zeros_ += prior * follows[trial].transpose() * follows[trial];
  }
  zeros_by_x_ = std::move(follows);
}

std::map<std::size_t, TrialZeros> JointProblem::zeros(const MatrixXd& covariance, double factor) const {
  std::map<std::size_t, TrialZeros> found;
  for (const auto& [trial, information] : zeros_information_) {
    const MatrixXd& by_x = zeros_by_x_.at(trial);
    const MatrixXd own = factor * factor * math::inverse_of_symmetric(information);
    const VectorXd variance = (own + by_x * covariance * by_x.transpose()).diagonal();
    // No wider than the prior, which is known without any trial.
    found[trial] = {zeros_.at(trial), variance.cwiseSqrt().cwiseMin(1.0)};
  }
  return found;
}

MatrixXd JointProblem::alike() const {
  const auto count = scale_.size(), sensors = errors_.zero_sd.size();
  MatrixXd cosines = MatrixXd::Zero(sensors, count);
  VectorXd zero2 = VectorXd::Zero(sensors), x2 = VectorXd::Zero(count);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!active_[i] || !solved_[i]) continue;
    const MatrixXd by_x = rows_by_x(i);
    const MatrixXd& by_zero = inputs_[i].by_zero();
    cosines += by_zero.transpose() * by_x;
    zero2 += by_zero.colwise().squaredNorm().transpose();
    x2 += by_x.colwise().squaredNorm().transpose();
  }
  for (Eigen::Index k = 0; k < sensors; ++k) {
    for (Eigen::Index j = 0; j < count; ++j)
      cosines(k, j) = zero2[k] > 0.0 && x2[j] > 0.0 ? cosines(k, j) / std::sqrt(zero2[k] * x2[j]) : 0.0;
  }
  return cosines;
}

NoiseAtBodies JointProblem::noise_at_bodies() const {
  NoiseAtBodies found{std::vector<double>(static_cast<std::size_t>(errors_.zero_sd.size()), 0.0), 0.0};
  double rows = 0.0;
  for (const ResidualBlock& block : blocks()) {
    if (block.tangent || inputs_.empty()) continue;
    const MatrixXd by_noise = inputs_[block.frame].by_noise().middleRows(6 * block.body, 3) * sd(block);
    for (Eigen::Index k = 0; k < by_noise.cols(); ++k)
      found.square_m2[static_cast<std::size_t>(k)] += by_noise.col(k).squaredNorm();
    rows += 3.0;
  }
  for (double& square : found.square_m2) {
    square /= std::max(1.0, rows);
    found.all_m2 += square;
  }
  return found;
}

Eigen::Vector3d JointProblem::position_error_m(const ResidualBlock& block) const {
  if (inputs_.empty()) return residual(block) * sd(block);
  const auto zero = zeros_.find(frames_[block.frame].trial);
  const VectorXd none = VectorXd::Zero(errors_.zero_sd.size());
  return sd(block) * inputs_[block.frame]
                         .reduced(rows(block.frame), zero == zeros_.end() ? none : zero->second)
                         .segment<3>(6 * block.body);
}

}  // namespace softarm::identify
