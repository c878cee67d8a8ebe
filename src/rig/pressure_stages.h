// What pressures pass on their way from the command to the chambers: private to the rig.
#pragma once

#include <memory>
#include <vector>

#include "scenario.h"

namespace softarm::rig {

using Pressures = std::vector<double>;  ///< gauge Pa, one per chamber

/// One thing that all pressures pass.
class PressureStage {
 public:
  virtual ~PressureStage() = default;
  /// Has long settled with an input at t = 0; replaces it by what leaves.
  virtual void start(Pressures& pressures_pa) = 0;
  /// Replaces what enters at t_s by what leaves then. Since the last time, dt_s ago, the input went straight
  /// to it; 0: the same time is asked again.
  virtual void act(Pressures& pressures_pa, double t_s, double dt_s) = 0;
};

using PressureStages = std::vector<std::unique_ptr<PressureStage>>;

/// Appends what is hidden of the supply and its lines: delay, droop, ripple.
void add_supply(const Scenario& scenario, PressureStages& stages);
/// Of regulator and valve: error, stiction, slew limit.
void add_regulator(const Scenario& scenario, PressureStages& stages);
/// From valve to chamber: lag, leaks.
void add_line(const Scenario& scenario, PressureStages& stages);

}  // namespace softarm::rig
