// Constants that the trials let run into a limit, and what the prior makes of moduli that are not
// identifiable.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "joint_fit.h"
#include "uncertainty.h"

namespace softarm::identify {

/// The fit, how sure it is, and where the constants ran into limits.
struct Solution {
  JointFit fit;
  Uncertainty sure;
  std::vector<std::optional<double>> ran_to;  ///< the limit, per constant
  std::vector<bool> kept;                     ///< put back to its start
};

/// A modulus that the trials hardly determine goes where noise takes it, to a limit even, and takes the gains
/// along. Where it gains nothing by that it keeps its start, and the rest is fitted to that.
/// @param determined_sd as in Options
Solution solve(JointProblem& problem, const std::vector<FreeConstant>& constants,
               const std::vector<trial::StaticFrame>& frames, double determined_sd,
               const std::function<void(int)>& progress);

/// Covariance of the constants given what is at a limit, EI where the trials do not identify it, and EA,
/// which the prior has by itself: the gains that go with EI would be as wide as it, and the prior, which
/// counts moment and EI one by one, would say nothing of either.
Eigen::MatrixXd covariance_given_moduli(const Result& result);

/// EI as the arm file has it where it ran into a limit or was not fitted; EA as the trials say it, else as
/// the arm file has it.
void prior_of_moduli(const arm::Arm& arm, Result& result);

}  // namespace softarm::identify
