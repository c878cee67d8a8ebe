#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "deciders.h"
#include "math/linear_algebra.h"

namespace softarm::prove {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastNew = 1e-6;  // of a signature that those taken do not have
constexpr int kMostSteps = 6, kPenalties = 40, kSweeps = 500;

std::vector<std::string> by_size(const Candidates& candidates, const VectorXd& size) {
  std::vector<std::size_t> order(candidates.names.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return size[static_cast<Eigen::Index>(a)] > size[static_cast<Eigen::Index>(b)];
  });
  std::vector<std::string> names;
  for (const std::size_t i : order) names.push_back(candidates.names[i]);
  return names;
}

MatrixXd chosen(const MatrixXd& gram, const std::vector<Eigen::Index>& rows,
                const std::vector<Eigen::Index>& columns) {
  MatrixXd part(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = gram(rows[i], columns[j]);
  return part;
}

}  // namespace

Decision bic_stepwise(const Candidates& candidates) {
  Decision decision;
  decision.method = "bic";
  const Eigen::Index n = candidates.score.size();
  const double price = std::log(std::max(2.0, candidates.rows));
  std::vector<Eigen::Index> taken;
  for (int step = 0; step < std::min<Eigen::Index>(kMostSteps, n); ++step) {
    VectorXd fall = VectorXd::Constant(n, -1e300), gain = VectorXd::Zero(n);
    math::SymmetricSolver solver(chosen(candidates.gram, taken, taken));
    VectorXd own(static_cast<Eigen::Index>(taken.size()));
    for (std::size_t i = 0; i < taken.size(); ++i)
      own[static_cast<Eigen::Index>(i)] = candidates.score[taken[i]];
    for (Eigen::Index j = 0; j < n; ++j) {
      if (std::find(taken.begin(), taken.end(), j) != taken.end()) continue;
      double left = 1.0, score = candidates.score[j];
      if (!taken.empty()) {
        const VectorXd shared = chosen(candidates.gram, taken, {j});
        const VectorXd x = solver.solve(shared);
        left -= shared.dot(x);
        score -= own.dot(x);
      }
      if (left < kLeastNew) continue;
      gain[j] = score * score / left;
      fall[j] = gain[j] - candidates.numbers[j] * price;
    }
    if (step == 0) decision.ranking = by_size(candidates, fall);
    Eigen::Index best = 0;
    if (!(fall.maxCoeff(&best) > 0.0)) break;
    // Against none and the other candidates of this step.
    const double most = fall[best];
    double sum = std::exp(-0.5 * most);
    for (Eigen::Index j = 0; j < n; ++j) sum += std::exp(0.5 * (fall[j] - most));
    decision.effects.push_back({candidates.names[static_cast<std::size_t>(best)], 1.0 / sum});
    taken.push_back(best);
  }
  decision.alarm = !decision.effects.empty();
  // Those taken first.
  std::vector<std::string> order;
  for (const Named& named : decision.effects) order.push_back(named.effect);
  for (const std::string& name : decision.ranking)
    if (std::find(order.begin(), order.end(), name) == order.end()) order.push_back(name);
  decision.ranking = std::move(order);
  return decision;
}

VectorXd lasso_at(const MatrixXd& gram, const VectorXd& score, double penalty, VectorXd x) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double moved = 0.0;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const double own = gram(j, j);
      if (!(own > 0.0)) continue;
      const double rest = score[j] - gram.row(j).dot(x) + own * x[j];
      const double next = std::copysign(std::max(0.0, std::abs(rest) - penalty), rest) / own;
      moved = std::max(moved, std::abs(next - x[j]));
      x[j] = next;
    }
    if (moved < 1e-8 * (1.0 + x.cwiseAbs().maxCoeff())) break;
  }
  return x;
}

Decision lasso(const Candidates& candidates) {
  Decision decision;
  decision.method = "lasso";
  const Eigen::Index n = candidates.score.size();
  if (n == 0) return decision;
  const double most = candidates.score.cwiseAbs().maxCoeff(),
               price = std::log(std::max(2.0, candidates.rows));
  VectorXd x = VectorXd::Zero(n), best = x;
  double least = 0.0;  // BIC of none
  for (int k = 0; k < kPenalties && most > 0.0; ++k) {
    const double penalty = most * std::pow(1e-3, static_cast<double>(k + 1) / kPenalties);
    x = lasso_at(candidates.gram, candidates.score, penalty, x);
    double bic = x.dot(candidates.gram * x) - 2.0 * x.dot(candidates.score);
    for (Eigen::Index j = 0; j < n; ++j)
      if (x[j] != 0.0) bic += candidates.numbers[j] * price;
    if (bic < least) {
      least = bic;
      best = x;
    }
  }
  const VectorXd size = best.cwiseAbs() + 1e-9 * candidates.score.cwiseAbs();
  decision.ranking = by_size(candidates, size);
  for (const std::string& name : decision.ranking) {
    const auto at =
        std::find(candidates.names.begin(), candidates.names.end(), name) - candidates.names.begin();
    if (best[at] != 0.0) decision.effects.push_back({name, std::nullopt});
  }
  decision.alarm = !decision.effects.empty();
  return decision;
}

}  // namespace softarm::prove
