// The fits that everything begins with.
#pragma once

#include <functional>
#include <optional>

#include "joint_model.h"

namespace softarm::diagnose {

/// The arm's constants alone, and with clocks apart where they are by more than the screen can see.
struct FirstFits {
  Linearised baseline;
  std::optional<Linearised> delayed;
  std::size_t swinging = 0, ends = 0;  ///< blocks that are left out: the arm swings, inputs are not known
};

/// Fits them; what of the motion is not known, and the misfit, are the model's from then on.
/// @param progress called once, between them
FirstFits first_fits(JointModel& model, const std::function<void()>& progress);

/// Fits them from these constants; the misfit is the model's from then on. What of the motion is not known
/// stays.
void fit_again_from(const JointParameters& constants, JointModel& model, FirstFits& first);

}  // namespace softarm::diagnose
