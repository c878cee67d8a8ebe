#include "stiffness_profile.h"

#include <algorithm>

namespace softarm::arm {

double stiffness_factor(const std::vector<StiffnessKnot>& profile, double fraction) {
  if (profile.empty()) return 1.0;
  const auto above = std::find_if(profile.begin(), profile.end(),
                                  [&](const StiffnessKnot& knot) { return knot.fraction >= fraction; });
  if (above == profile.begin()) return profile.front().factor;
  if (above == profile.end()) return profile.back().factor;
  const StiffnessKnot& below = *(above - 1);
  const double width = above->fraction - below.fraction;
  const double weight = width > 0.0 ? (fraction - below.fraction) / width : 1.0;
  return below.factor + weight * (above->factor - below.factor);
}

}  // namespace softarm::arm
