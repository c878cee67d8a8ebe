#include "identify_extended.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "belonging.h"
#include "effect_lines.h"

namespace softarm::identify {
namespace {

constexpr int kMostRounds = 6;
constexpr double kSame = 0.05;     // of a standard deviation
constexpr double kFollows = 0.03;  // of the arm's length, that a fit of the right arm leaves at most

/// As EffectLines takes them.
std::map<std::size_t, Eigen::VectorXd> starts_of(const Result& result,
                                                 const std::vector<trial::Trial>& trials,
                                                 const EffectLines& lines) {
  std::map<std::size_t, std::vector<double>> values;
  for (const EffectStart& start : result.effect_starts) {
    const auto trial = std::find_if(trials.begin(), trials.end(),
                                    [&](const trial::Trial& one) { return one.name == start.trial; });
    std::vector<double>& list = values[static_cast<std::size_t>(trial - trials.begin())];
    list.push_back(start.value / lines.start(static_cast<Eigen::Index>(list.size())).sd);
  }
  std::map<std::size_t, Eigen::VectorXd> starts;
  for (const auto& [trial, list] : values)
    starts[trial] = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  return starts;
}

Result in_rounds(const arm::Arm& arm, const std::vector<model::Present>& effects,
                 const std::vector<trial::Trial>& trials, const Options& options,
                 const ProgressCallback& progress, unsigned jobs) {
  double done = 0.0;
  const auto report = [&](double share) {
    if (progress) progress(done = std::max(done, share));
  };
  // Each trial in its turn only about the constants that are found.
  Options rounds = options;
  rounds.leave_one_out = false;
  if (options.leave_one_out) rounds.held_out_share = 0.0;
  arm::Arm now = arm;
  std::map<std::size_t, Eigen::VectorXd> starts;
  Result result;
  bool same = false;
  for (int round = 0; round < kMostRounds && !same; ++round) {
    EffectLines lines(now, effects, trials, jobs, starts);
    Result next = identify_with(arm, lines, rounds, [&](double share) {
      // Two rounds are usual; the bar slows down where there are more.
      const double left = std::pow(0.4, round);
      report(1.0 - left + 0.6 * left * share);
    });
    same = round > 0;
    for (std::size_t k = 0; k < next.constants.size() && same; ++k) {
      const Constant &a = result.constants[k], &b = next.constants[k];
      same = std::abs(a.value - b.value) <= kSame * b.sd;
    }
    result = std::move(next);
    now = result.arm;
    starts = starts_of(result, trials, lines);
  }
  if (options.leave_one_out) {
    EffectLines lines(now, effects, trials, jobs);
    result = identify_with(arm, lines, options, report);
  }
  report(1.0);
  return result;
}

}  // namespace

Result identify_extended(const arm::Arm& arm, const std::vector<model::Present>& effects,
                         const std::vector<trial::Trial>& trials, const Options& options,
                         const ProgressCallback& progress, unsigned jobs) {
  const Belonging found = belonging(arm, trials);
  const std::string apart = describe(found);
  Result result;
  try {
    result = effects.empty() ? identify(arm, trials, options, progress)
                             : in_rounds(arm, effects, trials, options, progress, jobs);
  } catch (const IdentifyError& error) {
    if (apart.empty()) throw;
    throw IdentifyError(apart + "; " + error.what());
  }
  if (found.together) {
    if (!apart.empty()) result.warnings.insert(result.warnings.begin(), apart);
    return result;
  }
  const ShapeError& after = result.held_out.frames > 0 ? result.held_out : result.fitted;
  const bool followed = after.frames > 0 && after.mean_m < kFollows * arm.total_length_m();
  if (!followed || (!found.tried.empty() && found.tried.front().mean_m < after.mean_m)) {
    result.apart = apart;
  } else if (found.mean_m) {
    result.warnings.insert(
        result.warnings.begin(),
        fmt::format("THE ARM FILE'S LAWS WERE FAR OFF, by {:.0f} mm, and the fitted ones are not: are the "
                    "units and order of the inputs those of the arm file?",
                    1e3 * *found.mean_m));
  }
  return result;
}

}  // namespace softarm::identify
