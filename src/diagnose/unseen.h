// Errors on trials that a fit has not seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// Each trial by a fit without it, without those that were driven by the same commands, and, where there are
/// several sessions, without those of its session.
struct Unseen {
  std::vector<double> chi2;                 ///< by trial, Huber's weights
  std::vector<Eigen::VectorXd> residual;    ///< by trial: measured less modelled, m; 0 where not used
  std::vector<double> rms_m;                ///< by trial, of a body's mean position; weighted by precision
  std::vector<double> mean_of_m, max_of_m;  ///< by trial, of the distances of all bodies, unweighted
  double total_chi2 = 0.0;
  double total_rms_m = 0.0, fitted_rms_m = 0.0;
  double mean_m = 0.0, max_m = 0.0;  ///< distances of all bodies, unweighted
  double plain_rms_m = 0.0, fitted_plain_rms_m = 0.0;
  std::size_t refits = 0;  ///< of refitted_unseen(): fits made anew
};

/// How far the fit's unknowns lie apart where one fold of trials after the other is left out, to first order.
/// All by unknown.
struct Spread {
  /// Of what all trials together say: the jackknife for folds of which some know more than others (Wu 1986,
  /// doi:10.1214/aos/1176350142). Each deviation counts by the share of what is known of the unknown that the
  /// other folds hold: what acts in one trial alone is not contradicted by those in which it cannot be seen.
  Eigen::VectorXd variance;
  /// What is to be expected of it, in variances of the unknown: 1 where the trials alone tell it, 0 where
  /// they say nothing beside what was known beforehand, or where it is held.
  Eigen::VectorXd expected;
  /// Degrees of freedom (Satterthwaite): one less than folds where all know alike much.
  Eigen::VectorXd freedom;
};
/// A trial has a sequence and a session.
struct Spreads {
  Spread by_sequence, by_session, by_both;  ///< each empty where folds are too few
};

/// @param held unknowns that stay as they are in all fits
/// @return of two sequences or more, and of three sessions or more; of one sequence the trials count as
///         sequences do
Spreads between_folds(const JointModel& model, const Linearised& at, const std::vector<bool>& held);
/// @param sequence, session by trial
Spreads between_folds(const Linearised& at, const std::vector<std::size_t>& sequence,
                      const std::vector<std::size_t>& session, const std::vector<bool>& held);

/// To first order about the fit to all.
Unseen unseen(const JointModel& model, const Linearised& at);

/// By the model itself at the constants and sizes that the other trials have. They are fitted anew where what
/// they make of the unseen trials is not what the first order about the fit to all expects.
Unseen refitted_unseen(JointModel& model, const Linearised& at);

/// Errors of residuals by trial, whitened and weighted as the fit's are.
Unseen summed(const JointModel& model, const Linearised& at, const std::vector<Eigen::VectorXd>& residual);

/// Trials that are predicted by one and the same fit to the others.
struct Fold {
  std::vector<bool> without;       ///< by trial
  std::vector<std::size_t> tried;  ///< trials
};
std::vector<Fold> unseen_folds(const JointModel& model);

/// For each trial the number of its session, from 0 on: sessions are trials without a pause
/// (Policy::Unseen::session_pause_s) between their beginnings.
/// @param session_s by trial: when it began
std::vector<std::size_t> sessions_of(const std::vector<double>& session_s);

/// For each trial, which ones it is predicted without. Itself; those of its input sequence, where there is
/// another one; those of its session, where there are so many (Policy::Unseen) that the others tell what the
/// arm is like.
/// @param sequence by trial
/// @param session_s by trial: when it began
std::vector<std::vector<bool>> predicted_without(const std::vector<std::size_t>& sequence,
                                                 const std::vector<double>& session_s);

}  // namespace softarm::diagnose
