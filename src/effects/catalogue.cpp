#include "effects.h"

namespace softarm::effects {

const std::vector<std::unique_ptr<Effect>>& catalogue() {
  static const std::vector<std::unique_ptr<Effect>> all = [] {
    std::vector<std::unique_ptr<Effect>> list;
    for (const auto make :
         {make_stiffness_taper, make_base_compliance, make_hysteresis, make_tether, make_marker_slip})
      list.push_back(make());
    return list;
  }();
  return all;
}

const Effect* find(const std::string& id) {
  for (const std::unique_ptr<Effect>& effect : catalogue()) {
    if (effect->info().id == id) return effect.get();
  }
  return nullptr;
}

}  // namespace softarm::effects
