// A second diagnosis, under the payloads that trials say themselves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "conclusion.h"
#include "payload_search.h"

namespace softarm::diagnose {

/// What the fits of trials as they were told say that hung on the arm.
OtherPayloads payloads_that_trials_say(const arm::Arm& arm, const model::Prepared& prepared, Begun& as_told);

/// What trials say under other payloads than those told.
struct UnderOthers {
  std::unique_ptr<Begun> begun;
  Conclusion conclusion;
};

/// What they say under the payloads that they tell themselves; nothing where it leaves hardly less of the
/// same recordings than the one as they were told. A fit from the arm file may end in a poor minimum, which
/// is no reason to accuse anybody: what was told has the other fit's end to begin from, too. Where it then
/// does nearly as well, all is concluded anew from there.
/// @param payloads to first order about the fit as told
/// @param as_told the trials as they were told, and what follows; becomes what follows from the better
/// constants
/// @param trials get the other payloads, and are kept by reference
std::optional<UnderOthers> under_other_payloads(const arm::Arm& arm, const model::Prepared& prepared,
                                                OtherPayloads payloads, Begun& as_told,
                                                Conclusion& conclusion, std::vector<model::TrialData>& trials,
                                                const Options& options, Schedule& schedule);

}  // namespace softarm::diagnose
