// The terms that a discovered law may have, about a fit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"
#include "law_sums.h"

namespace softarm::diagnose {

/// The terms' signatures about a fit: the rod's derivatives by moments of its pieces, times those moments.
/// How the arm swings with them is left out: true refits judge.
struct LawDesign {
  std::vector<model::Values> terms;  ///< with ranges, without sizes
  /// By trial, rows as Linearised::residual, columns as LawSums: with sizes in usual ones.
  std::vector<Eigen::MatrixXd> columns;
  LawSums sums;  ///< a unit per trial, or per stretch of two seconds where there are few
};
/// @param at is completed here
LawDesign law_design(JointModel& model, Linearised& at, unsigned jobs);

}  // namespace softarm::diagnose
