#include "effect.h"

#include <algorithm>
#include <utility>

namespace softarm::model {

std::vector<Values> Effect::grid(const arm::Arm&, const FineRod&) const {
  const Info& i = info();
  Values values = Values::Zero(static_cast<Eigen::Index>(i.parameters.size()));
  for (std::size_t k = static_cast<std::size_t>(i.sizes); k < i.parameters.size(); ++k)
    values[static_cast<Eigen::Index>(k)] = i.parameters[k].usual;
  return {values};
}

std::vector<Present> in_order(std::vector<Present> effects) {
  std::stable_sort(effects.begin(), effects.end(),
                   [](const Present& a, const Present& b) { return a.effect->rank() < b.effect->rank(); });
  return effects;
}

}  // namespace softarm::model
