// Terms of a law against what a fit leaves: sums of squares and products.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace softarm::diagnose {

/// One linear problem: residuals by offsets of single trials, by the unknowns of the fit, and by terms with
/// two sizes each. Columns in this order; the last one is the residual.
struct LawSums {
  Eigen::Index offsets = 0, unknowns = 0, terms = 0;
  Eigen::VectorXd precision;        ///< of offsets, then of unknowns, about 0
  double size_precision = 0.0;      ///< of sizes of terms, about 0
  std::vector<std::size_t> trial;   ///< of each unit
  std::vector<Eigen::MatrixXd> of;  ///< by unit: the columns' products
  Eigen::Index first(Eigen::Index term) const { return offsets + unknowns + 2 * term; }
};

/// What is left of the terms' columns and of the residual when offsets and unknowns have taken theirs.
struct Reduced {
  Eigen::MatrixXd products;  ///< of the terms' columns
  Eigen::VectorXd score;     ///< their products with the residual
  Eigen::VectorXd whole;     ///< squares of the columns before that
};
/// @param use which units
Reduced reduce(const LawSums& sums, const std::vector<bool>& use);

/// Trials in groups, those that are predicted together.
using Folds = std::vector<std::vector<std::size_t>>;

/// The units of the trials in the folds.
std::vector<bool> units_of(const LawSums& sums, const Folds& folds);

/// How chi^2 of trials falls for which others have found the sizes and the unknowns.
/// @param chosen of the terms
double held_out_gain(const LawSums& sums, const std::vector<Eigen::Index>& chosen, const Folds& folds);

/// Sizes of the chosen terms together, in usual ones, from the trials in the folds.
Eigen::VectorXd sizes_of(const LawSums& sums, const std::vector<Eigen::Index>& chosen, const Folds& folds);

}  // namespace softarm::diagnose
