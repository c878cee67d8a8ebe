#include "effects.h"
#include "learned_moment.h"

namespace softarm::effects {

const std::vector<std::unique_ptr<Effect>>& catalogue() {
  static const std::vector<std::unique_ptr<Effect>> all = [] {
    std::vector<std::unique_ptr<Effect>> list;
#define SOFTARM_MAKE(name) list.push_back(make_##name());
    SOFTARM_EFFECTS(SOFTARM_MAKE)
#undef SOFTARM_MAKE
    for (std::size_t i = 0; i < list.size(); ++i) list[i]->set_rank(static_cast<int>(i));
    return list;
  }();
  return all;
}

const Effect* find(const std::string& id) {
  for (const std::unique_ptr<Effect>& effect : catalogue()) {
    if (effect->info().id == id) return effect.get();
  }
  return id == learned_moment().info().id ? &learned_moment() : nullptr;
}

}  // namespace softarm::effects
