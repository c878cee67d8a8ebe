// Inputs that stick, clip, move in steps, are noisy or never move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "arm/input_kind.h"
#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// A run of equal values.
struct Run {
  std::size_t from = 0, to = 0;  // [from, to)
};

/// @param gap_s beyond which nobody knows what was between two values
std::vector<Run> runs_of(const std::vector<ValuePoint>& points, double gap_s) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t j = i + 1;
    while (j < points.size() && points[j].value == points[i].value &&
           points[j].t_s - points[j - 1].t_s < gap_s)
      ++j;
    runs.push_back({i, j});
    i = j;
  }
  return runs;
}

/// Largest step among a few samples beside a run; 0 beyond the ends.
double steps_beside(const std::vector<ValuePoint>& points, std::size_t from, std::size_t to) {
  std::vector<double> steps;
  for (std::size_t i = std::max<std::size_t>(from, 1); i < std::min(to, points.size()); ++i) {
    steps.push_back(std::abs(points[i].value - points[i - 1].value));
  }
  return math::median(steps);
}

/// Stretches in which an input holds one value for no good reason.
struct Holds {
  std::vector<CheckSpan> stuck, clipped;
  double longest_stuck_s = 0.0;
};

/// Steps before and after a hold. A command that holds comes to rest smoothly or at once, and leaves so; a
/// sensor that sticks stops in the middle of a motion (or of its noise) and goes on where the truth is.
Holds holds_of(const Signal& signal) {
  constexpr std::size_t kBeside = kPolicy.signals.beside;
  constexpr double kLeap = kPolicy.signals.leap;
  const auto& points = signal.points;
  const std::vector<Run> runs = runs_of(points, kPolicy.timing.gap_periods * signal.period_s);
  Holds found;
  std::vector<double> all_s;
  for (const Run& run : runs) all_s.push_back(points[run.to - 1].t_s - points[run.from].t_s);
  const double usual_s = math::quantile(all_s, kPolicy.signals.usual_hold);
  for (const Run& run : runs) {
    const double for_s = points[run.to - 1].t_s - points[run.from].t_s;
    if (run.to - run.from < kPolicy.signals.stuck_samples || for_s < kPolicy.signals.stuck_s) continue;
    const double value = points[run.from].value;
    const double before = steps_beside(points, run.from > kBeside ? run.from - kBeside : 0, run.from + 1);
    const double after = steps_beside(points, run.to + 1, run.to + 1 + kBeside);
    const double leap = run.to < points.size() ? std::abs(points[run.to].value - value) : 0.0;
    const bool noisy = signal.is_measured && signal.noise_sd > 0.0 &&
                       for_s > kPolicy.signals.stuck_holds * usual_s + kPolicy.signals.stuck_s;
    const bool stops =
        before > 0.0 && std::abs(points[run.from].value - points[run.from > 0 ? run.from - 1 : 0].value) >
                            kPolicy.signals.sharp * before;
    const bool goes_on = run.to == points.size() || leap > kLeap * std::max(after, before);
    const bool at_limit = value == signal.high || value == signal.low;
    const CheckSpan span{points[run.from].t_s, points[run.to - 1].t_s};
    if (at_limit && value != 0.0 && noisy && leap < kLeap * std::max(after, kLeap * signal.noise_sd)) {
      found.clipped.push_back(span);
    } else if (noisy || (stops && goes_on && before > kPolicy.signals.still * signal.range() && leap > 0.0)) {
      found.stuck.push_back(span);
      found.longest_stuck_s = std::max(found.longest_stuck_s, for_s);
    }
  }
  return found;
}

void say_stuck(Context& context, const Signal& signal) {
  auto [stuck, clipped, longest] = holds_of(signal);
  if (!stuck.empty()) {
    CheckFinding& finding = context.add(
        longest > kPolicy.signals.serious_stuck_share * context.duration_s ? Severity::kSerious
                                                                           : Severity::kWarning,
        "stuck_input", signal.input->name,
        fmt::format(
            "repeats one value to the last bit for up to {:.2f} s in the middle of a motion ({} time{})",
            longest, stuck.size(), stuck.size() == 1 ? "" : "s"));
    finding.figure = longest;
    finding.unit = "s";
    if (stuck.size() > kMostSpans) stuck.resize(kMostSpans);
    finding.spans = stuck;
    finding.remedy =
        "sensor, bus or driver hangs: leave these stretches out; let the driver send nothing when it "
        "has nothing new, so that input_max_age_s notices";
  }
  if (clipped.size() >= kPolicy.signals.least_clipped) {
    CheckFinding& finding =
        context.add("saturated_input", signal.input->name,
                    fmt::format("sits at its limit of {:.4g} {} {} times, without its noise", signal.high,
                                unit_of(signal.input->kind), clipped.size()));
    finding.figure = signal.high;
    finding.unit = unit_of(signal.input->kind);
    finding.spans = clipped;
    finding.remedy =
        "beyond the sensor's range the real value is larger: a sensor of a wider range, or less drive";
  }
}

/// Steps of a converter that shows some.
struct Coarse {
  const Signal* signal = nullptr;
  double share = 0.0;  ///< of the range
  bool warns() const { return share > kPolicy.signals.coarse_share; }
};

