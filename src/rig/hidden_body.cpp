// Effects of material, boundary and loads.
#include "hidden_tables.h"
#include "softarm/rig/scenario.h"

namespace softarm::rig {

std::vector<HiddenEffect> body_effects() {
  return {
      {"base_compliance",
       true,
       "the base turns under the load, though the measured body `base` does not",
       {},
       {{"stiffness_nm_per_rad", 1e-4, 1e6, 2.0, 20.0, "bending moment at the base over its turn"}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         scenario.body.base_stiffness_nm_per_rad = choice.values.at("stiffness_nm_per_rad");
       }},
  };
}

}  // namespace softarm::rig
