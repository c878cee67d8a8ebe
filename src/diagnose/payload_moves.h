// What payloads that were not told would move, and its sums with what the constants do.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// A stretch of a trial: from some time on, or up to one, or all of it.
struct TrialStretch {
  std::size_t trial = 0;
  std::size_t first = 0, last = 0;  ///< blocks [first, last)
  double sign = 1.0;                ///< -1: so much less hangs there
};

/// Of a payload over the usual one, and of that one a metre off its axis: x, y, z.
constexpr Eigen::Index kMoves = 4, kOffsets = 3;
using Moves = Eigen::Matrix<double, kMoves, 1>;
using Offsets = Eigen::Matrix<double, kOffsets, 1>;

/// Sums over stretches of trials: of moves [m b], m by the usual payload and b by that one off its axis, with
/// the derivatives J by the constants, with residuals, with themselves, and with w b, w what was told there.
struct PayloadSums {
  explicit PayloadSums(Eigen::Index constants) : mixed(Eigen::MatrixXd::Zero(constants, kMoves)) {}
  Eigen::MatrixXd mixed;  ///< J^T [m b]
  Moves score = Moves::Zero();
  Eigen::Matrix<double, kMoves, kMoves> own = decltype(own)::Zero();
  Eigen::Matrix<double, kOffsets, kMoves> with_told = decltype(with_told)::Zero();

  /// Those of another stretch, in which it hangs with this sign.
  void add(double sign, const PayloadSums& other) {
    mixed += sign * other.mixed;
    score += sign * other.score;
    own += other.own;
    with_told += sign * other.with_told;
  }
};

/// Sums over all trials of w b: what was told hangs off its axis.
struct ToldSums {
  explicit ToldSums(Eigen::Index constants) : mixed(Eigen::MatrixXd::Zero(constants, kOffsets)) {}
  Eigen::MatrixXd mixed;
  Offsets score = Offsets::Zero();
  Eigen::Matrix<double, kOffsets, kOffsets> own = decltype(own)::Zero();
};

/// Sums of one trial up to each of its blocks.
class PayloadSumsTo {
 public:
  /// @param moves of [m b], four columns
  PayloadSumsTo(const Linearised& at, const model::TrialData& trial, std::size_t t,
                const Eigen::MatrixXd& moves, double usual_kg);
  /// Of a stretch of blocks [first, last): adds it.
  void add_between(std::size_t first, std::size_t last, double sign, PayloadSums& sums) const;
  const ToldSums& told() const { return told_; }

 private:
  std::vector<PayloadSums> to_;
  ToldSums told_;
};

/// Sums of all trials.
class PayloadSumsOf {
 public:
  PayloadSumsOf(JointModel& model, const Linearised& at, double usual_kg);
  PayloadSums over(const std::vector<TrialStretch>& where) const;
  ToldSums told() const;

 private:
  Eigen::Index constants_;
  std::vector<PayloadSumsTo> trials_;
};

}  // namespace softarm::diagnose
