// The whole catalogue, best first.
#pragma once

#include <vector>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Effects that were taken, their rivals, then the others of the last screen.
std::vector<Candidate> ranking_of(const JointModel& model, const Selection& selection);

}  // namespace softarm::diagnose
