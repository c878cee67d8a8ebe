// The tables that people read.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "advice.h"
#include "input_report.h"
#include "policy.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

constexpr double kCorrelationToSay = 0.9;
constexpr std::size_t kMostCorrelations = 12;
constexpr std::size_t kMostCombinations = 4;

std::string error_row(const std::string& name, const ShapeError& e, std::size_t width = 24) {
  const auto cell = [&](double m) { return fmt::format("{:.2f} mm {:5.2f} %", 1e3 * m, e.percent(m)); };
  return fmt::format("  {:<{}}{:>18}{:>18}{:>18}{:>18}{:>9}\n", name, width, cell(e.mean_m), cell(e.median_m),
                     cell(e.maximum_m), cell(e.minimum_m), e.frames);
}

/// How the trials found walls and effects.
std::string starts_of(const Result& result) {
  std::string text;
  const auto add = [&](const std::string& trial, const std::string& of, const auto& start) {
    text +=
        fmt::format("  {:<32}{:<32}{:>9.3g} +- {:.2g} {}\n", trial, of, start.value, start.sd, start.unit);
  };
  if (!result.starts.empty()) text += "walls when the trials began, beyond what the laws say:\n";
  for (const WallStart& s : result.starts) add(s.trial, s.segment + ".wall." + s.element, s);
  if (!result.effect_starts.empty()) text += "effects when the trials began, 0 at rest:\n";
  for (const EffectStart& s : result.effect_starts) add(s.trial, s.effect + ", " + s.of, s);
  return text;
}

/// Moved there by the fit: not a law that is off from the start.
bool at_limit(const Constant& c) {
  return c.at_bound && (c.kept || (c.value != c.initial && !is_none(c)));
}

/// What the percentages are of, where that is not the value itself.
std::string sizes_line(const Result& result) {
  std::string list;
  for (const Constant& c : result.constants) {
    if (c.scale <= 1.001 * std::abs(c.value) || !(c.sd < 10.0 * c.scale)) continue;
    const std::string one = fmt::format("{} {:.2g} {}", c.name, c.scale, c.unit);
    list += (list.empty() ? "" : ", ") + one;
  }
  return list.empty()
             ? ""
             : "of size: relative to the value, or where that is near zero, to what would matter: " + list +
                   "\n";
}

std::string constants_table(const Result& result) {
  std::size_t width = 8;
  for (const Constant& c : result.constants) width = std::max(width, c.name.size());
  std::string text = fmt::format("{:<{}}  {:>12} {:>12} {:>8}  {:>12}  {:<10} {}\n", "constant", width,
                                 "value", "+- sd", "of size", "before", "unit", "identifiable");
  for (const Constant& c : result.constants) {
    // Beyond ten times the constant's size an sd is only another way to say "not identifiable".
    const bool sd_means_something = c.sd < 10.0 * c.scale;
    const std::string sd = sd_means_something ? fmt::format("{:.2g}", c.sd) : "-";
    const double relative = 100.0 * c.sd / c.scale;
    const std::string percent =
        sd_means_something ? fmt::format("{:.{}f} %", relative, relative < 10.0 ? 1 : 0) : "";
    text += fmt::format("{:<{}}  {:>12.5g} {:>12} {:>8}  {:>12.5g}  {:<10} {}\n", c.name, width, c.value, sd,
                        percent, c.initial, c.unit,
                        c.determined  ? "yes"
                        : at_limit(c) ? "LIMIT"
                                      : "NO");
  }
  text += sizes_line(result);
  const bool elongations =
      std::any_of(result.constants.begin(), result.constants.end(),
                  [](const Constant& c) { return c.ref.kind == ConstantKind::kElongation; });
  if (elongations)
    text += "elongation: near plus far of a chamber; only the sum enters a shape, no trial separates them\n";
  return text;
}

