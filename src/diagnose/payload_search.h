// Which trials say that something else hangs there than was told.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "payload_moves.h"

namespace softarm::diagnose {

/// What hangs beside what was told: in a stretch of one trial, in some trials that were told the same, or so
/// much more in some and less in others that have one another's.
struct OtherPayload {
  std::vector<TrialStretch> where;
  double more_kg = 0.0, sd_kg = 0.0;
  /// Of two that have each other's: the difference of what they were told, which more_kg then is, just so.
  std::optional<double> exchanged_kg = {};
};

struct OtherPayloads {
  std::vector<OtherPayload> list;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< of what hangs, beside the arm file's
};

/// The heaviest payload that was told, kg; of trials without any, a share of the arm's own mass.
double usual_payload_kg(const arm::Arm& arm, const std::vector<model::TrialData>& trials);

/// What trials say that the constants of all meet far better with another payload: the one that gains most
/// first, then others beside it, to first order. A trial has one such stretch at most. Trials that were told
/// the same are looked at together, too: where one recording was cut into several, no piece alone is at odds
/// with the others. And where trials differ and no length says which of them has what, two payloads that were
/// exchanged are likelier than one that nobody ever told. Something was told right: what hangs in all trials
/// beside what was told is the arm's own.
/// What hangs may hang off its axis: all trials have one offset beside the arm file's, by which no payload is
/// to be accused.
/// @param at the constants' fit, under the payloads of `known`
/// @param known come first, in their order, with what the fit under them makes of them; others are looked for
/// only where these are settled
/// @param usual_kg usual_payload_kg() of the trials as they were told
OtherPayloads other_payloads(JointModel& model, const Linearised& at, const std::vector<OtherPayload>& known,
                             double usual_kg);

/// Whether the second is the first, nearly.
bool is_settled(const std::vector<OtherPayload>& before, const std::vector<OtherPayload>& after,
                double usual_kg);

/// What was told in a stretch, kg, but for times at which a hand was on it.
struct ToldIn {
  double least = std::numeric_limits<double>::infinity(), most = 0.0, mean = 0.0;
};
ToldIn told_in(const TrialStretch& stretch, const model::TrialData& trial);

}  // namespace softarm::diagnose
