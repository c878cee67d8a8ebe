// A discovered law in words.
#pragma once

#include <string>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// "chamber_2 less what follows it in 1 s", of a term's values (effects::learned_moment()).
std::string goes_with(const arm::Arm& arm, const model::Values& values);

/// The term with its numbers, as an equation and as a sentence.
/// @param sd_nm of the two sizes
LawTerm law_term(const arm::Arm& arm, const model::Values& values, const Eigen::Vector2d& sd_nm,
                 double stability);

/// What it goes with, what it takes, and what it resembles.
std::string sentence_of(const DiscoveredLaw& law);

}  // namespace softarm::diagnose
