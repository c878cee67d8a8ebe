#include "identify_extended.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "effect_lines.h"

namespace softarm::identify {
namespace {

constexpr int kMostRounds = 6;
constexpr double kSame = 0.05;  // of a standard deviation

/// What was before is what was before the first round.
void put_start(const Result& first, Result& result) {
  for (std::size_t k = 0; k < result.constants.size(); ++k)
    result.constants[k].initial = first.constants[k].initial;
  result.fitted_before = first.fitted_before;
  result.held_out_before = first.held_out_before;
  result.left_out_one_before = first.left_out_one_before;
  for (std::size_t t = 0; t < result.trials.size(); ++t) result.trials[t].before = first.trials[t].before;
}

}  // namespace

Result identify_extended(const arm::Arm& arm, const std::vector<model::Present>& effects,
                         const std::vector<trial::Trial>& trials, const Options& options,
                         const ProgressCallback& progress, unsigned jobs) {
  if (effects.empty()) return identify(arm, trials, options, progress);
  double done = 0.0;
  const auto report = [&](double share) {
    if (progress) progress(done = std::max(done, share));
  };
  arm::Arm now = arm;
  Result first, result;
  for (int round = 0; round < kMostRounds; ++round) {
    Result next = identify_with(now, EffectLines(now, effects, trials, jobs), options, [&](double share) {
      // Two rounds are usual; the bar slows down where there are more.
      const double left = std::pow(0.4, round);
      report(1.0 - left + 0.6 * left * share);
    });
    if (round == 0) first = next;
    bool same = round > 0;
    for (std::size_t k = 0; k < next.constants.size() && same; ++k) {
      const Constant &a = result.constants[k], &b = next.constants[k];
      same = std::abs(a.value - b.value) <= kSame * b.sd;
    }
    result = std::move(next);
    now = result.arm;
    if (same) break;
  }
  put_start(first, result);
  report(1.0);
  return result;
}

}  // namespace softarm::identify
