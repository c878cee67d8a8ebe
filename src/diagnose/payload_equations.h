// Normal equations of a fit, with payloads that were not told and where what hangs is off its axis.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "joint_model.h"
#include "payload_moves.h"

namespace softarm::diagnose {

/// Of what hangs beside what was told, over the usual payload.
struct Span {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  double exchanged = 0.0;  ///< of two that have each other's: just that; else 0
};

/// Normal equations of the constants, of payloads beside what was told, over the usual one, and of where what
/// hangs is off its axis, m.
class PayloadEquations {
 public:
  /// @param offset_sd_m as which a payload may be off its axis
  PayloadEquations(const Linearised& at, ToldSums told, double offset_sd_m);

  struct Gain {
    double fall = 0.0;  ///< of chi^2, beside what was told off its axis
    double more = 0.0;
  };
  /// With one payload more, within what can hang there, which hangs where all others do.
  Gain gain(const PayloadSums& sums, const Span& span) const;
  /// Of a part of a fall of chi^2: what falls does not count as scatter.
  double z(double part, double fall) const;
  /// @param already of it, in the fit and in what counts as told
  /// @param beside of it, found beside what counts as told
  void add(const PayloadSums& sums, double already, double beside, const Span& span);
  /// By which all that hangs is off its axis.
  const Offsets& offset_m() const { return offset_m_; }
  /// Of the payload that was added so many after the first.
  double more(std::size_t payload) const { return all_move_[place(payload)]; }
  double sd(std::size_t payload) const;

 private:
  static constexpr int kGainSteps = 30, kGainBits = 10;
  static constexpr double kUsualTimes = 2.0;
  static constexpr double kLeastLeft = 1e-3;  // of chi^2: rounding
  static constexpr double kHeld = 1e-4;       // sd of a payload that is known, over the usual one

  Eigen::Index constants() const { return static_cast<Eigen::Index>(held_.size()); }
  Eigen::Index place(std::size_t payload) const { return constants() + static_cast<Eigen::Index>(payload); }
  /// Fall of chi^2 with so much more, and all off their axis where that is most.
  double fall_of(const Eigen::Matrix<double, kMoves, kMoves>& own, const Moves& score, double more,
                 const Span& span) const;
  /// With the unknowns so far: the constants, and payloads of other trials, which it has nothing to do with.
  Eigen::MatrixXd column(const PayloadSums& sums) const;
  void solve();

  const std::vector<bool> held_;  ///< constants
  const double inflation_, square_, before_;
  ToldSums told_;  ///< rows: constants, payloads
  Eigen::MatrixXd information_, covariance_, with_told_, all_covariance_;
  Eigen::VectorXd gradient_, move_, all_move_;
  Offsets offset_m_;
  double off_axis_ = 0.0;  ///< fall of chi^2 where what was told is off its axis
};

/// What hangs is off its axis in a fit by so much.
Eigen::Vector3d offset_in(const Linearised& at);

/// The fit, under payloads that were found, with what hangs off its axis: by first order that is far off.
Linearised off_axis_by(const Eigen::Vector3d& offset_m, JointModel& model, Linearised at);

}  // namespace softarm::diagnose