std::string identifiable_text(const Result& result) {
  // What several lack is said once.
  std::vector<std::pair<std::string, std::string>> lines;  // advice, names
  for (const Constant& c : result.constants) {
    if (c.determined && c.advice.empty()) continue;
    const std::string said = at_limit(c) ? "AT ITS LIMIT, not identifiable: " : "NOT IDENTIFIABLE: ";
    auto line = std::find_if(lines.begin(), lines.end(), [&](const auto& one) {
      return one.first == c.advice && one.second.rfind(said, 0) == 0;
    });
    if (line == lines.end()) line = lines.insert(lines.end(), {c.advice, said});
    line->second += (line->second.size() == said.size() ? "" : ", ") + c.name;
  }
  std::string text;
  for (const auto& [advice, names] : lines) text += names + ": " + advice + "\n";
  std::size_t combinations = 0;
  for (const Combination& combination : result.undetermined) {
    if (combination.parts.size() < 2 || ++combinations > kMostCombinations) continue;
    std::string parts;
    for (const auto& [name, share] : combination.parts)
      parts += fmt::format("{}{:+.2f} {}", parts.empty() ? "" : ", ", share, name);
    text += fmt::format("not identifiable together: {}\n", parts);
  }
  if (combinations > kMostCombinations)
    text += fmt::format(
        "not identifiable together: {} more combinations, better determined than these (--json has all)\n",
        combinations - kMostCombinations);
  return text;
}

std::string correlation_text(const Result& result) {
  struct Pair {
    double value;
    int a, b;
  };
  std::vector<Pair> pairs;
  for (int j = 0; j < result.correlation.rows(); ++j) {
    for (int k = 0; k < j; ++k) {
      if (std::abs(result.correlation(j, k)) >= kCorrelationToSay)
        pairs.push_back({result.correlation(j, k), k, j});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return std::abs(a.value) > std::abs(b.value); });
  if (pairs.empty()) return "correlations: none beyond 0.9\n";
  std::string text = "correlations beyond 0.9:\n";
  for (std::size_t i = 0; i < pairs.size() && i < kMostCorrelations; ++i) {
    text += fmt::format("  {:+.3f}  {}  {}\n", pairs[i].value,
                        result.constants[static_cast<std::size_t>(pairs[i].a)].name,
                        result.constants[static_cast<std::size_t>(pairs[i].b)].name);
  }
  if (pairs.size() > kMostCorrelations)
    text += fmt::format("  and {} more\n", pairs.size() - kMostCorrelations);
  return text;
}

std::string errors_table(const Result& result) {
  std::string text = fmt::format("{:<26}{:>18}{:>18}{:>18}{:>18}{:>9}\n", "shape error (% of length)", "mean",
                                 "median", "maximum", "minimum", "frames");
  text += error_row("fitted trials, before", result.fitted_before);
  text += error_row("fitted trials, after", result.fitted);
  if (!result.left_out_one.empty()) {
    text += error_row("each by others, before", result.left_out_one_before);
    return text + error_row("each by others, after", result.left_out_one_after);
  }
  if (result.held_out.frames == 0) return text + "  no trial is unseen: nothing says how far to trust this\n";
  text += error_row("unseen trials, before", result.held_out_before);
  text += error_row("unseen trials, after", result.held_out);
  return text;
}

/// Mean distance of bodies from where they are that the stated noise alone would give.
double noise_m(const arm::Arm& arm) {
  double most = 0.0;
  for (const arm::MeasuredBody& body : arm.bodies)
    most = std::max(most, std::hypot(body.position_sd_m, body.placement_sd_m));
  return kMeanOverSd * most;
}

/// The errors on what was not fitted, before and after.
std::pair<ShapeError, ShapeError> unseen_errors(const Result& result) {
  if (!result.left_out_one.empty()) return {result.left_out_one_before, result.left_out_one_after};
  return {result.held_out_before, result.held_out};
}

