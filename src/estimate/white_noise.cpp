#include "white_noise.h"

#include <algorithm>

#include "policy.h"

namespace softarm::estimate {

WhiteNoise::WhiteNoise(const arm::Arm& arm) {
  for (const arm::MeasuredBody& body : arm.bodies) {
    positions_.emplace_back(body.position_sd_m, 3.0);
    tangents_.emplace_back(body.orientation_sd_rad, 2.0);
  }
}

void WhiteNoise::forget() {
  for (std::vector<Path>* paths : {&positions_, &tangents_}) {
    for (Path& path : *paths) path = Path(std::sqrt(path.stated), path.dimensions);
  }
}

void WhiteNoise::add(double stamp_s, const std::vector<Observation>& observations) {
  for (const Observation& o : observations) {
    const auto body = static_cast<std::size_t>(o.body);
    positions_[body].add({stamp_s, o.p});
    if (o.tangent) tangents_[body].add({stamp_s, *o.tangent});
  }
}

void WhiteNoise::Path::add(const Sample& sample) {
  const auto follows = [](const Sample& a, const Sample& b) {
    return b.stamp_s > a.stamp_s && b.stamp_s < a.stamp_s + kPolicy.window.longest_spacing_s;
  };
  if (last && sample.stamp_s == last->stamp_s) return;  // the same frame again
  if (last && !follows(*last, sample)) before_last = last = std::nullopt;
  if (before_last) {
    // The middle one of three against the straight line through its neighbours.
    const double f = (last->stamp_s - before_last->stamp_s) / (sample.stamp_s - before_last->stamp_s);
    const Eigen::Vector3d off = last->value - (1.0 - f) * before_last->value - f * sample.value;
    const double one = off.squaredNorm() / dimensions / (1.0 + (1.0 - f) * (1.0 - f) + f * f);
    count = std::min(count + 1, kPolicy.window.noise_frames);
    // One that is far off is an outlier, or motion: it counts, but not for all.
    mean += (std::min(one, kPolicy.bodies.huber * kPolicy.bodies.huber * stated) - mean) / count;
  }
  before_last = last;
  last = sample;
}

double WhiteNoise::Path::variance() const {
  if (count == 0) return stated;
  // The most that it can be by what was seen: what is said to stay in a posture must be told from scatter.
  // Differences that overlap are worth half their number.
  const double scatter = std::sqrt(2.0 / (0.5 * dimensions * count));
  const double least = kPolicy.window.least_noise * kPolicy.window.least_noise * stated;
  return std::clamp((1.0 + 2.0 * scatter) * mean, least, stated);
}

double WhiteNoise::position_variance(int body) const {
  return positions_[static_cast<std::size_t>(body)].variance();
}

double WhiteNoise::tangent_variance(int body) const {
  return tangents_[static_cast<std::size_t>(body)].variance();
}

}  // namespace softarm::estimate
