// A second diagnosis, under the payloads that trials say themselves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "conclusion.h"
#include "payload_search.h"

namespace softarm::diagnose {

/// How far of all a diagnosis is that has a second one under other payloads: after the first, and after the
/// second. What was told may then be concluded anew, which takes as long as either, but seldom is.
constexpr double kAsToldShare = 0.5, kUnderOthersShare = 0.7;

/// What the fits of trials as they were told say that hung on the arm.
OtherPayloads payloads_that_trials_say(const arm::Arm& arm, const model::Prepared& prepared, Begun& as_told);

/// What trials say under other payloads than those told.
struct UnderOthers {
  std::unique_ptr<Begun> begun;
  Conclusion conclusion;
};

/// What was told, with the end of the fit under other payloads to begin from.
struct AsToldAnew {
  double mean_m = 0.0, rms_m = 0.0;  ///< of errors on unseen trials, with the same effects
  bool does_as_well = false;         ///< that is hardly more than under the other payloads
  /// Where it does, and from better constants than those of the conclusion so far: what follows from these.
  std::optional<Conclusion> conclusion;
};

/// A fit from the arm file may end in a poor minimum, which is no reason to accuse anybody.
/// @param conclusion from the trials as they were told
/// @param as_told its baseline becomes the one from there, where what was told does as well
AsToldAnew as_told_from(const UnderOthers& others, const model::Prepared& prepared,
                        const Conclusion& conclusion, Begun& as_told, const Options& options,
                        Schedule& schedule);

/// What they say under the payloads that they tell themselves; nothing where it leaves hardly less of the
/// same recordings than what was told, wherever that begins.
/// @param payloads to first order about the fit as told
/// @param conclusion from the trials as they were told; becomes as_told_from()'s where that is better
/// @param trials get the other payloads, and are kept by reference
std::optional<UnderOthers> under_other_payloads(const arm::Arm& arm, const model::Prepared& prepared,
                                                OtherPayloads payloads, Begun& as_told,
                                                Conclusion& conclusion, std::vector<model::TrialData>& trials,
                                                const Options& options, Schedule& schedule);

}  // namespace softarm::diagnose
