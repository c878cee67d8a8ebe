// Noise of the bodies, against what the arm file states.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// What does not forget itself within a tenth of a second, in a coordinate while the arm is at rest: 0 where
/// the stretch is too short or there is nothing.
double slow_sd(const Track& track, const CheckSpan& span) {
  const double block_s = std::max(kPolicy.noise.lag_s, 6.0 * track.period_s);
  std::vector<Eigen::Vector3d> means;
  double n = 0.0;
  for (double t = span.from_s; t + block_s <= span.to_s; t += block_s) {
    if (const auto mean = track.mean_position(t, t + block_s)) means.push_back(*mean);
  }
  if (means.size() < 5) return 0.0;
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
  // Three standard errors of the variance, beyond which it is believed.
  const double error = white * std::sqrt(2.0 / (3.0 * static_cast<double>(means.size() - 2)));
  return variance > white + 3.0 * error ? std::sqrt(variance - white) : 0.0;
}

}  // namespace

void check_noise(Context& context) {
  const auto rest = context.rest();
  double worst = 0.0, least = 1e9, stated = 0.0;
  std::string worst_name, table;
  std::string wandering;
  double slowest = 0.0, largest = 0.0;
  const bool moved = std::any_of(context.findings.begin(), context.findings.end(), [](const CheckFinding& f) {
    return f.id == "base_bumped" || f.id == "base_drifts";
  });
  for (Track& track : context.tracks) {
    if (track.white_sd_m <= 0.0) continue;
    // The mount is at rest all the time.
    const CheckSpan span = track.is_base() ? CheckSpan{0.0, context.duration_s} : rest.value_or(CheckSpan{});
    const double slow = track.is_base() && moved ? 0.0 : slow_sd(track, span);
    track.slow_sd_m = slow;
    const double total = std::hypot(track.white_sd_m, slow);
    table += fmt::format("{}{} {:.3g} mm{}", table.empty() ? "" : ", ", track.name, 1e3 * track.white_sd_m,
                         slow > 0.0 ? fmt::format(" and {:.3g} mm slow", 1e3 * slow) : "");
    const double usual = track.is_base() ? 0.0 : track.body->position_sd_m;
    if (slow > std::max(5e-5, 0.5 * track.white_sd_m) && slow > 0.3 * usual) {
      wandering += (wandering.empty() ? "" : ", ") + track.name;
      slowest = std::max(slowest, slow);
      largest = std::max(largest, total);
    }
    if (track.is_base()) continue;
    stated = track.body->position_sd_m;
    if (total / stated > worst) {
      worst = total / stated;
      worst_name = track.name;
    }
    least = std::min(least, total / stated);
  }
  if (table.empty()) return;
  CheckFinding& noise = context.add(Severity::kInformation, "noise", "",
                                    fmt::format("noise of a coordinate, from sample to sample: {}", table));
  if (worst > 0.0) {
    noise.figure = worst * stated;
    noise.unit = "m";
  }
  if (!wandering.empty()) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "correlated_noise", wandering,
        fmt::format("at rest {} by up to {:.2g} mm (sd) over tenths of a second and more",
                    wandering.find(',') == std::string::npos ? "it wanders" : "they wander", 1e3 * slowest));
    finding.figure = slowest;
    finding.unit = "m";
    finding.remedy =
        "averaging frames will not remove it: state the sum; a vibrating tripod, refraction, "
        "reflections; or the arm was not at rest";
    // The one setting there is says it below.
    if (worst <= kPolicy.noise.too_small)
      finding.setting = fmt::format("noise.position_sd_m: {:.2g}", largest);
  }
  if (worst > kPolicy.noise.too_small) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "noise_understated", worst_name,
        fmt::format("its noise is {:.2g} mm, the arm file states {:.2g} mm: intervals will be too narrow",
                    1e3 * worst * stated, 1e3 * stated));
    finding.figure = worst * stated;
    finding.unit = "m";
    finding.remedy = "state it, or find its cause (calibration, few markers)";
    finding.setting = fmt::format("noise.position_sd_m: {:.2g}", worst * stated);
  } else if (worst > 0.0 && worst < 1.0 / kPolicy.noise.too_large && wandering.empty()) {
    context
        .add(Severity::kInformation, "noise_overstated", "",
             fmt::format(
                 "the arm file states {:.2g} mm where no body has more than {:.2g} mm: right if it stands "
                 "for the model's errors",
                 1e3 * stated, 1e3 * worst * stated))
        .setting = fmt::format("noise.position_sd_m: {:.2g}", worst * stated);
  }
}

}  // namespace softarm::check
