// A scenario from a file, whose arm may be an arm file.
#pragma once

#include <optional>
#include <string>

#include "rig/scenario.h"
#include "softarm/arm/arm.h"

namespace softarm::app {

struct LoadedScenario {
  rig::Scenario scenario;
  bool is_arm_file = false;     ///< the file itself is the arm's
  std::optional<arm::Arm> arm;  ///< of the arm file, where the scenario names one: whose topics are used
};

/// Where the scenario's `arm` is a name or path instead of a section, the arm file's constants, effects,
/// bodies and base are put in its place, in the rig's own keys (`arm`, `hidden`, `mocap`, `mount`): the rig
/// itself knows no arm files. An arm file itself is a scenario as well: see usual_scenario().
/// @param name a file, or a shipped scenario; its arm is looked for beside it, then as any arm file
/// @throws rig::ScenarioError, ArmError or Failure in one line; for what the rig has no counterpart too
LoadedScenario load_scenario(const std::string& name);

}  // namespace softarm::app
