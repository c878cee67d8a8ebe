#include "policy.h"

#include <algorithm>
#include <cmath>

namespace softarm::diagnose {

double noise_m(const arm::Arm& arm) {
  double square = 0.0;
  for (const arm::MeasuredBody& body : arm.bodies) square += body.position_sd_m * body.position_sd_m;
  return std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, arm.bodies.size())));
}

double mass_kg(const arm::Arm& arm) {
  double sum = arm.tip_mass_kg;
  for (const arm::Segment& segment : arm.segments) sum += segment.mass_per_length_kg_m * segment.length_m;
  return sum;
}

}  // namespace softarm::diagnose
