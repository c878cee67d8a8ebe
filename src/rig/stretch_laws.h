// What short stretches of the arm answer as a whole: private to the rig.
#pragma once

#include "body_spec.h"
#include "section_laws.h"

namespace softarm::rig {

/// A wall that folds: the moment falls from EI u to EI (1 - share) u where the curvature comes to fold_per_m,
/// and rises again where that in the plane of the fold falls below unfold_per_m. Folding takes 50 ms. The
/// fold keeps the energy that it gives back when it opens; the rest is lost when it closes.
SectionLawPtr kink_law(const Kink& kink);

/// A coupling with free play: no moment, but for a hundredth of the stretch's stiffness, until it has turned
/// by the play; beyond it the stretch's own stiffness, which sets in over a tenth of the play. What drives
/// the arm ends before the coupling and begins behind it: it turns the stretch, not the coupling.
SectionLawPtr joint_play_law(double play_rad);

}  // namespace softarm::rig
