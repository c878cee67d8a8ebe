// Which change, and where, explains an innovation best.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "math/linear_algebra.h"
#include "monitor_shape.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::monitor {

/// One kind of change at one place.
struct ChangeHypothesis {
  ChangeKind kind = ChangeKind::kUnclear;
  int index = 0;  ///< body or segment
  double s_from_m = 0.0, s_to_m = 0.0;
  double likelihood = 0.0;    ///< twice the gain of the log likelihood
  double penalised = 0.0;     ///< the same less what its number of free values would gain by chance
  Eigen::MatrixXd signature;  ///< displacements of the bodies per unit
  Eigen::VectorXd amplitude;  ///< most likely
};

/// A generalised likelihood ratio test of all changes against none.
class ChangeTest {
 public:
  explicit ChangeTest(const arm::Arm& arm);

  /// @param factor of the innovation's covariance
  /// @return the likeliest change. Its total is that of any change at all
  const ChangeHypothesis& best(const MonitorShape& shape, const Displacements& innovation,
                               const math::CholeskyFactor& factor, const std::vector<char>& usable);
  /// The best of another kind than the winner's; null where there is none.
  const ChangeHypothesis* runner_up() const;
  /// Interval of places that the winner's kind explains nearly as well.
  void widen(ChangeHypothesis& winner) const;

 private:
  void signature(const MonitorShape& shape, ChangeHypothesis& hypothesis) const;

  std::vector<ChangeHypothesis> hypotheses_;
  std::size_t best_ = 0;
  Eigen::MatrixXd whitened_;
};

}  // namespace softarm::monitor
