// Residuals and signatures at instants that show the whole arm: what the posterior is worked out from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// One column of the linearised model, at all instants.
struct Signature {
  const model::Effect* effect = nullptr;  ///< null: one of the fit's own unknowns
  double mean = 0.0, prior_sd = 1.0;      ///< of its coefficient, before these data
  Eigen::MatrixXd moves;                  ///< n x m, by which a coefficient of 1 moves what is seen
  /// Of an effect: by how much of the arm's length a coefficient of 1 moves the bodies beyond what the
  /// unknowns of the fit absorb, rms.
  double left = 0.0;
  /// Of an effect that is not there: standard deviation of what is not known of it in any arm, usual sizes.
  double unknown_sd = 0.0;
  double log_weight = 0.0;  ///< of an unknown at an end of its range: share of what was possible beforehand
  /// Of an effect: of how many chambers, bodies or kinds (all that its numbers count) it might be, each as
  /// probable beforehand. It is looked for in all of them, and the one that suits the data best is in the
  /// model.
  double log_choices = 0.0;
};

/// As how many an effect counts before the data: clocks of other rates are apart besides, as those that keep
/// their offset are.
inline double counts_as(const model::Effect& effect) {
  return effect.info().of_clock_rates ? 2.0 : 1.0;
}

/// n groups of neighbouring instants that show all bodies and tangents, m numbers each, whitened by the
/// noise.
struct EvidenceData {
  Eigen::MatrixXd residual;         ///< n x m, measured less modelled by the fit
  std::vector<Signature> unknowns;  ///< of the fit
  std::vector<Signature> effects;   ///< that are not in it, one per size; coefficients in usual sizes
  /// n x m each, of the effects of the fit: by what each moves what is seen beyond what the other unknowns
  /// absorb.
  std::vector<Eigen::MatrixXd> done;
  Eigen::MatrixXd features;        ///< n x f, of what drives the arm, as multiples of their spread
  Eigen::VectorXd t_s;             ///< in the trial
  std::vector<std::size_t> trial;  ///< of each instant
};

/// Of what inertia does to an arm that swings in its modes a share is not known in any arm, and that is the
/// same at all instants.
/// @param share that is not known; JointModel::unknown_inertia()
/// @return its standard deviation, in steps of such values of the effect; 0 where they move no mass
double unknown_sd(double share, const model::Effect& effect, const model::Values& step);

/// One size of an effect alone, for a difference from none.
struct SizeStep {
  model::Present present;
  double step = 0.0;  ///< usual sizes
};
/// Of all sizes of effects at the values that the data say so far: effects are not linear, and the difference
/// goes as far as these do.
std::vector<SizeStep> size_steps(const std::vector<model::Present>& candidates);

/// Signatures of such steps over a trial's rows, by usual sizes: one column each, whitened and weighted as
/// the fit's residuals are.
Eigen::MatrixXd signatures_of(JointModel& model, const Linearised& at, std::size_t trial,
                              const std::vector<SizeStep>& steps);

/// @param at is completed (JointModel::complete)
/// @param candidates effects at the values that the data say so far, of which signatures are wanted
EvidenceData evidence_data(JointModel& model, Linearised& at, const std::vector<model::Present>& candidates,
                           unsigned jobs);

/// The same instants, and Huber's weights, as of `like`, by another fit: without candidates and features.
EvidenceData evidence_of_refit(const JointModel& model, const Linearised& refit, const Linearised& like);

/// The same with the candidates that are not in it, by their signatures about it.
/// @param refit is completed
EvidenceData evidence_of_refit(JointModel& model, Linearised& refit, const Linearised& like,
                               const std::vector<model::Present>& candidates, unsigned jobs);

/// How far an effect that is not in a fit can do what one of the fit does.
struct Alike {
  const model::Effect* effect = nullptr;
  double correlation = 0.0;  ///< 0 ... 1, of what both move beyond what the fit's other unknowns absorb
};
/// @param data about the fit
/// @param effect of the fit
/// @return each of data.effects once
std::vector<Alike> alike_to(const Linearised& at, const EvidenceData& data, std::size_t effect);

}  // namespace softarm::diagnose
