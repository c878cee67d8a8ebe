// How well a frame determines its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problem.h"
#include "softarm/estimate/estimator.h"

namespace softarm::estimate {

/// Covariance of the fit's parameters x; rows and columns of what is fixed or undetermined are zero.
struct Covariance {
  Eigen::MatrixXd x;
  std::vector<bool> determined;
  bool shape_determined = true;  ///< curvature and length of every segment are: else there are too few bodies
};

/// At the last evaluation of the problem. For weights other than those of the noise, and for the sum of
/// distances, it is that of the estimator used (sandwich), not that of the best one.
Covariance covariance(const Problem& problem, const std::vector<bool>& free,
                      const arm::EstimatorOptions& options);

/// That of parameters with this information (and, where it is another, variance of its gradient).
Covariance covariance_from(const Eigen::MatrixXd& information, const std::vector<bool>& free,
                           const Eigen::MatrixXd* variance = nullptr);

/// What the bodies in use say of x at the last evaluation, by the stated noise: Gauss-Newton information and
/// information times optimum. Columns of what is fixed are zero.
Evidence evidence(const Problem& problem, const Eigen::VectorXd& x);

/// By how much less the bodies' chi-square is, by the stated noise, with the most probable errors that they
/// have in common.
double by_common_errors(const Problem& problem);

/// Number of parameters that the bodies determine, the rest being believed: trace of the share of the
/// information that is theirs.
double determined_by_bodies(const Problem& problem, const Eigen::VectorXd& x);

/// What intervals are made of, and what of it scatters from frame to frame and so biases EI and M0.
struct Spread {
  const Covariance& covariance;
  const Eigen::MatrixXd& scatter;
};

/// Translates parameters and covariance into a segment's estimate.
/// @param free the parameters that were estimated
/// @param believed_information on the segment's flexibility by the laws as a prior; 0: none
void fill_segment(const Problem& problem, int segment, const Eigen::VectorXd& x, const Spread& spread,
                  const std::vector<bool>& free, double believed_information,
                  const arm::EstimatorOptions& options, SegmentEstimate& out);

}  // namespace softarm::estimate
