// Effects of the model against those that may be there in their place, once all else is known.
#pragma once

#include <functional>
#include <string>

#include "joint_model.h"
#include "refits.h"
#include "selection.h"

namespace softarm::diagnose {

/// Of a round that compared an effect with others: the one that is there without it with more probability
/// than it is there itself, be it alone or beside that one, and predicts unseen trials; nullptr: none.
const Refitted* likelier_than(const model::Effect* effect, const Round& compared);

/// When an effect came into the model, others were not known yet, and it may have come because it also took
/// up some of theirs: a hose, which has five numbers, where a weight hangs at the tip. Each effect of the
/// model that others came after is compared again with what does nearly the same: all are fitted upon the
/// model without it, and the posterior about these fits says which is there. The likelier takes its place.
/// What stays out but may be there instead becomes a rival.
/// @param progress how many comparisons are left, and the next
/// @return whether an effect took another's place: the last round then looked at another model
bool put_likelier_in_place(
    JointModel& model, Standing& current, Selection& selection, const Options& options,
    const std::function<void(double, const std::string&)>& progress = [](double, const std::string&) {});

}  // namespace softarm::diagnose
