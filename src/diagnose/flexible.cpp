#include "flexible.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "math/symmetric.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Block;

constexpr std::size_t kMostBlocks = 1200;
constexpr std::size_t kFolds = 3;
constexpr double kPast_s[] = {1.0, 8.0};       // time constants of what is remembered of the inputs
constexpr double kReach[] = {1.0, 2.5};        // length scales, in standard deviations of each feature
constexpr double kNoise[] = {0.03, 0.3, 3.0};  // variance of the noise over that of what is learnt

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

}  // namespace

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
        past[p] += (1.0 - std::exp(-now.dt_s / kPast_s[p])) * (now.inputs - past[p]);
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
  const Features all = features(model, at);
  const std::size_t bodies = model.arm().bodies.size();
  // Every n-th block that shows all bodies.
  std::vector<std::size_t> chosen;
  std::vector<VectorXd> targets;
  {
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
    const std::size_t keep = std::min(whole.size(), kMostBlocks);
    for (std::size_t i = 0; i < keep; ++i) {
      const std::size_t w = whole[i * whole.size() / keep];
      chosen.push_back(w);
      targets.push_back(residual[all.trial[w]].segment(begin[all.trial[w]][all.block[w]],
                                                       3 * static_cast<Eigen::Index>(bodies)));
    }
  }
  const auto count = static_cast<Eigen::Index>(chosen.size());
  if (count < 20 || model.trials().size() < 2) return result;
  MatrixXd x(count, all.values.cols()), y(count, 3 * static_cast<Eigen::Index>(bodies));
  for (Eigen::Index i = 0; i < count; ++i) {
    x.row(i) = all.values.row(static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)]));
    y.row(i) = targets[static_cast<std::size_t>(i)].transpose();
  }
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    const double mean = x.col(c).mean();
    const double sd = std::sqrt((x.col(c).array() - mean).square().mean());
    x.col(c) = (x.col(c).array() - mean) / (sd > 1e-12 * (1.0 + std::abs(mean)) ? sd : 1e300);
  }
  const VectorXd square = x.rowwise().squaredNorm();
  const MatrixXd distance2 =
      (square.replicate(1, count) + square.transpose().replicate(count, 1) - 2.0 * x * x.transpose())
          .cwiseMax(0.0) /
      static_cast<double>(x.cols());
  const double before = y.squaredNorm() / static_cast<double>(count * static_cast<Eigen::Index>(bodies));
  double best = before;
  const std::size_t folds = std::min(kFolds, model.trials().size());
  for (const double reach : kReach) {
    const MatrixXd kernel = (-0.5 * distance2.array() / (reach * reach)).exp();
    for (const double noise : kNoise) {
      double left = 0.0;
      for (std::size_t fold = 0; fold < folds; ++fold) {
        std::vector<Eigen::Index> train, test;
        for (Eigen::Index i = 0; i < count; ++i) {
          // Campaigns go round attitudes and speeds: a turn that is not theirs.
          const std::size_t t = all.trial[chosen[static_cast<std::size_t>(i)]];
          ((t + t / folds) % folds == fold ? test : train).push_back(i);
        }
        if (train.empty() || test.empty()) continue;
        MatrixXd k = pick(kernel, train, &train);
        k.diagonal().array() += noise;
        math::CholeskyFactor factor;
        factor.compute(k);
        const MatrixXd weights = factor.solve_columns(pick(y, train, nullptr));
        left += (pick(y, test, nullptr) - pick(kernel, test, &train) * weights).squaredNorm();
      }
      best = std::min(best, left / static_cast<double>(count * static_cast<Eigen::Index>(bodies)));
    }
  }
  result.before_rms_m = std::sqrt(before);
  result.after_rms_m = std::sqrt(best);
  result.share = before > 0.0 ? 1.0 - best / before : 0.0;
  return result;
}

}  // namespace softarm::diagnose
