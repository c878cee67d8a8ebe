#include "background.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "evidence.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Room kAnywhere{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// Sums over one trial, of the fit's unknowns and the sizes behind them.
struct TrialSums {
  MatrixXd information;
  VectorXd gradient;
};

/// Of the unknowns and sizes, before the data.
VectorXd precision_of(const JointModel& model, const Linearised& at, const std::vector<MatrixXd>& columns,
                      const std::vector<TrialSums>& sums, double background) {
  const Index unknowns = at.gradient.size(), all = columns.front().cols();
  VectorXd precision = VectorXd::Zero(all);
  for (Index j = 0; j < unknowns; ++j) precision[j] = at.information(j, j);
  for (const TimeStretch& stretch : at.stretches) precision.head(unknowns) -= stretch.information.diagonal();
  precision = precision.cwiseMax(0.0);
  MatrixXd mixed = MatrixXd::Zero(unknowns, all - unknowns);
  for (const TrialSums& one : sums) mixed += one.information.topRightCorner(unknowns, all - unknowns);
  const MatrixXd absorbed = math::SymmetricSolver(information_within_ranges(at)).solve_columns(mixed);
  std::vector<VectorXd> left(columns.size());
  for (Index j = 0; j < all - unknowns; ++j) {
    for (std::size_t t = 0; t < columns.size(); ++t)
      left[t] = columns[t].col(unknowns + j) - columns[t].leftCols(unknowns) * absorbed.col(j);
    Signature signature;
    signature.left = summed(model, at, left).total_rms_m / model.arm().total_length_m();
    precision[unknowns + j] = 1.0 / std::pow(background_sd(signature, background), 2);
  }
  return precision;
}

}  // namespace

Unseen with_background(JointModel& model, Linearised& at, const std::vector<model::Present>& candidates,
                       double background, const Unseen& unseen, unsigned jobs) {
  if (candidates.empty() || !(background > 0.0)) return unseen;
  model.complete(at);
  const std::vector<SizeStep> steps = size_steps(candidates);
  const std::size_t trials = model.trials().size();
  std::vector<MatrixXd> columns(trials);
  std::vector<TrialSums> sums(trials);
  model.each_trial(jobs, [&](std::size_t t) {
    const MatrixXd moves = signatures_of(model, at, t, steps);
    columns[t].resize(moves.rows(), at.derivative[t].cols() + moves.cols());
    columns[t] << at.derivative[t], moves;
    sums[t] = {columns[t].transpose() * columns[t], columns[t].transpose() * at.residual[t]};
  });
  // Neighbouring residuals are worth less than independent ones.
  const double worth = 1.0 / inflation(at);
  const VectorXd precision = precision_of(model, at, columns, sums, background);
  std::vector<Room> rooms = rooms_of(at);
  rooms.resize(static_cast<std::size_t>(precision.size()), kAnywhere);
  std::vector<VectorXd> residual(trials);
  for (const Fold& fold : unseen_folds(model)) {
    MatrixXd information = precision.asDiagonal();
    VectorXd gradient = VectorXd::Zero(precision.size());
    for (std::size_t t = 0; t < trials; ++t) {
      if (fold.without[t]) continue;
      information += worth * sums[t].information;
      gradient += worth * sums[t].gradient;
    }
    VectorXd step;
    least_within(information, gradient, 0.0, rooms, step);
    for (const std::size_t t : fold.tried) residual[t] = at.residual[t] - columns[t] * step;
  }
  Unseen with = summed(model, at, residual);
  return with.total_rms_m < unseen.total_rms_m ? with : unseen;
}

std::optional<double> small_departures_m(const Unseen& without, const Unseen& with, bool adequate,
                                         double length_m) {
  const double small_m =
      std::sqrt(std::max(0.0, std::pow(without.total_rms_m, 2) - std::pow(with.total_rms_m, 2)));
  return adequate && small_m <= kPolicy.words.small * length_m ? std::optional(small_m) : std::nullopt;
}

}  // namespace softarm::diagnose
