#include "wished_size.h"

#include <algorithm>

namespace softarm::prove {
namespace {

constexpr double kClearNoise = 0.5, kClearBackground = 1.0;
constexpr double kNear = 1.1, kMostRaw = 3.0;
constexpr double kLeastFactor = 0.02, kMostFactor = 30.0;  // of one scaling: effects are not linear
constexpr double kNothing_m = 1e-9;

}  // namespace

bool is_clear(const Signal& signal, double noise_m, double background_m) {
  return signal.leftover_m >= kClearNoise * noise_m && signal.leftover_m >= kClearBackground * background_m;
}

double factor_towards(double wished_m, double most_m, const Signal& now) {
  const double ratio = wished_m / std::max(kNothing_m, now.leftover_m);
  const double most = kMostRaw * most_m / std::max(kNothing_m, now.raw_m);
  const double factor = std::clamp(std::min(ratio, most), kLeastFactor, kMostFactor);
  return std::max(factor, 1.0 / factor) < kNear ? 1.0 : factor;
}

}  // namespace softarm::prove
