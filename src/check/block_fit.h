// Least squares with residuals that are one within stretches of time.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace softarm::check {

/// Places as a sum of functions of time.
struct BlockFit {
  Eigen::MatrixXd x;                        ///< coefficients x coordinates: m per unit of the function
  Eigen::MatrixXd left;                     ///< rows x coordinates, m: what the functions leave
  std::vector<Eigen::MatrixXd> covariance;  ///< of each coefficient, coordinates x coordinates
};

/// Residuals of one block are taken for one: what they do to the coefficients is summed within a block before
/// it is squared.
/// @param functions rows x coefficients, each of order 1
/// @param places rows x coordinates, m
/// @param block of each row; those of one block follow each other
BlockFit fit_in_blocks(const Eigen::MatrixXd& functions, const Eigen::MatrixXd& places,
                       const std::vector<int>& block);

}  // namespace softarm::check
