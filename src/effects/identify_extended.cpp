#include "softarm/effects/identify_extended.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "without_effects.h"

namespace softarm::effects {
namespace {

constexpr int kMostRounds = 6;
constexpr double kSame = 0.05;  // of a standard deviation

}  // namespace

identify::Result identify_extended(const Arm& arm, const std::vector<Present>& effects,
                                   const std::vector<identify::Trial>& trials,
                                   const identify::Options& options,
                                   const identify::ProgressCallback& progress, unsigned jobs) {
  if (effects.empty()) return identify::identify(arm, trials, options, progress);
  double done = 0.0;
  const auto report = [&](double share) {
    if (progress) progress(done = std::max(done, share));
  };
  Arm now = arm;
  identify::Result result;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<identify::Trial> plain = without_effects(now, effects, trials, jobs);
    identify::Result next = identify::identify(arm, plain, options, [&](double share) {
      // Two rounds are usual; the bar slows down where there are more.
      const double left = std::pow(0.4, round);
      report(1.0 - left + 0.6 * left * share);
    });
    bool same = round > 0;
    for (std::size_t k = 0; k < next.constants.size() && same; ++k) {
      const identify::Constant &a = result.constants[k], &b = next.constants[k];
      same = std::abs(a.value - b.value) <= kSame * b.sd;
    }
    result = std::move(next);
    now = result.arm;
    if (same) break;
  }
  report(1.0);
  return result;
}

}  // namespace softarm::effects
