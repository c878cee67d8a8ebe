// Which effects stand in for each other, and which of a round goes into the model.
#pragma once

#include <cstddef>
#include <vector>

#include "refits.h"

namespace softarm::diagnose {

/// What a round's screen made of one of its effects.
const Screened& screened_of(const Round& round, const model::Effect* effect);

/// Probability that it, or one of those that it takes turns with, is there.
double of_class(const Round& round, const model::Effect* effect);

/// What goes into the model, of a class that is more probable than not; -1: nothing. Of those that are it by
/// themselves the one that brings most on unseen trials: the others are looked for beside it; else the most
/// probable. One that is not even a rival stands for no class.
int best_of(const JointModel& model, const Round& round);

/// The model goes on with the round's best. Refits borrow derivatives: one that by its own predicts unseen
/// trials no better is left, for the next best.
/// @return whether there is one; Round::taken says so, too
bool take_best(JointModel& model, Round& round, Standing& current);

/// Those that may be there in place of the one taken, or are the same in these trials.
EffectList rivals_of(const Round& round);

/// The round that looked at what may be there in place of what a round took: that round, or where the other
/// was in the model by then, and was taken out again later, the last one before.
/// @param own number of the round that took the one that stays
const Round& round_with_rival(const Selection& selection, std::size_t own, const model::Effect* rival);

/// Those of the refits that may be there in place of the one taken because what nobody understands may have
/// made the difference; they are told beside the rivals, and are none of these.
EffectList nearly_as_good(const Round& round);

/// Both, of the round's best.
void set_rivals(Round& round);

/// Whether an effect is as good as certain beside what was taken upon the same posterior, and something else
/// than that.
bool is_certain_beside(const Round& round, const Screened& s, const EffectList& taken);

}  // namespace softarm::diagnose
