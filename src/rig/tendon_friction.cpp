#include "tendon_friction.h"

#include <algorithm>
#include <cmath>

namespace softarm::rig {
namespace {

/// Mean of a tension that changes exponentially from one value to the other.
double logarithmic_mean(double from, double to) {
  if (from <= 0.0 || to <= 0.0) return 0.0;
  const double x = std::log(to / from);
  return std::abs(x) < 1e-6 ? 0.5 * (from + to) : (to - from) / x;
}

}  // namespace

TendonFrictionState::TendonFrictionState(const TendonFriction& spec, const ArmSpec& arm,
                                         const std::vector<double>& start_n)
    : spec_(spec), tendons_(start_n.size()) {
  for (std::size_t i = 0; i < tendons_.size(); ++i) {
    std::size_t passed = 0;
    for (std::size_t k = 0; k < arm.segments.size(); ++k)
      for (const TendonSpec& tendon : arm.segments[k].tendons)
        if (static_cast<std::size_t>(tendon.input) == i) passed = k + 1;
    tendons_[i].behind_n.assign(passed + 1, start_n[i]);
  }
}

void TendonFrictionState::act(std::vector<Acting>& segments) {
  for (Acting& segment : segments) segment.tension_change_n.assign(tendons_.size(), 0.0);
  for (std::size_t i = 0; i < tendons_.size(); ++i) {
    std::vector<double>& behind = tendons_[i].behind_n;
    double before = segments.front().tensions_n[i];
    for (std::size_t k = 0; k < behind.size(); ++k) {
      const double angle = k == 0 ? spec_.routing_rad : segments[k - 1].bend_rad;
      const double held = std::exp(spec_.coefficient * angle);
      behind[k] = std::clamp(behind[k], before / held, before * held);
      if (k > 0) {
        segments[k - 1].tensions_n[i] = logarithmic_mean(before, behind[k]);
        segments[k - 1].tension_change_n[i] = behind[k] - before;
      }
      before = behind[k];
    }
  }
}

}  // namespace softarm::rig
