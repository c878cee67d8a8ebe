// Bodies that have one another's names.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "model/prepared_trial.h"
#include "softarm/arm/arm.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// In which trials rings stand along the arm in another order than the arm file says, and in which. No effect
/// of the arm, and nothing that is said beside it means anything.
/// @return nothing where they stand as they should
std::optional<ExchangedNames> exchanged_names(const arm::Arm& arm,
                                              const std::vector<model::TrialData>& trials);

/// In a sentence or two.
/// @param trials how many there are
std::string sentence_of(const ExchangedNames& names, std::size_t trials);

}  // namespace softarm::diagnose
