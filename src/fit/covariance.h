// What a frame tells of its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problem.h"
#include "softarm/fit/estimate.h"

namespace softarm::fit {

/// Covariance of the fit's parameters x; rows and columns of what is fixed or undetermined are zero.
struct Covariance {
  Eigen::MatrixXd x;
  std::vector<bool> determined;
  bool shape_determined = true;  ///< curvature and length of every segment are: else there are too few bodies
};

/// At the last evaluation of the problem. For weights other than those of the noise, and for the sum of
/// distances, it is that of the estimator used (sandwich), not that of the best one.
Covariance covariance(const Problem& problem, const std::vector<bool>& free, const EstimatorOptions& options,
                      const Eigen::VectorXd& x);

/// Translates parameters and covariance into a segment's estimate.
/// @param free the parameters that were estimated
void fill_segment(const Problem& problem, int segment, const Eigen::VectorXd& x, const Covariance& covariance,
                  const std::vector<bool>& free, const EstimatorOptions& options, SegmentEstimate& out);

}  // namespace softarm::fit
