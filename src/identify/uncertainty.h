// How sure the trials make us of the constants.
#pragma once

#include <Eigen/Core>
#include <map>

#include "joint_fit.h"

namespace softarm::identify {

/// Everything in the scaled constants x of JointProblem.
struct Uncertainty {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd direction_sd;  ///< of the eigenvectors, largest first
  Eigen::MatrixXd directions;    ///< eigenvectors of the information, one column each
  /// Of how trials found walls and effects, over the standard deviations expected; for these constants.
  std::map<std::size_t, Eigen::VectorXd> start_sd;
  double misfit = 0.0;  ///< sqrt(chi^2 / dof)
  double chi2 = 0.0;
  double position_rms_m = 0.0;  ///< per coordinate
  double autocorrelation = 1.0;
  double factor = 1.0;  ///< of standard deviations against noise alone
};

/// At the fit's last evaluation.
Uncertainty uncertainty(const JointProblem& problem, const std::vector<trial::StaticFrame>& frames,
                        int constants);

}  // namespace softarm::identify
