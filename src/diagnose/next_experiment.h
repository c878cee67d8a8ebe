// Which experiment would show what these trials cannot.
#pragma once

#include <optional>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// 1. Rivals: a named effect and what it is mistaken for; else the candidates that explain most of what no
///    effect explains; each a whole model, fitted to the trials that there are.
/// 2. Each experiment of the menu as a trial predicted by each of the models; how far one model's shapes are
///    from another's once that has all its constants and its effect's numbers fitted anew to old and new
///    trials: the root of that chi^2, residuals being as correlated as those of the trials. The least over
///    all pairs, either being the truth, is the experiment's score.
/// 3. Without rivals, effects that are collinear with the constants: the experiment that brings most of them
/// to light.
/// @param verdict of the diagnosis: decides which of the three it is
/// @return nothing where nothing is to be separated, or no experiment of the menu helps
std::optional<NextExperiment> next_experiment(JointModel& model, Selection& selection, Verdict verdict,
                                              const Options& options);

}  // namespace softarm::diagnose
