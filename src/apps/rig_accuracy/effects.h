// What every effect that can be hidden does to the virtual rig: to its error, to its arm, to its speed.
#pragma once

#include <string>
#include <vector>

namespace softarm::rig_accuracy {

struct EffectsOptions {
  std::string config;  ///< folder with scenarios/
  double seconds = 10.0;
  std::vector<std::string> only;  ///< ids; empty: all
};

/// Hides each form of each effect, at the middle of its usual range, in the first of a few scenarios that
/// takes it, and prints a row of CSV:
///   effect,form,scenario     "ideal": nothing is hidden
///   step_worst_mm,step_rms_mm          rings against those with a quarter of the time step; empty: what is
///   elements_worst_mm,elements_rms_mm  hidden does not touch the arm. Against those with twice the elements
///   arm_mm    most that a ring is away from the ideal arm's
///   frames    share of the frames in which anything that is measured or sent is not as from the ideal rig
///   speed     multiples of real time, by the time of the processor
/// Progress and a verdict on standard error.
/// @return exit status: 0 only where every effect does something, at 10 times real time or faster, and with
/// an error of step and elements together within kAllowed_mm. @throws std::exception
int measure_effects(const EffectsOptions& options);

}  // namespace softarm::rig_accuracy
