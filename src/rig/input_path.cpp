#include "input_path.h"

namespace softarm::rig {
namespace {

std::vector<PlayHysteresis> plays(double width, const std::vector<double>& start) {
  std::vector<PlayHysteresis> result;
  for (double value : start) result.emplace_back(width, value);
  return result;
}

void apply(std::vector<PlayHysteresis>& plays, std::vector<double>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i] = plays[i].to(inputs[i]);
}

}  // namespace

InputPath::InputPath(const Scenario& scenario, const Commands& start)
    : pressure_plays_(plays(scenario.input_path.pressure_play_pa, start.pressures_pa)),
      tension_plays_(plays(scenario.input_path.tension_play_n, start.tensions_n)),
      angle_plays_(plays(scenario.input_path.angle_play_rad, start.angles_rad)) {}

Commands InputPath::act(const Commands& commanded, double) {
  Commands acting = commanded;
  apply(pressure_plays_, acting.pressures_pa);
  apply(tension_plays_, acting.tensions_n);
  apply(angle_plays_, acting.angles_rad);
  return acting;
}

}  // namespace softarm::rig