std::string trials_text(const Result& result) {
  std::string text;
  for (const TrialSummary& trial : result.trials)
    text += fmt::format("  {:<32}{:<9} frames {:>5}, mean error {:7.2f} mm -> {:.2f} mm\n", trial.name,
                        trial.held_out ? "unseen" : "fitted", trial.frames, 1e3 * trial.before.mean_m,
                        1e3 * trial.after.mean_m);
  if (result.left_out_one.empty()) return text;
  std::size_t width = 24;
  for (const TrialSummary& trial : result.left_out_one) width = std::max(width, trial.name.size());
  text += fmt::format("each trial by the fit to the others:\n  {:<{}}{:>18}{:>18}{:>18}{:>18}{:>9}\n", "",
                      width, "mean", "median", "maximum", "minimum", "frames");
  for (const TrialSummary& trial : result.left_out_one) text += error_row(trial.name, trial.after, width);
  return text;
}

}  // namespace

std::optional<bool> generalises(const Result& result) {
  if (!result.apart.empty()) return false;
  const auto [before, after] = unseen_errors(result);
  if (after.frames == 0) return std::nullopt;
  return after.mean_m < (1.0 - kLeastGain) * before.mean_m || after.mean_m <= noise_m(result.arm);
}

std::string verdict(const Result& result) {
  if (!result.apart.empty()) return result.apart;
  const std::optional<bool> good = generalises(result);
  if (!good) return "no trial is unseen: nothing says whether this generalises";
  const auto [before, after] = unseen_errors(result);
  const std::string change =
      fmt::format("{:.2f} → {:.2f} mm on unseen trials", 1e3 * before.mean_m, 1e3 * after.mean_m);
  if (!*good) return fmt::format("does not generalise: {}; run diagnose", change);
  if (after.mean_m < (1.0 - kLeastGain) * before.mean_m) return fmt::format("generalises: {}", change);
  return fmt::format("as good as before: {}, no more than noise", change);
}

std::string describe(const Result& result) {
  std::string text;
  for (const std::string& warning : result.warnings) text += warning + "\n";
  text += constants_table(result);
  text += identifiable_text(result);
  text += correlation_text(result);
  text += errors_table(result);
  text += "trials:\n" + trials_text(result) + starts_of(result);
  text += fmt::format(
      "fit: {} frames, {} bodies, {} iterations{}; misfit {:.2f} times the stated noise ({:.2f} mm rms per "
      "coordinate);\n     {:.1f} consecutive frames are worth one; intervals {:.2f} times those of noise "
      "alone\n",
      result.frames, result.bodies, result.iterations, result.converged ? "" : " (NOT converged)",
      result.misfit, 1e3 * result.position_rms_m, result.autocorrelation, result.uncertainty_factor);
  text += describe_input_errors(result);
  for (const auto& [reason, count] : result.left_out)
    text += fmt::format("left out: {} frames: {}\n", count, reason);
  for (const auto& [body, count] : result.bodies_set_aside)
    text += fmt::format("outliers: {} observations of {}\n", count, body);
  for (const auto& [body, count] : result.beyond_the_model)
    text += fmt::format(
        "misfit: {} observations of {} lie as far off as outliers would, more than a tenth of them: the laws "
        "are "
        "wrong there, not the frames; they are kept\n",
        count, body);
  const arm::LawPrior& prior = result.prior;
  const bool stretches =
      std::any_of(result.arm.segments.begin(), result.arm.segments.end(),
                  [](const arm::Segment& segment) { return segment.axial_stiffness_n.has_value(); });
  text += fmt::format(
      "prior for the estimator: moment {:.4f} N m and {:.1f} %, EI {:.1f} %, length {:.2f} mm{}; from frame "
      "to "
      "frame {:.4f} N m, {:.2f} mm\n",
      prior.moment_sd_nm, 100.0 * prior.moment_sd_rel, 100.0 * prior.bending_stiffness_sd_rel,
      1e3 * prior.length_sd_m,
      stretches ? fmt::format(", EA {:.0f} %", 100.0 * prior.axial_stiffness_sd_rel) : "",
      prior.moment_jitter_sd_nm, 1e3 * prior.length_jitter_sd_m);
  for (const std::string& note : result.prior_notes) text += "prior: " + note + "\n";
  return text;
}

}  // namespace softarm::identify
