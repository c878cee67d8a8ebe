// The pooling ladder: the same trials with every instant by itself, with EI free per condition, with one arm.
#pragma once

#include <string>
#include <vector>

#include "instant_fits.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// (a) EI, M0, phi and L of every instant; (b) one arm but for EI, which is free for each trial, and within
/// it for each payload and level of vacuum, to first order about (c); (c) one arm. Empty where no instant can
/// be fitted by itself.
std::vector<Rung> pooling_ladder(const JointModel& model, const Linearised& at,
                                 const std::vector<InstantFit>& instants);

/// Where the mismatch hides, by what each rung leaves beyond the noise.
/// @param variation sorted, the most telling first
std::string where_it_hides(const std::vector<Rung>& ladder, double noise_floor_m,
                           const std::vector<ParameterVariation>& variation);

}  // namespace softarm::diagnose
