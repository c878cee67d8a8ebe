// A scenario from a file, whose arm may be an arm file.
#pragma once

#include <string>

#include "rig/scenario.h"

namespace softarm::app {

/// Where the scenario's `arm` is a name or path instead of a section, the arm file's constants and effects
/// are put in its place, in the rig's own keys (`arm`, `hidden`): the rig itself knows no arm files.
/// @param name a file, or a shipped scenario; its arm is looked for beside it, then as any arm file
/// @throws rig::ScenarioError, ArmError or Failure in one line; for what the rig has no counterpart too
rig::Scenario load_scenario(const std::string& name);

}  // namespace softarm::app
