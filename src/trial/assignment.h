// The assignment of rows to columns of least total cost, and what it would cost to do without a pair of it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace softarm::trial {

/// More than any sum of allowed costs.
constexpr double kForbidden = 1e9;

/// With the potentials that prove it the best: those of a row and a column add up to no more than the cost of
/// the pair, and to just that of a pair that was chosen; a column without a row has 0, any other at most 0.
struct Assignment {
  std::vector<int> column_of_row;  ///< all different
  Eigen::VectorXd row_potential, column_potential;
};

/// Hungarian method (Kuhn 1955, Munkres 1957) by shortest augmenting paths, O(rows^2 columns).
/// @param cost rows <= columns; finite; a pair that is not allowed has kForbidden
Assignment cheapest_assignment(const Eigen::MatrixXd& cost);

/// By how much the total rises where a row may not have the column that it was given: one shortest path,
/// O(rows columns), where a new assignment would be O(rows^2 columns).
/// @param best cheapest_assignment(cost)
/// @param enough the answer may be any number from this on where it is no less: the search ends there
/// @return about kForbidden, or infinity, where nothing else is allowed
double rise_without(const Eigen::MatrixXd& cost, const Assignment& best, Eigen::Index row, double enough);

}  // namespace softarm::trial
