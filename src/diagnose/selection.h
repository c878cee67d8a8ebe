// Which effects go into the model.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "doubt.h"
#include "joint_model.h"
#include "posterior.h"
#include "screen.h"
#include "softarm/diagnose/diagnose.h"
#include "unseen.h"

namespace softarm::diagnose {

/// What the posterior is worked out from about a refit, and the candidates of which it has signatures.
struct KnownEvidence {
  EvidenceData data;
  std::vector<model::Present> candidates;
};

/// A candidate of one round after its refit.
struct Refitted {
  const model::Effect* effect = nullptr;
  double z = 0.0;            ///< sqrt of the fall of chi^2 on unseen trials over the inflation
  double gain = 0.0;         ///< that fall over twice the inflation: of the log score
  double elsewhere = 0.0;    ///< probability of a gain in other trials like these
  double probability = 0.0;  ///< of the round's posterior, and no more than that
  double moved_m = 0.0;      ///< root of the fall of the mean square error on unseen trials
  bool physical = true;      ///< not at the end of its range
  bool converged = true;     ///< its fit came to an end
  Linearised fit;
  Unseen unseen;
  std::optional<KnownEvidence> evidence;  ///< with candidates about the fit, once a posterior was made
};

/// One round: what was screened and refitted upon the model so far.
struct Round {
  std::vector<Screened> screened;
  std::vector<Refitted> refitted;            ///< best first
  Posterior posterior;                       ///< of all that were screened, upon the model so far
  int taken = -1;                            ///< of refitted; -1: none
  bool anew = false;                         ///< the model so far came to other constants first
  std::vector<const model::Effect*> rivals;  ///< of the one taken: as good, or the same in these trials
  std::vector<const model::Effect*> nearly_as_good;  ///< as it, given what is left beyond the noise
};

struct Selection {
  Linearised baseline, extended;
  Unseen baseline_unseen, extended_unseen;
  /// The extended ones with small departures of all other effects, which cannot be told apart.
  Unseen with_background;
  double first_order_rms_m = 0.0;  ///< of the baseline on unseen trials, as the rounds have it
  std::vector<Round> rounds;       ///< the last one looked at all that is not in `extended`
  /// For each effect of `extended`: the round in which it was taken.
  std::vector<std::size_t> round_of;
  double inflation = 1.0;  ///< of the extended fit
  Doubt doubt;             ///< about the extended fit
};

/// @param baseline fit without effects
/// @param delayed the same with clocks apart, where they are by more than the screen can see
/// @param progress what is left of it, probably, as multiples of the time of the fits before it
Selection select(JointModel& model, Linearised baseline, const std::optional<Linearised>& delayed,
                 const Options& options, const std::function<void(double, const std::string&)>& progress);

}  // namespace softarm::diagnose