std::optional<Coarse> coarse_steps(const Signal& signal) {
  if (signal.range() <= 0.0 || signal.quantum <= 0.0) return std::nullopt;
  std::vector<double> distinct;
  for (const ValuePoint& p : signal.points) distinct.push_back(p.value);
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(
      std::unique(distinct.begin(), distinct.end(),
                  [&](double a, double b) { return b - a < kPolicy.signals.one_value * signal.quantum; }),
      distinct.end());
  if (distinct.size() < kPolicy.signals.least_distinct) return std::nullopt;
  return Coarse{&signal, signal.quantum / signal.range()};
}

/// "0.644", or "0.64 to 0.7" where the rounded ends differ.
std::string from_to(double low, double high, int digits) {
  const std::string from = fmt::format("{:.{}g}", low, digits), to = fmt::format("{:.{}g}", high, digits);
  return from == to ? from : from + " to " + to;
}

/// All inputs of one unit and severity in one finding: a recorder mostly has one converter for all.
void say_coarse(Context& context, const std::vector<Coarse>& all) {
  const auto alike = [](const Coarse& a, const Coarse& b) {
    return a.warns() == b.warns() && unit_of(a.signal->input->kind) == unit_of(b.signal->input->kind);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const Coarse& before) { return alike(before, all[i]); }))
      continue;
    std::string names;
    const Coarse* worst = &all[i];
    double low = all[i].signal->quantum, high = low, least = all[i].share;
    std::size_t count = 0;
    for (const Coarse& one : all) {
      if (!alike(one, all[i])) continue;
      ++count;
      names += (names.empty() ? "" : ", ") + one.signal->input->name;
      low = std::min(low, one.signal->quantum);
      high = std::max(high, one.signal->quantum);
      least = std::min(least, one.share);
      if (one.share > worst->share) worst = &one;
    }
    const std::string unit = unit_of(worst->signal->input->kind);
    CheckFinding& finding =
        context.add(worst->warns() ? Severity::kWarning : Severity::kInformation, "coarse_steps", names,
                    fmt::format("move{} in steps of {} {} ({} % of {} range{})", count == 1 ? "s" : "",
                                from_to(low, high, 3), unit, from_to(100.0 * least, 100.0 * worst->share, 2),
                                count == 1 ? "its" : "their", count == 1 ? "" : "s"));
    finding.figure = worst->signal->quantum;
    finding.unit = unit;
    finding.remedy =
        "a converter of more bits, or a sensor of a narrower range; the error is a third of a step";
  }
}

void say_noisy(Context& context, const Signal& signal) {
  const double range = signal.range();
  // Rounding, and flicker between two steps, have had their word.
  if (range <= 0.0 || !signal.is_measured ||
      signal.noise_sd <=
          std::max(kPolicy.signals.least_noise * range, kPolicy.signals.flicker * signal.quantum))
    return;
  const std::string unit = unit_of(signal.input->kind);
  const bool noisy = signal.noise_sd > kPolicy.signals.coarse_share * range;
  CheckFinding& finding =
      context.add(noisy ? Severity::kWarning : Severity::kInformation, "noisy_input", signal.input->name,
                  fmt::format("noise of {:.3g} {} from sample to sample ({:.1f} % of its range)",
                              signal.noise_sd, unit, 100.0 * signal.noise_sd / range));
  finding.figure = signal.noise_sd;
  finding.unit = unit;
  finding.remedy = "shielding, an RC filter before the converter; inputs are held, not averaged";
}

void check_input_signals(Context& context) {
  std::vector<Coarse> coarse;
  bool any_moves = false;
  for (const Signal& s : context.signals)
    any_moves = any_moves || s.range() > kPolicy.signals.moves_noises * s.noise_sd;
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    const Signal& signal = context.signals[i];
    std::size_t not_numbers = 0;
    for (const trial::RecordedValue& v : context.recording.inputs[i]) not_numbers += !std::isfinite(v.value);
    if (not_numbers > 0) {
      CheckFinding& finding = context.add(
          "input_not_number", signal.input->name,
          fmt::format("{} of {} values are not a number", not_numbers, context.recording.inputs[i].size()));
      finding.figure =
          static_cast<double>(not_numbers) / static_cast<double>(context.recording.inputs[i].size());
      finding.unit = "1";
      finding.remedy = "element of the array, wiring of the sensor";
    }
    if (signal.points.size() < kPolicy.signals.least_values) continue;
    if (!signal.is_driven()) {
      if (any_moves) {
        context
            .add("never_driven", signal.input->name,
                 fmt::format("never changes ({:.4g} {}): this trial says nothing about it", signal.high,
                             unit_of(signal.input->kind)))
            .remedy = "if it was driven, its sensor is dead or its topic is that of another input";
      }
      continue;
    }
    say_stuck(context, signal);
    if (const auto steps = coarse_steps(signal)) coarse.push_back(*steps);
    say_noisy(context, signal);
  }
  say_coarse(context, coarse);
}

}  // namespace

Check make_input_signals() {
  return {check_input_signals,
          {{"input_not_number", Severity::kWarning},
           {"never_driven", Severity::kInformation},
           {"stuck_input", {}},
           {"saturated_input", Severity::kWarning},
           {"coarse_steps", {}},
           {"noisy_input", {}}}};
}

}  // namespace softarm::check
