#include "ranges.h"

#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAtEnd = 1e-9;  // of an unknown's scale: the rounding of a value that was set to its end

double misfit_of(const Linearised& at) {
  return std::max(1.0, at.square / std::max(1, at.rows));
}

}  // namespace

std::vector<Room> rooms_of(const Linearised& at) {
  std::vector<Room> rooms;
  const VectorXd x = at.unknowns();
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const JointUnknown& c = at.columns[j];
    const double here = x[static_cast<Index>(j)];
    rooms.push_back({std::min(0.0, c.low / c.scale - here), std::max(0.0, c.high / c.scale - here)});
  }
  return rooms;
}

double least_within(const MatrixXd& information, const VectorXd& gradient, double square,
                    const std::vector<Room>& rooms, VectorXd& move) {
  const auto count = gradient.size();
  move = math::solve_symmetric(information, gradient);
  std::vector<bool> fixed(static_cast<std::size_t>(count), false);
  for (bool more = true; more;) {
    more = false;
    MatrixXd h = information;
    VectorXd g = gradient;
    for (Index j = 0; j < count; ++j) {
      const auto u = static_cast<std::size_t>(j);
      const double limit = std::clamp(move[j], rooms[u].low, rooms[u].high);
      if (!fixed[u] && limit != move[j]) {
        fixed[u] = more = true;
        move[j] = limit;
      }
      if (fixed[u]) g -= information.col(j) * move[j];
    }
    if (!more) break;
    const VectorXd ends = move;
    hold(fixed, h, g);
    move = math::solve_symmetric(h, g);
    for (Index j = 0; j < count; ++j)
      if (fixed[static_cast<std::size_t>(j)]) move[j] = ends[j];
  }
  return std::max(0.0, square - 2.0 * move.dot(gradient) + move.dot(information * move));
}

std::vector<bool> held_at_ends(const Linearised& at) {
  const VectorXd x = at.unknowns();
  std::vector<bool> held;
  for (Index j = 0; j < x.size(); ++j) {
    const JointUnknown& c = at.columns[static_cast<std::size_t>(j)];
    const double value = x[j] * c.scale, near = kAtEnd * c.scale;
    held.push_back((value <= c.low + near && at.gradient[j] < 0.0) ||
                   (value >= c.high - near && at.gradient[j] > 0.0));
  }
  return held;
}

VectorXd spread_at_ends(const Linearised& at) {
  const std::vector<bool> held = held_at_ends(at);
  VectorXd spread = VectorXd::Zero(at.gradient.size());
  for (Index j = 0; j < spread.size(); ++j) {
    if (!held[static_cast<std::size_t>(j)]) continue;
    const double own = std::sqrt(misfit_of(at) * at.information(j, j));
    spread[j] = misfit_of(at) / std::max(std::abs(at.gradient[j]), own);
  }
  return spread;
}

std::vector<bool> drawn_beyond(const Linearised& at) {
  std::vector<bool> beyond = held_at_ends(at);
  for (Index j = 0; j < at.gradient.size(); ++j) {
    if (std::pow(at.gradient[j], 2) <= misfit_of(at) * at.information(j, j))
      beyond[static_cast<std::size_t>(j)] = false;
  }
  return beyond;
}

MatrixXd information_within_ranges(const Linearised& at) {
  MatrixXd information = at.information;
  const VectorXd spread = spread_at_ends(at);
  for (Index j = 0; j < spread.size(); ++j)
    if (spread[j] > 0.0) information(j, j) += misfit_of(at) / std::pow(spread[j], 2);
  return information;
}

void hold(const std::vector<bool>& held, MatrixXd& information, VectorXd& gradient) {
  for (Index j = 0; j < gradient.size(); ++j) {
    if (!held[static_cast<std::size_t>(j)]) continue;
    const double own = information(j, j);
    information.row(j).setZero();
    information.col(j).setZero();
    information(j, j) = own;
    gradient[j] = 0.0;
  }
}

}  // namespace softarm::diagnose
