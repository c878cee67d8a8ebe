#include "ranges.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "math/linear_algebra.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAtEnd = 1e-9;   // of an unknown's scale: the rounding of a value that was set to its end
constexpr double kDrawn = 1e-9;   // of the gradient that the whole move overcomes: what is less is rounding
constexpr Index kMostRounds = 4;  // per unknown

/// The least where some unknowns stay as they are.
VectorXd least_beside(const MatrixXd& information, const VectorXd& gradient, const std::vector<bool>& fixed,
                      const VectorXd& move) {
  MatrixXd h = information;
  VectorXd g = gradient;
  for (Index j = 0; j < g.size(); ++j)
    if (fixed[static_cast<std::size_t>(j)]) g -= information.col(j) * move[j];
  hold(fixed, h, g);
  VectorXd to = math::solve_symmetric(h, g);
  for (Index j = 0; j < g.size(); ++j)
    if (fixed[static_cast<std::size_t>(j)]) to[j] = move[j];
  return to;
}

/// Goes as far to there as the rooms let it, and fixes the unknown that comes to its end first.
/// @return whether none did
bool go_within(const std::vector<Room>& rooms, const VectorXd& to, std::vector<bool>& fixed, VectorXd& move) {
  double share = 1.0;
  Index ends = -1;
  for (Index j = 0; j < to.size(); ++j) {
    const auto u = static_cast<std::size_t>(j);
    const double limit = std::clamp(to[j], rooms[u].low, rooms[u].high);
    if (fixed[u] || limit == to[j]) continue;
    const double own = (limit - move[j]) / (to[j] - move[j]);
    if (own > share) continue;
    share = own;
    ends = j;
  }
  if (ends < 0) {
    move = to;
    return true;
  }
  move += std::max(0.0, share) * (to - move);
  const auto u = static_cast<std::size_t>(ends);
  fixed[u] = true;
  move[ends] = std::clamp(to[ends], rooms[u].low, rooms[u].high);
  return false;
}

/// Of those at their ends the one that is drawn back into its room most.
/// @param left of the gradient
std::optional<Index> drawn_inward(const VectorXd& left, const MatrixXd& information,
                                  const std::vector<Room>& rooms, const std::vector<bool>& fixed,
                                  const VectorXd& move) {
  std::optional<Index> most;
  double drawn = 0.0;
  for (Index j = 0; j < left.size(); ++j) {
    const auto u = static_cast<std::size_t>(j);
    if (!fixed[u] || !(rooms[u].high > rooms[u].low)) continue;
    const double inward = (move[j] <= rooms[u].low ? left[j] : -left[j]) / std::sqrt(information(j, j));
    const double rounding =
        kDrawn * information.col(j).cwiseAbs().dot(move.cwiseAbs()) / std::sqrt(information(j, j));
    if (!(inward > rounding) || !(inward > drawn)) continue;
    drawn = inward;
    most = j;
  }
  return most;
}

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
  const Index count = gradient.size();
  std::vector<bool> fixed(static_cast<std::size_t>(count), false);
  move = VectorXd::Zero(count);
  // Each round fixes an unknown or lets one go. What is left falls with each that is let go, so that none are
  // fixed alike twice but by rounding: hence a bound.
  for (Index rounds = 0; rounds < kMostRounds * (1 + count); ++rounds) {
    if (!go_within(rooms, least_beside(information, gradient, fixed, move), fixed, move)) continue;
    const std::optional<Index> inward =
        drawn_inward(gradient - information * move, information, rooms, fixed, move);
    if (!inward) break;
    fixed[static_cast<std::size_t>(*inward)] = false;
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
