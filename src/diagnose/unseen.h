// Errors on trials that a fit has not seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// Each trial by the fit to the others, to first order about the fit to all.
struct Unseen {
  std::vector<double> chi2;                 ///< by trial, Huber's weights
  std::vector<Eigen::VectorXd> residual;    ///< by trial: measured less modelled, m; 0 where not used
  std::vector<double> rms_m;                ///< by trial, of a body's mean position; weighted by precision
  std::vector<double> mean_of_m, max_of_m;  ///< by trial, of the distances of all bodies, unweighted
  double total_chi2 = 0.0;
  double total_rms_m = 0.0, fitted_rms_m = 0.0;
  double mean_m = 0.0, max_m = 0.0;  ///< distances of all bodies, unweighted
};
Unseen unseen(const JointModel& model, const Linearised& at);

}  // namespace softarm::diagnose
