// Fits with one effect more, and how they compare on trials that they have not seen.
#pragma once

#include <optional>
#include <vector>

#include "selection.h"

namespace softarm::diagnose {

/// What the rounds stand upon: the model so far.
struct Standing {
  Linearised fit;
  Unseen unseen;
  std::optional<KnownEvidence> evidence = {};  ///< about the fit, once a posterior was made
};

/// Of a round, with that effect; nullptr: none.
const Refitted* refit_of(const Round& round, const model::Effect* effect);

/// Fits are large, and not looked at again: of a round's only where they are stays.
void without_fits(Round& round);

/// Whether a refit has these effects before its own: another may have taken the place of one since.
bool is_upon(const Refitted& refit, const std::vector<model::Present>& effects);

/// What was screened, each at the values of its refit where it had one.
std::vector<model::Present> candidates_of(const Round& round);

/// What the posterior about the model so far is worked out from; kept with the model.
const EvidenceData& evidence_about(JointModel& model, Standing& current,
                                   const std::vector<model::Present>& candidates, unsigned jobs);

/// About the model so far, and the refits: how probable each of a round's candidates is.
Posterior posterior_of(JointModel& model, Standing& current, Round& round, unsigned jobs);

/// Of what an effect moves the bodies by beyond what the constants absorb, rms: less is too small to matter.
double trivial_m(const JointModel& model);

/// Effects that the model may come to have: options.most_effects, but no more than
/// kPolicy.selection.few_effects where no more is left than departures that every arm has.
std::size_t most_effects(const JointModel& model, const Standing& current, const Options& options);

/// Those of the screen that refits are worth their time for, best first.
std::vector<std::size_t> worth_a_refit(const JointModel& model, const std::vector<Screened>& screened,
                                       const Options& options);

/// Whether a size of an effect is at an end of its range that is not "absent", and determined: one of several
/// that the trials do not determine may be anywhere.
bool at_limit(const Linearised& at, std::size_t effect);

/// Columns of a fit: an effect's sizes, and its other free numbers (places, times, thresholds).
std::vector<Eigen::Index> rows_of_sizes(const Linearised& at, std::size_t effect);
std::vector<Eigen::Index> rows_of_shapes(const Linearised& at, std::size_t effect);

/// Makes a fit with one effect more the place from which that effect's refit begins: the screen is linear
/// about none of it, and does not see so far.
void begin_from(JointModel& model, const Standing& current, const Linearised& from,
                std::vector<Screened>& screened);

/// The model so far with one effect more, from where the screen expects it.
/// @param before refits upon the same model: this one is given up where it explains far less than the best
Refitted refit(JointModel& model, const Standing& current, const Screened& s,
               const std::vector<Refitted>& before = {});

/// A fit with one of its effects moved to the last place, as if that had been refitted upon the others; goes
/// on with what had not come to its end.
Refitted refitted_last(JointModel& model, const Linearised& fit, std::size_t effect);

/// Goes on with the refits that ended before they converged and would explain most, as far as the first order
/// says, until none of them leads: what is as good as known is not to give way to a fit that was easier, nor
/// to leave it to the next round's refits to find its constants.
void finish_leaders(JointModel& model, const Standing& current, std::vector<Refitted>& refitted);

/// What can do nearly the same as the effect that explains most, a wall what a hose does, is fitted from
/// where that one's refit ended, too: from the screen it may have begun too far off. So is that effect itself
/// with another value of a number that fits hold. The better of its two stays.
void refit_what_is_alike(JointModel& model, const Standing& current, const std::vector<Screened>& screened,
                         std::vector<Refitted>& refitted);

/// What comes next rests on a fit that came near by the derivatives of another: the last steps, by its own,
/// whole ones where those are needed. Else evidence would take for a gain of constants what the fit
/// left over.
Standing standing_on(JointModel& model, const Linearised& fit);

/// The same, from parameters of which nothing but the predictions is known.
Standing standing_at(JointModel& model, const JointParameters& at,
                     const std::vector<std::vector<model::Predicted>>& predicted);

/// Takes refits that explain most by derivatives of their own, where they came near by others'. Else evidence
/// would take for a second effect, nearly the same, what these miss.
void linearise_leaders(JointModel& model, const Standing& current, std::vector<Refitted>& refitted);

/// The model so far without one of its effects; by the derivatives that it has.
Standing refit_without(JointModel& model, const Standing& current, std::size_t effect);

/// The model so far at other constants, where a refit came to better ones and its effect is next to nothing:
/// what it gained is theirs.
std::optional<Standing> at_better_constants(JointModel& model, const Standing& current,
                                            const std::vector<Refitted>& refitted);

/// Root of the fall of the mean square error on unseen trials.
double moved_m(const Unseen& without, const Unseen& with);

/// Root of the rise of the mean square error, were an effect of the model not there and all else fitted anew:
/// to first order.
double moved_without_m(const Standing& current, std::size_t effect);

/// What each candidate gains, all against the spread that the best of them leaves; the best comes first.
void compare(const Standing& current, const Posterior& posterior, std::vector<Refitted>& refitted);

}  // namespace softarm::diagnose
