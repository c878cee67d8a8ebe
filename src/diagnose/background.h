// What small departures of everything make of unseen trials.
#pragma once

#include <optional>
#include <vector>

#include "joint_model.h"
#include "unseen.h"

namespace softarm::diagnose {

/// Unseen trials with the effects of the catalogue that are not in the fit, each as small as a background has
/// them (evidence.h, background_sd), as the other trials say: departures that every arm has and that cannot
/// be told apart. To first order about the fit.
/// @param at is completed (JointModel::complete)
/// @param candidates effects at the values that the data say so far
/// @param background share of the arm's length by which each moves the bodies
/// @param unseen the same trials without; also what is returned where that is better
Unseen with_background(JointModel& model, Linearised& at, const std::vector<model::Present>& candidates,
                       double background, const Unseen& unseen, unsigned jobs);

/// Rms distance that they make of what is left, m. Nothing where they are not all that is left, or make more
/// than departures of every arm come to (Policy::Words::small): what is large may look like many small things
/// at once, and that they explain some of it says nothing then.
/// @param without, with unseen trials without them, and with them (with_background())
/// @param adequate whether with them nothing of a size that matters is left
std::optional<double> small_departures_m(const Unseen& without, const Unseen& with, bool adequate,
                                         double length_m);

}  // namespace softarm::diagnose
