#include "group_lasso.h"

#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"

namespace softarm::prove {

using diagnose::EffectList;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kLeastOfGroup = 1e-6;  // of a group's information: a direction that is no other's
constexpr int kPenalties = 60, kSweeps = 500;
constexpr double kLastPenalty = 1e-3, kStill = 1e-8;

MatrixXd block(const MatrixXd& a, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  MatrixXd part(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      part(static_cast<Index>(i), static_cast<Index>(j)) = a(rows[i], columns[j]);
  return part;
}

/// The same sizes in directions that are orthonormal within each group.
Grouped orthonormal(const Grouped& of) {
  Grouped turned;
  turned.effects = of.effects;
  MatrixXd turn = MatrixXd::Zero(of.gram.rows(), of.gram.rows());
  Index count = 0;
  for (const std::vector<Index>& columns : of.columns) {
    turned.columns.emplace_back();
    const math::Eigensystem own = math::eigensystem_of(block(of.gram, columns, columns));
    for (Index k = 0; k < own.values.size(); ++k) {
      if (!(own.values[k] > kLeastOfGroup * own.values.maxCoeff())) continue;
      for (std::size_t i = 0; i < columns.size(); ++i)
        turn(columns[i], count) = own.vectors(static_cast<Index>(i), k) / std::sqrt(own.values[k]);
      turned.columns.back().push_back(count++);
    }
  }
  const MatrixXd used = turn.leftCols(count);
  turned.gram = used.transpose() * of.gram * used;
  turned.score = used.transpose() * of.score;
  return turned;
}

double root_of_count(const std::vector<Index>& columns) {
  return std::sqrt(static_cast<double>(columns.size()));
}

bool is_in(const VectorXd& x, const std::vector<Index>& columns) {
  return std::any_of(columns.begin(), columns.end(), [&](Index j) { return x[j] != 0.0; });
}

}  // namespace

VectorXd group_lasso_at(const MatrixXd& gram, const VectorXd& score,
                        const std::vector<std::vector<Index>>& columns, double penalty, VectorXd x) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double moved = 0.0;
    for (const std::vector<Index>& group : columns) {
      VectorXd rest(static_cast<Index>(group.size()));
      for (std::size_t k = 0; k < group.size(); ++k)
        rest[static_cast<Index>(k)] = score[group[k]] - gram.row(group[k]).dot(x) + x[group[k]];
      const double norm = rest.norm(), least = penalty * root_of_count(group);
      const double kept = norm > least ? 1.0 - least / norm : 0.0;
      for (std::size_t k = 0; k < group.size(); ++k) {
        const double next = kept * rest[static_cast<Index>(k)];
        moved = std::max(moved, std::abs(next - x[group[k]]));
        x[group[k]] = next;
      }
    }
    if (moved < kStill * (1.0 + x.cwiseAbs().maxCoeff())) break;
  }
  return x;
}

std::vector<EffectList> group_lasso_path(const Grouped& candidates, std::size_t most) {
  std::vector<EffectList> sets;
  const Grouped groups = orthonormal(candidates);
  double largest = 0.0;
  for (const std::vector<Index>& columns : groups.columns)
    if (!columns.empty())
      largest = std::max(largest, math::rows_of(groups.score, columns).norm() / root_of_count(columns));
  VectorXd x = VectorXd::Zero(groups.score.size());
  EffectList order;  // in which they came in
  for (int k = 0; k < kPenalties && largest > 0.0; ++k) {
    const double penalty = largest * std::pow(kLastPenalty, static_cast<double>(k + 1) / kPenalties);
    x = group_lasso_at(groups.gram, groups.score, groups.columns, penalty, x);
    EffectList now;
    for (std::size_t g = 0; g < groups.effects.size(); ++g)
      if (is_in(x, groups.columns[g])) now.push_back(groups.effects[g]);
    for (const model::Effect* effect : now)
      if (std::find(order.begin(), order.end(), effect) == order.end()) order.push_back(effect);
    if (now.size() > most) break;
    EffectList set;
    for (const model::Effect* effect : order)
      if (std::find(now.begin(), now.end(), effect) != now.end()) set.push_back(effect);
    if (!set.empty() && std::find(sets.begin(), sets.end(), set) == sets.end()) sets.push_back(set);
  }
  return sets;
}

}  // namespace softarm::prove
