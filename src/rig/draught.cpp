#include "draught.h"

#include <cmath>

#include "random_stream.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kDraughtPurpose = 0x64726166;
constexpr int kWaves = 24;
/// Of the spectrum, by variance: what is faster, some 20 over the correlation time, is left out.
constexpr double kSlower = 0.97;

/// Force across the tip by which an evenly stiff arm bends as far, over force per length times length:
/// integral of q(s) s^2 (3 - s) / 2 with q = 1 or, sheltered, q = s.
constexpr double kEven = 3.0 / 8.0, kSheltered = 11.0 / 40.0;

}  // namespace

DraughtForce::DraughtForce(const std::optional<Draught>& spec, double length_m, std::uint64_t seed) {
  if (!spec) return;
  // The waves' mean square is half their amplitude's: there are two forces of kWaves waves.
  amplitude_ = spec->force_n / ((spec->sheltered ? kSheltered : kEven) * length_m) / std::sqrt(kWaves);
  RandomStream random(seed, kDraughtPurpose);
  for (std::vector<Wave>& waves : waves_)
    for (int i = 0; i < kWaves; ++i) {
      // One in each of as many parts of the spectrum, of the same variance.
      const double place = kSlower * (i + random.uniform()) / kWaves;
      waves.push_back({std::tan(0.5 * M_PI * place) / spec->correlation_s, random.uniform(0.0, 2.0 * M_PI)});
    }
}

Eigen::Vector3d DraughtForce::at(double t_s) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (int c = 0; c < 2; ++c)
    for (const Wave& wave : waves_[c]) force[c] += amplitude_ * std::cos(wave.rad_per_s * t_s + wave.phase);
  return force;
}

}  // namespace softarm::rig
