#include "assignment.h"

#include <cassert>
#include <limits>

namespace softarm::trial {

std::vector<int> cheapest_assignment(const Eigen::MatrixXd& cost) {
  const Eigen::Index rows = cost.rows(), columns = cost.cols();
  assert(rows <= columns);
  constexpr Eigen::Index kNone = -1;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Eigen::Index> row_of(static_cast<std::size_t>(columns), kNone);
  Eigen::VectorXd row_potential = Eigen::VectorXd::Zero(rows);
  Eigen::VectorXd column_potential = Eigen::VectorXd::Zero(columns);

  for (Eigen::Index start = 0; start < rows; ++start) {
    // Dijkstra over reduced costs from the new row to the nearest free column.
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(columns, kInfinity);
    std::vector<Eigen::Index> came_from(static_cast<std::size_t>(columns), kNone);
    std::vector<bool> done(static_cast<std::size_t>(columns), false);
    Eigen::Index row = start, column = kNone;
    double reached = 0.0;
    while (true) {
      Eigen::Index next = kNone;
      for (Eigen::Index j = 0; j < columns; ++j) {
        const auto at = static_cast<std::size_t>(j);
        if (done[at]) continue;
        const double through = reached + cost(row, j) - row_potential[row] - column_potential[j];
        if (through < distance[j]) {
          distance[j] = through;
          came_from[at] = column;
        }
        if (next == kNone || distance[j] < distance[next]) next = j;
      }
      done[static_cast<std::size_t>(next)] = true;
      column = next;
      reached = distance[next];
      if (row_of[static_cast<std::size_t>(next)] == kNone) break;
      row = row_of[static_cast<std::size_t>(next)];
    }
    // Keep all reduced costs non-negative, and zero along the path.
    row_potential[start] += reached;
    for (Eigen::Index j = 0; j < columns; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (!done[at] || j == column) continue;
      row_potential[row_of[at]] += reached - distance[j];
      column_potential[j] -= reached - distance[j];
    }
    while (column != kNone) {
      const Eigen::Index before = came_from[static_cast<std::size_t>(column)];
      row_of[static_cast<std::size_t>(column)] =
          before == kNone ? start : row_of[static_cast<std::size_t>(before)];
      column = before;
    }
  }
  std::vector<int> column_of_row(static_cast<std::size_t>(rows), -1);
  for (std::size_t j = 0; j < row_of.size(); ++j) {
    if (row_of[j] != kNone) column_of_row[static_cast<std::size_t>(row_of[j])] = static_cast<int>(j);
  }
  return column_of_row;
}

double total_cost(const Eigen::MatrixXd& cost, const std::vector<int>& column_of_row) {
  double sum = 0.0;
  for (std::size_t i = 0; i < column_of_row.size(); ++i)
    sum += cost(static_cast<Eigen::Index>(i), column_of_row[i]);
  return sum;
}

}  // namespace softarm::trial
