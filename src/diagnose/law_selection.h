// Which terms a law has: stability selection over the resampled trials.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "law_sums.h"

namespace softarm::diagnose {

/// A term with the share of the resamples in which it, or one that stands for it, was chosen.
struct StableTerm {
  Eigen::Index term = 0;
  double stability = 0.0;
};

/// Halves of the units are drawn again and again. In each the terms that explain most are chosen, one upon
/// the other, both sizes of one at once. Of those that most halves agree on (Meinshausen and Buhlmann 2010)
/// the ones that explain most of all units are kept, while each adds to what is explained in folds of trials
/// that were left out.
/// @param folds of the trials that are looked at; others are not
std::vector<StableTerm> stable_terms(const LawSums& sums, const Folds& folds, unsigned jobs);

}  // namespace softarm::diagnose
