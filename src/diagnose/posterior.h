// How sure: the probability of every effect, all at once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "evidence.h"

namespace softarm::diagnose {

/// Effects of the catalogue that are there together, and how probable just these are.
struct EffectSet {
  EffectList effects;
  double probability = 0.0;  ///< averaged over resamples of the trials
};

struct Posterior {
  std::vector<EffectSet> sets;  ///< that were looked at, most probable first; they sum to 1
  double background = 0.0;      ///< share of the arm's length by which what is not there moves it: mean
  /// Of the fit's unknowns, in their scales: how far the most probable ones lie from the fit's, with the
  /// background, correlated noise and the sets that the fit stands for; empty: too few instants.
  Gaussian unknowns;
  std::vector<Gaussian> on_its_law;  ///< the same for each effect of the fit, as if it had no other form

  /// Of an effect, whatever else is there.
  double of(const model::Effect* effect) const;
  /// That at least one of these is there.
  double of_any(const EffectList& effects) const;
  /// That `other` is there and `effect` is not.
  double instead(const model::Effect* other, const model::Effect* effect) const;
};

/// A fit with one effect more, at the same instants.
struct RefitEvidence {
  const model::Effect* effect = nullptr;
  /// evidence_of_refit(): the effect's own numbers are among the unknowns. Other effects, where it has none,
  /// move the bodies as they do about the fit without it.
  EvidenceData data;
};

/// Spike and slab over the catalogue (George and McCulloch 1993; Ishwaran and Rao 2005), linear about a fit.
/// An effect that is there has sizes of N(0, prior_sd^2); one that is not has a background's, by which it
/// moves the bodies as far as all others do, unknown how far: everything is a little wrong. The fit's
/// unknowns are free within their priors. What is left is correlated: each principal direction of what is
/// seen has noise of its own, white and a Gaussian process over what drives the arm, or over time, whose
/// shares and sizes are those of greatest likelihood under each set. All coefficients are integrated out.
/// Sets grow from the best by one effect at a time. Effects are not linear: sets with one that was refitted
/// are judged about its own fit (Laplace), those with several about the fit of theirs that suits them best.
/// Sets are found by all trials; how probable each is, is averaged over resamples
/// (averaged_over_resamples()).
Posterior posterior(const EvidenceData& data, const std::vector<RefitEvidence>& refits, unsigned jobs);

}  // namespace softarm::diagnose
