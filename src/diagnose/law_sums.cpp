#include "law_sums.h"

#include <algorithm>

#include "math/linear_algebra.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Without its first columns, which are free within their priors.
MatrixXd eliminate(MatrixXd products, const VectorXd& precision) {
  const Index n = precision.size(), rest = products.cols() - n;
  if (n == 0) return products;
  products.diagonal().head(n) += precision;
  const MatrixXd by =
      math::SymmetricSolver(products.topLeftCorner(n, n)).solve_columns(products.topRightCorner(n, rest));
  return products.bottomRightCorner(rest, rest) - products.bottomLeftCorner(rest, n) * by;
}

/// Sum over the trials, each of which has offsets of its own.
MatrixXd without_offsets(const LawSums& sums, const std::vector<bool>& use) {
  const Index rest = sums.of.front().cols() - sums.offsets;
  MatrixXd all = MatrixXd::Zero(rest, rest);
  for (std::size_t first = 0; first < sums.of.size();) {
    MatrixXd of_trial = MatrixXd::Zero(sums.of.front().cols(), sums.of.front().cols());
    std::size_t u = first;
    for (; u < sums.of.size() && sums.trial[u] == sums.trial[first]; ++u)
      if (use[u]) of_trial += sums.of[u];
    all += eliminate(std::move(of_trial), sums.precision.head(sums.offsets));
    first = u;
  }
  return all;
}

/// Columns of unknowns and chosen terms, behind the offsets.
std::vector<Index> columns_of(const LawSums& sums, const std::vector<Index>& chosen) {
  std::vector<Index> columns;
  for (Index j = 0; j < sums.unknowns; ++j) columns.push_back(j);
  for (const Index term : chosen)
    for (Index k = 0; k < 2; ++k) columns.push_back(sums.first(term) - sums.offsets + k);
  return columns;
}

/// Coefficients of these columns.
/// @param products without offsets
VectorXd solve(const LawSums& sums, const MatrixXd& products, const std::vector<Index>& columns) {
  MatrixXd own = math::block_of(products, columns);
  for (Index j = 0; j < own.rows(); ++j)
    own(j, j) += columns[static_cast<std::size_t>(j)] < sums.unknowns
                     ? sums.precision[sums.offsets + columns[static_cast<std::size_t>(j)]]
                     : sums.size_precision;
  return math::solve_symmetric(own, math::rows_of(products.col(products.cols() - 1), columns));
}

}  // namespace

Reduced reduce(const LawSums& sums, const std::vector<bool>& use) {
  Reduced out;
  out.whole = VectorXd::Zero(2 * sums.terms);
  for (std::size_t u = 0; u < sums.of.size(); ++u)
    if (use[u]) out.whole += sums.of[u].diagonal().segment(sums.first(0), 2 * sums.terms);
  const MatrixXd left = eliminate(without_offsets(sums, use), VectorXd(sums.precision.tail(sums.unknowns)));
  out.products = left.topLeftCorner(2 * sums.terms, 2 * sums.terms);
  out.score = left.col(2 * sums.terms).head(2 * sums.terms);
  return out;
}

double held_out_gain(const LawSums& sums, const std::vector<Index>& chosen, const Folds& folds) {
  double gain = 0.0;
  const Index rest = sums.of.front().cols() - sums.offsets;
  for (const std::vector<std::size_t>& fold : folds) {
    std::vector<bool> use = units_of(sums, folds);
    MatrixXd unseen = MatrixXd::Zero(rest, rest);
    for (std::size_t u = 0; u < use.size(); ++u) {
      if (std::find(fold.begin(), fold.end(), sums.trial[u]) == fold.end()) continue;
      use[u] = false;
      unseen += sums.of[u].bottomRightCorner(rest, rest);
    }
    const MatrixXd seen = without_offsets(sums, use);
    const auto fall = [&](const std::vector<Index>& terms) {
      const std::vector<Index> columns = columns_of(sums, terms);
      const VectorXd x = solve(sums, seen, columns);
      return 2.0 * x.dot(math::rows_of(unseen.col(rest - 1), columns)) -
             x.dot(math::block_of(unseen, columns) * x);
    };
    gain += fall(chosen) - fall({});
  }
  return gain;
}

VectorXd sizes_of(const LawSums& sums, const std::vector<Index>& chosen, const Folds& folds) {
  const MatrixXd all = without_offsets(sums, units_of(sums, folds));
  return solve(sums, all, columns_of(sums, chosen)).tail(2 * static_cast<Index>(chosen.size()));
}

std::vector<bool> units_of(const LawSums& sums, const Folds& folds) {
  std::vector<bool> use;
  for (const std::size_t trial : sums.trial)
    use.push_back(std::any_of(folds.begin(), folds.end(), [&](const std::vector<std::size_t>& fold) {
      return std::find(fold.begin(), fold.end(), trial) != fold.end();
    }));
  return use;
}

}  // namespace softarm::diagnose
