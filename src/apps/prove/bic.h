// The Bayesian information criterion of effects together: on the signatures, the noise and the background
// that the diagnosis has.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnose/evidence.h"
#include "diagnose/posterior.h"

namespace softarm::prove {

/// What effects must be worth: ln(n) for each of their numbers that was fitted, and their odds before the
/// data, which are those of the diagnosis.
double price(const diagnose::EvidenceData& data, const diagnose::EffectList& effects);

/// By coefficient, unknowns of the fit, then effects: whether it is a size of one of these.
std::vector<bool> sizes_of(const diagnose::EvidenceData& data, const diagnose::EffectList& effects);

/// -2 log likelihood, but for the 2 pi, with the `free` coefficients at their most probable values; the
/// others, constants of the arm and the background of all other effects, are integrated out.
double deviance(const diagnose::EvidenceData& data, const diagnose::NormalEquations& sums,
                const std::vector<bool>& free, double background);

/// Residual and signatures of effects under one noise, with constants and background integrated out: a sum of
/// squares is residual^2 - 2 score . x + x . gram x.
struct Grouped {
  diagnose::EffectList effects;
  std::vector<std::vector<Eigen::Index>> columns;  ///< by effect, of what follows: its sizes
  Eigen::MatrixXd gram;
  Eigen::VectorXd score;
};

/// Effects together, and what they are worth; models of least `bic` are best.
struct Weighed {
  diagnose::EffectList effects;
  double bic = 0.0, background = 0.0;
  std::vector<diagnose::DirectionNoise> noise;
  Eigen::VectorXd coefficients =
      {};  ///< of that linear model: most probable, of unknowns, then sizes of effects
};

/// Sets in proportion to exp(-bic / 2): each set once, at its least.
diagnose::Posterior weights(const std::vector<Weighed>& models);

class Bic {
 public:
  /// @param data kPolicy.posterior.fewest_instants at least
  explicit Bic(diagnose::EvidenceData data);

  const diagnose::EvidenceData& data() const { return data_; }
  /// Those that would move the bodies by what matters, at the largest sizes that are expected.
  const diagnose::EffectList& candidates() const { return candidates_; }
  const Weighed& none() const { return none_; }
  /// To first order about the fit, under the noise of none.
  double rough(const diagnose::EffectList& effects) const;
  /// The same under noise of their own.
  Weighed linear(const diagnose::EffectList& effects) const;
  /// About a fit with these effects.
  /// @param refit evidence_of_refit() with the weights of the fit without
  /// @param own by unknown of that fit: whether it is a number of theirs
  Weighed refitted(const diagnose::EffectList& effects, diagnose::EvidenceData refit,
                   const std::vector<bool>& own) const;
  /// By how much the BIC of such a fit rises without each of its effects, the others as they come then; under
  /// the noise of all. Below 0: it is not worth its numbers.
  /// @param owner by unknown: the place in `effects` of the effect that it is a number of; -1: of none
  /// @param absent by unknown: the step at which it is held without its effect: of a size that to 0, of other
  /// numbers, which then say nothing, none
  std::vector<double> supports(const diagnose::EffectList& effects, diagnose::EvidenceData refit,
                               const std::vector<int>& owner, const Eigen::VectorXd& absent) const;
  /// The candidates, under the noise of none.
  Grouped grouped() const;

 private:
  /// The effects of the data that are not among these: their background is part of the refit's.
  void add_background(const diagnose::EffectList& effects, diagnose::EvidenceData& refit) const;
  Weighed weighed(const diagnose::EvidenceData& data, const diagnose::LinearGaussianModel& linear,
                  const diagnose::EffectList& beside, std::vector<bool> free, Weighed from) const;

  const diagnose::EvidenceData data_;
  const diagnose::Bases bases_;
  const diagnose::LinearGaussianModel linear_;
  diagnose::EffectList candidates_;
  Weighed none_;
  diagnose::NormalEquations sums_;  ///< under the noise of none
};

}  // namespace softarm::prove
