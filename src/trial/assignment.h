// The assignment of rows to columns of least total cost.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace softarm::trial {

/// Hungarian method (Kuhn 1955, Munkres 1957) by shortest augmenting paths, O(rows^2 columns).
/// @param cost rows <= columns; finite; a pair that is not allowed has kForbidden
/// @return the column of every row, all different
std::vector<int> cheapest_assignment(const Eigen::MatrixXd& cost);

/// More than any sum of allowed costs.
constexpr double kForbidden = 1e9;

/// Sum of the chosen entries.
double total_cost(const Eigen::MatrixXd& cost, const std::vector<int>& column_of_row);

}  // namespace softarm::trial
