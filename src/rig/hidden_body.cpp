// Effects of material, boundary, loads and what the catalogue does not have.
//
// Of the catalogue, `published_load_law` is left out: it is what a model may do wrong, no physics that a rig
// could have.
#include "hidden_body.h"

#include <algorithm>
#include <stdexcept>

#include "hidden_tables.h"

namespace softarm::rig {

std::vector<HiddenEffect> body_effects() {
  std::vector<HiddenEffect> effects;
  for (const auto& part : {profile_effects(), material_effects(), boundary_effects(), outside_effects()})
    effects.insert(effects.end(), part.begin(), part.end());
  return effects;
}

void refuse_twice(const HiddenChoice& choice, const Scenario& scenario) {
  const auto same = [&](const HiddenChoice& other) { return other.effect == choice.effect; };
  if (std::any_of(scenario.hidden.begin(), scenario.hidden.end(), same))
    throw std::invalid_argument("given twice");
}

}  // namespace softarm::rig
