// Experiments that a laboratory can do next, each as a trial that nobody has recorded yet.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "model/effect.h"
#include "model/prepared_trial.h"
#include "softarm/arm/arm.h"

namespace softarm::diagnose {

/// One of the menu.
struct Experiment {
  std::string id;      ///< "attitude_level", "faster_2", ...
  std::string action;  ///< what to do, a sentence without its stop
  arm::Arm arm;        ///< with what the experiment adds to it: a bracket, one more body
  /// What drives it, and when bodies are seen; not where (p_base is 0), but how well.
  model::TrialData trial;
  std::vector<std::shared_ptr<const model::Effect>> loads;  ///< known ones, without parameters
  double clock_sd_s = 0.0;  ///< > 0: it measures the difference of the clocks so well
};

/// Other attitudes of the mount, other speeds, a hold, a repeated cycle, all inputs together, payloads, a
/// pull at the tip, vacuum on a bent arm, one more body, the clocks, and the same once more. Only what the
/// arm can do: inputs and vacuum stay within what was recorded, payloads within the arm file's.
/// @param trials that were recorded: the experiments are variations on the one that drives the arm most
/// @param block_s over which frames are averaged
std::vector<Experiment> experiment_menu(const arm::Arm& arm, const std::vector<model::TrialData>& trials,
                                        double block_s);

}  // namespace softarm::diagnose
