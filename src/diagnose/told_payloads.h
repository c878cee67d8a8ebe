// Payloads that are not what was told.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// A stretch of a trial: from some time on, or up to one, or all of it.
struct TrialStretch {
  std::size_t trial = 0;
  std::size_t first = 0, last = 0;  ///< blocks [first, last)
  double sign = 1.0;                ///< -1: so much less hangs there
};

/// What hangs beside what was told: in a stretch of one trial, in all trials that were told the same, or so
/// much more in some and less in others that have one another's.
struct OtherPayload {
  std::vector<TrialStretch> where;
  double more_kg = 0.0, sd_kg = 0.0;
  /// Of two that have each other's: the difference of what they were told, which more_kg then is.
  std::optional<double> exchanged_kg = {};
};

/// The heaviest payload that was told, kg; of trials without any, one that bends the arm as its weight does.
double usual_payload_kg(const arm::Arm& arm, const std::vector<model::TrialData>& trials);

/// What trials say that the constants of all meet far better with another payload: the one that gains most
/// first, then others beside it, to first order. A trial has one such stretch at most. Trials that were told
/// the same are looked at together, too: where one recording was cut into several, no piece alone is at odds
/// with the others. And where trials differ and no length says which of them has what, two payloads that were
/// exchanged are likelier than one that nobody ever told.
/// @param at the constants' fit, under the payloads of `known`; is completed (JointModel::complete)
/// @param known come first, in their order, with what the fit under them makes of them
/// @param usual_kg usual_payload_kg() of the trials as they were told
std::vector<OtherPayload> other_payloads(JointModel& model, Linearised& at,
                                         const std::vector<OtherPayload>& known, double usual_kg);

/// Whether the second is the first, nearly.
bool is_settled(const std::vector<OtherPayload>& before, const std::vector<OtherPayload>& after,
                double usual_kg);

/// That payloads said to be exchanged are.
bool are_likely(const std::vector<OtherPayload>& payloads);

/// The trials under these payloads; about a change that was found nothing is compared.
std::vector<model::TrialData> under(const std::vector<OtherPayload>& payloads,
                                    std::vector<model::TrialData> trials);

/// In the order of the trials. @param trials as they were told
ToldPayloads told_payloads(const std::vector<OtherPayload>& payloads,
                           const std::vector<model::TrialData>& trials);

/// In a few sentences.
std::string sentence_of(const ToldPayloads& payloads);

}  // namespace softarm::diagnose
