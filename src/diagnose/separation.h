// How far apart two fitted models are on trials, recorded or not, once one of them is fitted to the other.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// One explanation of the trials: a whole model, with what it predicts for them.
struct Explanation {
  std::string id;  ///< of the effect that it has and the others have not
  Linearised fit;  ///< to the trials that there are
};

/// Sums over trials for bringing two models together: the unknowns are those of the one that is true, then
/// those of the one that is fitted to it.
struct DifferenceSums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double square = 0.0;

  DifferenceSums& operator+=(const DifferenceSums& other);
};

/// @param truth, fitted two models of the same trials
DifferenceSums sums_between(const JointModel& model, const Linearised& truth, const Linearised& fitted);

/// chi^2 that is left when all unknowns have moved, within their ranges, to where it is least. Those of the
/// true model move as far as its own fit leaves them open, at the price of that: what is not known of the
/// truth is not to be promised.
/// @param truth, fitted to the trials that there are
double least_square(const DifferenceSums& sums, const Linearised& truth, const Linearised& fitted);

/// The same with the true model held.
/// @param step by which the other one's unknowns move, in scales
double least_square_held(const DifferenceSums& sums, const Linearised& fitted, Eigen::VectorXd& step);

/// Blocks of all trials in which the arm has an equilibrium.
std::size_t with_equilibrium(const Linearised& at);

/// A model with another effect, brought as near to what `truth` predicts as a few steps get it.
Linearised fitted_to(JointModel& model, const Linearised& truth, JointParameters start, int steps);

}  // namespace softarm::diagnose
