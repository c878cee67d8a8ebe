#include "assignment.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace softarm::trial {
namespace {

using Eigen::Index;

constexpr Index kNobody = -1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t slot(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

Assignment cheapest_assignment(const Eigen::MatrixXd& cost) {
  const Index rows = cost.rows(), columns = cost.cols();
  assert(rows <= columns);
  std::vector<Index> row_of(slot(columns), kNobody), came_from(slot(columns), kNobody);
  std::vector<char> done(slot(columns), 0);
  Eigen::VectorXd distance(columns);
  Assignment best;
  best.row_potential.setZero(rows);
  best.column_potential.setZero(columns);

  // From the last row to the first: one that many columns suit has to give way each time that one of these is
  // wanted, and such rows, of bodies not seen for a while, come first.
  for (Index start = rows - 1; start >= 0; --start) {
    // Dijkstra over reduced costs from the new row to the nearest free column.
    distance.setConstant(kInfinity);
    came_from.assign(slot(columns), kNobody);
    done.assign(slot(columns), 0);
    Index row = start, column = kNobody;
    double reached = 0.0;
    while (true) {
      Index next = kNobody;
      for (Index j = 0; j < columns; ++j) {
        if (done[slot(j)]) continue;
        const double through = reached + cost(row, j) - best.row_potential[row] - best.column_potential[j];
        if (through < distance[j]) {
          distance[j] = through;
          came_from[slot(j)] = column;
        }
        if (next == kNobody || distance[j] < distance[next]) next = j;
      }
      done[slot(next)] = 1;
      column = next;
      reached = distance[next];
      if (row_of[slot(next)] == kNobody) break;
      row = row_of[slot(next)];
    }
    // Keep all reduced costs non-negative, and zero along the path.
    best.row_potential[start] += reached;
    for (Index j = 0; j < columns; ++j) {
      if (!done[slot(j)] || j == column) continue;
      best.row_potential[row_of[slot(j)]] += reached - distance[j];
      best.column_potential[j] -= reached - distance[j];
    }
    while (column != kNobody) {
      const Index before = came_from[slot(column)];
      row_of[slot(column)] = before == kNobody ? start : row_of[slot(before)];
      column = before;
    }
  }
  best.column_of_row.assign(slot(rows), -1);
  for (Index j = 0; j < columns; ++j) {
    if (row_of[slot(j)] != kNobody) best.column_of_row[slot(row_of[slot(j)])] = static_cast<int>(j);
  }
  return best;
}

double rise_without(const Eigen::MatrixXd& cost, const Assignment& best, Index row, double enough) {
  // The row takes another column, whose row takes another, and so on, until one takes the first row's.
  // Columns without a row belong to one nobody, whom any column suits: who takes one of these makes nobody
  // take another. By reduced costs none of these steps lowers the total, so that the cheapest way is
  // Dijkstra's.
  const Index columns = cost.cols(), own = best.column_of_row[slot(row)];
  std::vector<Index> row_of(slot(columns), kNobody);
  for (std::size_t i = 0; i < best.column_of_row.size(); ++i)
    row_of[slot(best.column_of_row[i])] = static_cast<Index>(i);
  std::vector<char> done(slot(columns), 0);
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(columns, kInfinity);
  double reached = 0.0;
  bool nobody_moved = false;
  for (Index mover = row;;) {
    Index next = own;
    for (Index j = 0; j < columns; ++j) {
      // Nobody moves once: from there the other columns without a row lead nowhere new.
      if (done[slot(j)] || (nobody_moved && row_of[slot(j)] == kNobody)) continue;
      double step = -best.column_potential[j];
      if (mover != kNobody) step += cost(mover, j) - best.row_potential[mover];
      if (mover != row || j != own) distance[j] = std::min(distance[j], reached + step);
      if (distance[j] < distance[next]) next = j;
    }
    reached = distance[next];
    if (next == own || !(reached < enough)) return reached;
    done[slot(next)] = 1;
    mover = row_of[slot(next)];
    nobody_moved = nobody_moved || mover == kNobody;
  }
}

}  // namespace softarm::trial
