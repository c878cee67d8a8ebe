#include "flexible.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Block;
using model::Seen;

MatrixXd pick(const MatrixXd& from, const std::vector<Eigen::Index>& rows,
              const std::vector<Eigen::Index>* columns) {
  const auto count = columns != nullptr ? static_cast<Eigen::Index>(columns->size()) : from.cols();
  MatrixXd out(static_cast<Eigen::Index>(rows.size()), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const Eigen::Index column = columns != nullptr ? (*columns)[static_cast<std::size_t>(j)] : j;
    for (std::size_t i = 0; i < rows.size(); ++i)
      out(static_cast<Eigen::Index>(i), j) = from(rows[i], column);
  }
  return out;
}

/// Instants that show all bodies, every n-th of them: features as multiples of their spread, residuals of the
/// bodies.
struct Instants {
  MatrixXd x, y;
  VectorXd weight;  ///< by precision, 1 on average
  std::vector<std::size_t> trial;
};

Instants instants_of(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual) {
  const Features all = features(model, at);
  const std::size_t bodies = model.arm().bodies.size();
  std::vector<std::vector<Eigen::Index>> begin(model.trials().size());
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    Eigen::Index row = 0;
    for (const Block& block : model.trials()[t].blocks) {
      begin[t].push_back(row);
      row += 3 * static_cast<Eigen::Index>(block.bodies.size());
    }
  }
  std::vector<std::size_t> whole;
  for (std::size_t i = 0; i < all.trial.size(); ++i) {
    if (model.trials()[all.trial[i]].blocks[all.block[i]].bodies.size() == bodies) whole.push_back(i);
  }
  const std::size_t keep = std::min(whole.size(), kPolicy.flexible.most_blocks);
  Instants out;
  out.x.resize(static_cast<Eigen::Index>(keep), all.values.cols());
  out.y.resize(out.x.rows(), 3 * static_cast<Eigen::Index>(bodies));
  out.weight.resize(out.x.rows());
  for (std::size_t i = 0; i < keep; ++i) {
    const std::size_t w = whole[i * whole.size() / keep];
    const auto row = static_cast<Eigen::Index>(i);
    out.x.row(row) = all.values.row(static_cast<Eigen::Index>(w));
    out.y.row(row) =
        residual[all.trial[w]].segment(begin[all.trial[w]][all.block[w]], out.y.cols()).transpose();
    out.trial.push_back(all.trial[w]);
    double variance = 0.0;
    for (const Seen& seen : model.trials()[all.trial[w]].blocks[all.block[w]].bodies)
      variance += std::pow(model.sd_m(all.trial[w], all.block[w], seen), 2);
    out.weight[row] = 1.0 / variance;
  }
  out.weight /= out.weight.mean();
  out.x = in_spreads(std::move(out.x));
  return out;
}

/// Weighted squares that kernel regression leaves of the folds' instants, each by the other folds.
double left_by_regression(const Instants& instants, const MatrixXd& kernel, double noise, std::size_t folds) {
  double left = 0.0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<Eigen::Index> train, test;
    for (Eigen::Index i = 0; i < kernel.rows(); ++i) {
      // Campaigns go round attitudes and speeds: a turn that is not theirs.
      const std::size_t t = instants.trial[static_cast<std::size_t>(i)];
      ((t + t / folds) % folds == fold ? test : train).push_back(i);
    }
    if (train.empty() || test.empty()) continue;
    MatrixXd k = pick(kernel, train, &train);
    for (std::size_t i = 0; i < train.size(); ++i)
      k.diagonal()[static_cast<Eigen::Index>(i)] += noise / instants.weight[train[i]];
    math::CholeskyFactor factor;
    factor.compute(k);
    const MatrixXd weights = factor.solve_columns(pick(instants.y, train, nullptr));
    const VectorXd squares =
        (pick(instants.y, test, nullptr) - pick(kernel, test, &train) * weights).rowwise().squaredNorm();
    for (std::size_t i = 0; i < test.size(); ++i)
      left += instants.weight[test[i]] * squares[static_cast<Eigen::Index>(i)];
  }
  return left;
}

}  // namespace

