// What the parameters of single instants go with beyond the arm's laws.
#pragma once

#include <cstddef>
#include <vector>

#include "instant_fits.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// EI and M0 over their laws, phi less the commanded direction and L less its law, each against the moment,
/// its direction and rate, pressure, vacuum, payload, attitude, time and history.
///
/// Each value is taken over its own standard deviation and by rank; the statistic is the spread of the means
/// over up to six bins of what it is held against. Its null: stretches of two seconds are exchanged, within
/// trials and between them, so that what is correlated over shorter times stays so; p is that of the largest
/// of all statistics (Westfall and Young 1993): a whole page of pictures has one false alarm in 1 / p pages.
/// @return what varies, the most telling first, then the best of the other parameters
std::vector<ParameterVariation> parameter_variation_of(const JointModel& model, const Linearised& at,
                                                       const std::vector<InstantFit>& instants);

}  // namespace softarm::diagnose
