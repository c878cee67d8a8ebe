// Sets of effects by the group lasso (Yuan and Lin 2006): all sizes of an effect, or none.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bic.h"

namespace softarm::prove {

/// Solves min 1/2 x^T G x - s^T x + penalty sum_g sqrt(p_g) |x_g| by descent group by group, from `start`.
/// @param columns by group, p_g of them; within a group G is the identity
Eigen::VectorXd group_lasso_at(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                               const std::vector<std::vector<Eigen::Index>>& columns, double penalty,
                               Eigen::VectorXd start);

/// The sets along a path of falling penalties, each once, its effects in the order in which they came in; up
/// to so many effects.
std::vector<diagnose::EffectList> group_lasso_path(const Grouped& candidates, std::size_t most);

}  // namespace softarm::prove
