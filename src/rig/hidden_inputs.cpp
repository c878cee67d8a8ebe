// Effects between a command and what acts in the arm, and in its laws.
#include "hidden_inputs_parts.h"
#include "hidden_tables.h"

namespace softarm::rig {

std::vector<HiddenEffect> input_effects() {
  std::vector<HiddenEffect> effects;
  for (const auto& part : {pneumatic_effects(), law_effects(), memory_effects()})
    effects.insert(effects.end(), part.begin(), part.end());
  return effects;
}

}  // namespace softarm::rig
