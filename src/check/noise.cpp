// Noise of the bodies, against what the arm file states.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

/// What does not forget itself within a tenth of a second, in a coordinate while the arm is at rest: 0 where
/// the stretch is too short or there is nothing.
double slow_sd(const Track& track, const CheckSpan& span) {
  const double block_s = std::max(kPolicy.noise.lag_s, kPolicy.noise.lag_periods * track.period_s);
  std::vector<Eigen::Vector3d> means;
  double n = 0.0;
  for (double t = span.from_s; t + block_s <= span.to_s; t += block_s) {
    if (const auto mean = track.mean_position(t, t + block_s)) means.push_back(*mean);
  }
  if (means.size() < kPolicy.noise.least_blocks) return 0.0;
  n = std::max(3.0, block_s / std::max(track.period_s, 1e-4));
  // Less a straight line: creep of an arm at rest is no noise.
  const double middle = 0.5 * static_cast<double>(means.size() - 1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
  double spread = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    const double x = static_cast<double>(k) - middle;
    mean += means[k] / static_cast<double>(means.size());
    slope += x * means[k];
    spread += x * x;
  }
  slope /= spread;
  double sum = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    sum += (means[k] - mean - (static_cast<double>(k) - middle) * slope).squaredNorm();
  }
  const double variance = sum / (3.0 * static_cast<double>(means.size() - 2));
  const double white = track.white_sd_m * track.white_sd_m / n;
  const double error = white * std::sqrt(2.0 / (3.0 * static_cast<double>(means.size() - 2)));
  return variance > white + kPolicy.noise.errors * error ? std::sqrt(variance - white) : 0.0;
}

/// Of all bodies.
struct Measured {
  double worst = 0.0;  // noise over what the arm file states
  double stated_m = 0.0;
  std::string worst_name, worst_setting, table;
  std::string wandering;  // names of those whose noise does not average out
  double slowest_m = 0.0;
  std::vector<std::string> too_small;  // settings of those whose noise is more than the arm file's

  double noise_m() const { return worst * stated_m; }
};

/// Also notes at each track what does not average out.
Measured measure(Context& context) {
  const auto rest = context.still();
  const bool moved = context.found({"base_bumped", "base_drifts"});
  Measured all;
  for (Track& track : context.tracks) {
    if (track.white_sd_m <= 0.0) continue;
    // The mount is at rest all the time.
    const CheckSpan span = track.is_base() ? CheckSpan{0.0, context.duration_s} : rest.value_or(CheckSpan{});
    const double slow = track.is_base() && moved ? 0.0 : slow_sd(track, span);
    track.slow_sd_m = slow;
    const double total = std::hypot(track.white_sd_m, slow);
    all.table +=
        fmt::format("{}{} {:.3g} mm{}", all.table.empty() ? "" : ", ", track.name, 1e3 * track.white_sd_m,
                    slow > 0.0 ? fmt::format(" and {:.3g} mm slow", 1e3 * slow) : "");
    const double usual = track.is_base() ? 0.0 : track.body->position_sd_m;
    if (slow > std::max(kPolicy.noise.slow_m, kPolicy.noise.slow_of_white * track.white_sd_m) &&
        slow > kPolicy.noise.slow_of_stated * usual) {
      all.wandering += (all.wandering.empty() ? "" : ", ") + track.name;
      all.slowest_m = std::max(all.slowest_m, slow);
      if (total > usual) all.too_small.push_back(position_sd_setting(track, total));
    }
    if (track.is_base()) continue;
    if (total / usual > all.worst) {
      all.stated_m = usual;
      all.worst = total / usual;
      all.worst_name = track.name;
      all.worst_setting = position_sd_setting(track, total);
    }
  }
  return all;
}

void say_correlated(Context& context, const Measured& all) {
  CheckFinding& finding =
      context.add("correlated_noise", all.wandering,
                  fmt::format("at rest {} by up to {:.2g} mm (sd) over tenths of a second and more",
                              all.wandering.find(',') == std::string::npos ? "it wanders" : "they wander",
                              1e3 * all.slowest_m));
  finding.figure = all.slowest_m;
  finding.unit = "m";
  finding.remedy =
      "averaging frames will not remove it: state the sum. Possible causes: a vibrating tripod, refraction, "
      "reflections, or an arm that was not at rest";
  // The one setting there is says noise_understated.
  if (all.worst <= kPolicy.noise.too_small) {
    finding.setting = joined(all.too_small);
  }
}

void say_understated(Context& context, const Measured& all) {
  CheckFinding& finding = context.add(
      "noise_understated", all.worst_name,
      fmt::format("its noise is {:.2g} mm, the arm file states {:.2g} mm: intervals will be too narrow",
                  1e3 * all.worst * all.stated_m, 1e3 * all.stated_m));
  finding.figure = all.noise_m();
  finding.unit = "m";
  finding.remedy = "state it, or find its cause (calibration, few markers)";
  finding.setting = all.worst_setting;
}

void say_overstated(Context& context, const Measured& all) {
  // No setting: what identify writes stands for the model's errors, and is right.
  context.add("noise_overstated", "",
              fmt::format("the arm file states {:.2g} mm where no body has more than {:.2g} mm: right if it "
                          "stands for the model's errors",
                          1e3 * all.stated_m, 1e3 * all.noise_m()));
}

void check_noise(Context& context) {
  const Measured all = measure(context);
  if (all.table.empty()) return;
  CheckFinding& noise =
      context.add("noise", "", fmt::format("noise of a coordinate, from sample to sample: {}", all.table));
  if (all.worst > 0.0) {
    noise.figure = all.noise_m();
    noise.unit = "m";
  }
  if (!all.wandering.empty()) say_correlated(context, all);
  if (all.worst > kPolicy.noise.too_small) {
    say_understated(context, all);
  } else if (all.worst > 0.0 && all.worst < 1.0 / kPolicy.noise.too_large && all.wandering.empty()) {
    say_overstated(context, all);
  }
}

}  // namespace

Check make_noise() {
  return {check_noise,
          {{"noise", Severity::kInformation},
           {"correlated_noise", Severity::kWarning},
           {"noise_understated", Severity::kWarning},
           {"noise_overstated", Severity::kInformation}}};
}

}  // namespace softarm::check
