// What comes late with a spectrum of time constants, level over some decades about the one in the middle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "math/following.h"

namespace softarm::effects {

/// A point of Gauss and Legendre on [-1/2, 1/2]: where in the decades, and the part that comes so late.
struct RelaxationPoint {
  double at, weight;
};
/// Six follow five decades to 1 % of what comes late.
constexpr std::array<RelaxationPoint, 6> kRelaxation{{{-0.46623475710157601, 0.085662246189585173},
                                                      {-0.33060469323313226, 0.18038078652406930},
                                                      {-0.11930959304159845, 0.23395696728634552},
                                                      {0.11930959304159845, 0.23395696728634552},
                                                      {0.33060469323313226, 0.18038078652406930},
                                                      {0.46623475710157601, 0.085662246189585173}}};

/// How what comes late follows over one time step, by each of the time constants.
using Relaxing = std::array<math::Following, kRelaxation.size()>;

/// @param time_s in the middle
inline Relaxing relaxing(double dt_s, double time_s, double decades) {
  const double middle_s = std::max(time_s, 1e-2);
  Relaxing all;
  if (decades == 0.0) {
    all.fill(math::following(dt_s, middle_s));
    return all;
  }
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k] = math::following(dt_s, middle_s * std::pow(10.0, decades * kRelaxation[k].at));
  return all;
}

}  // namespace softarm::effects
