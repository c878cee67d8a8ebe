// How large a hidden effect is, and the same effect larger or smaller.
#pragma once

#include <string>
#include <vector>

#include "hidden.h"

namespace softarm::rig {

/// The parameters that say how large an effect is. An effect grows in proportion to them, or, where it is a
/// stiffness or the like, to one over them.
struct EffectSize {
  std::vector<std::string> keys;
  bool inverse = false;
};
EffectSize size_of(const HiddenEffect& effect, const std::string& form);

/// The choice with its effect `factor` times as large, to first order. Sizes stop at the ends of what is
/// allowed.
HiddenChoice scaled(const HiddenChoice& choice, double factor);

}  // namespace softarm::rig
