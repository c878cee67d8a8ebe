// Effects between a command and what acts in the arm.
#include "hidden_tables.h"
#include "softarm/rig/scenario.h"

namespace softarm::rig {

std::vector<HiddenEffect> input_effects() {
  return {
      {"hysteresis",
       true,
       "rate-independent loop between what is commanded and what acts in the arm; its width is that of a "
       "cycle that is "
       "wide against it",
       {"play"},
       {{"loop_pa", 0.0, 1e6, 500.0, 5000.0, "of the pressures", 0.0},
        {"loop_n", 0.0, 1e4, 0.05, 0.5, "of the tensions", 0.0},
        {"loop_rad", 0.0, 1e3, 0.01, 0.1, "of the servos' angles", 0.0}},
       [](const HiddenChoice& choice, Scenario& scenario) {
         scenario.input_path.pressure_play_pa = choice.values.at("loop_pa");
         scenario.input_path.tension_play_n = choice.values.at("loop_n");
         scenario.input_path.angle_play_rad = choice.values.at("loop_rad");
       }},
  };
}

}  // namespace softarm::rig
