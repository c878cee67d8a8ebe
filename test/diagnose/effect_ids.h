// Which effects are named, in their order.
#pragma once

#include <string>
#include <vector>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose::testing {

inline std::vector<std::string> ids(const std::vector<NamedEffect>& effects) {
  std::vector<std::string> list;
  for (const NamedEffect& effect : effects) list.push_back(effect.id);
  return list;
}

}  // namespace softarm::diagnose::testing
