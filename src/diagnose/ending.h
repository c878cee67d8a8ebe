// What the model ends with: nothing superfluous, nothing that predicts unseen trials worse.
#pragma once

#include <functional>
#include <string>

#include "refits.h"

namespace softarm::diagnose {

struct Ending {
  double background = 0.0;
  Unseen unseen;
};

/// Takes out again what has become superfluous; puts what is likelier in the place of what stays
/// (put_likelier_in_place()); then takes out, while true refits predict unseen trials no better than the
/// arm's constants alone do, what is least sure. A round more looks at what was taken out, too. What stays
/// though it would have been superfluous in the place of what was taken out has that one as its rival.
/// @param progress how many comparisons of put_likelier_in_place() are left, and what comes next
Ending end_with_what_predicts(
    JointModel& model, Standing& current, Selection& selection, const Options& options,
    const std::function<void(double, const std::string&)>& progress = [](double, const std::string&) {});

/// Of two effects of the model that are each doubtful (Selection::doubt) because the other can do what it
/// does: takes the one out again without which unseen trials are predicted better. It becomes a rival of the
/// other.
/// @return whether there are such
bool keep_one_of_two_alike(JointModel& model, Standing& current, Selection& selection);

/// Whether the search is lost: it is more probable than not (Posterior::named) that none of the
/// Selection::most_stand_ins least probable effects of the model is there, and what the round would take is
/// probably not there either. Two that do the same count as one. What nothing of the catalogue explains is
/// taken for one after the other, also after something was found.
/// @param round that was looked at upon the model, not yet of the selection
bool is_lost(JointModel& model, Standing& current, const Round& round, const Selection& selection,
             const Options& options);

/// How sure the effects that were selected are in another model of the arm, all fitted anew.
/// @param alone its fit without effects
Doubt doubt_in_another(JointModel& other, const Linearised& alone, const Selection& selection,
                       const Options& options);

}  // namespace softarm::diagnose