MatrixXd in_spreads(MatrixXd values) {
  for (Eigen::Index c = 0; c < values.cols() && values.rows() > 0; ++c) {
    const double mean = values.col(c).mean();
    const double sd = std::sqrt((values.col(c).array() - mean).square().mean());
    values.col(c) = (values.col(c).array() - mean) / (sd > 1e-12 * (1.0 + std::abs(mean)) ? sd : 1e300);
  }
  return values;
}

MatrixXd mean_distances2(const MatrixXd& x) {
  const VectorXd square = x.rowwise().squaredNorm();
  return (square.replicate(1, x.rows()) + square.transpose().replicate(x.rows(), 1) - 2.0 * x * x.transpose())
             .cwiseMax(0.0) /
         static_cast<double>(x.cols());
}

Features features(const JointModel& model, const Linearised& at) {
  Features out;
  const auto inputs = static_cast<Eigen::Index>(model.arm().inputs.scalars.size());
  for (const arm::ScalarInput& input : model.arm().inputs.scalars) out.names.push_back(input.name);
  for (const arm::ScalarInput& input : model.arm().inputs.scalars)
    out.names.push_back("speed of " + input.name);
  for (int past = 0; past < 2; ++past) {
    for (const arm::ScalarInput& input : model.arm().inputs.scalars)
      out.names.push_back("past of " + input.name);
  }
  for (const char* name : {"payload", "attitude", "attitude", "attitude", "time in the trial"})
    out.names.push_back(name);
  std::vector<VectorXd> rows;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    VectorXd past[2];
    const auto& predicted = at.predicted[t];
    for (std::size_t k = 0; k < predicted.size(); ++k) {
      const model::Instant& now = predicted[k].instant;
      VectorXd speed = VectorXd::Zero(inputs);
      for (int p = 0; p < 2; ++p) {
        if (now.dt_s <= 0.0 || past[p].size() != inputs) past[p] = now.inputs;
        past[p] += (1.0 - std::exp(-now.dt_s / kPolicy.flexible.past_s[p])) * (now.inputs - past[p]);
      }
      if (now.dt_s > 0.0 && k > 0) speed = (now.inputs - predicted[k - 1].instant.inputs) / now.dt_s;
      if (!model.uses(t, k) || !predicted[k].solved) continue;
      VectorXd row(4 * inputs + 5);
      row << now.inputs, speed, now.inputs - past[0], now.inputs - past[1], now.payload_kg, now.gravity_base,
          now.t_s;
      rows.push_back(row);
      out.trial.push_back(t);
      out.block.push_back(k);
    }
  }
  out.values.resize(static_cast<Eigen::Index>(rows.size()), 4 * inputs + 5);
  for (std::size_t i = 0; i < rows.size(); ++i)
    out.values.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return out;
}

Ceiling ceiling(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual) {
  Ceiling result;
  const Instants instants = instants_of(model, at, residual);
  if (instants.x.rows() < kPolicy.flexible.fewest_instants || model.trials().size() < 2) return result;
  const auto bodies =
      static_cast<double>(instants.x.rows() * static_cast<Eigen::Index>(model.arm().bodies.size()));
  const MatrixXd distance2 = mean_distances2(instants.x);
  const double before = instants.weight.dot(instants.y.rowwise().squaredNorm()) / bodies;
  double best = before;
  for (const double reach : kPolicy.flexible.reach) {
    const MatrixXd kernel = (-0.5 * distance2.array() / (reach * reach)).exp();
    for (const double noise : kPolicy.flexible.noise)
      best = std::min(best, left_by_regression(instants, kernel, noise,
                                               std::min(kPolicy.flexible.folds, model.trials().size())) /
                                bodies);
  }
  result.before_rms_m = std::sqrt(before);
  result.after_rms_m = std::sqrt(best);
  result.share = before > 0.0 ? 1.0 - best / before : 0.0;
  return result;
}

}  // namespace softarm::diagnose
