// What the report draws.
#pragma once

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Curves of each trial, errors along the arm, shapes at telling instants.
void add_pictures(const JointModel& model, const Selection& selection, Diagnosis& diagnosis);

/// The verdict in one or two sentences.
/// @param trials count of them
std::string summary_of(const Diagnosis& diagnosis, std::size_t trials);

}  // namespace softarm::diagnose
