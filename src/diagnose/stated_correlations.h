// Correlations as a file states them.
#pragma once

#include <Eigen/Core>

namespace softarm::diagnose {

/// Correlations that say the same with fewer and shorter numbers: to as few digits as leave the variance of
/// every mixture of the numbers nearly as it is, and without those that are small to these digits. Numbers of
/// which a mixture is known exactly need many digits, others two.
/// @param correlations symmetric, 1 on the diagonal
/// @return a matrix of the same kind, positive definite; 0 where a correlation is left out
Eigen::MatrixXd stated_correlations(const Eigen::MatrixXd& correlations);

}  // namespace softarm::diagnose
