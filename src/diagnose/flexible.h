// What a flexible model could make of the residuals: the ceiling of what can be explained.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// A Gaussian process from what drives the arm (inputs, their speeds, past and plays, payload, attitude,
/// time) to the residuals of all bodies, learnt on some input sequences and tried on the others, by turns.
/// Which of these it goes by, its reach and its noise are those that do best among the trials that it learns
/// from.
/// @param residual by trial, m, as Unseen::residual
/// @return the share of their mean square that is gone once what it learnt from other trials is taken off; 0
/// of too few instants, or of one trial
double ceiling(const JointModel& model, const Linearised& at, const std::vector<Eigen::VectorXd>& residual,
               unsigned jobs);

/// Residuals, as of ceiling(), and the fit that they are of.
struct Unexplained {
  const Linearised& at;
  const std::vector<Eigen::VectorXd>& residual;
};
/// ceiling() of each: for little more than that of one where the same drives the arm in their fits.
std::vector<double> ceilings(const JointModel& model, const std::vector<Unexplained>& list, unsigned jobs);

/// What the process knows of each block: one row per used block; names of the columns.
struct Features {
  Eigen::MatrixXd values;
  std::vector<std::string> names;
  std::vector<std::size_t> trial, block;
};
Features features(const JointModel& model, const Linearised& at);

/// Columns as multiples of their spread about their mean; 0 where nothing varies.
Eigen::MatrixXd in_spreads(Eigen::MatrixXd values);
/// Mean over the columns of the squared differences of rows: n x n.
Eigen::MatrixXd mean_distances2(const Eigen::MatrixXd& values);

}  // namespace softarm::diagnose
