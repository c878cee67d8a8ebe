// Levels of the inputs at rest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

struct Level {
  const Signal* signal = nullptr;
  double value = 0.0;
  double error = 0.0;  // standard error

  /// A chamber or a tendon that falls below its level later was not at its zero there.
  bool falls_below() const {
    if (signal->input->kind == arm::InputKind::kAngle) return false;
    const double grain =
        kPolicy.rest.rest_steps * signal->quantum + kPolicy.inputs.below_noises * signal->noise_sd;
    return value > 0.0 &&
           signal->least < value - std::max(grain, kPolicy.inputs.below_share * signal->range());
  }
  /// What never changes and is above its zero may as well be held there.
  bool may_be_held() const { return value > 0.0 && !signal->is_driven(); }
};

/// Of the inputs whose unit is right.
std::vector<Level> levels_at(const Context& context, const CheckSpan& rest) {
  std::vector<Level> levels;
  for (const Signal& signal : context.signals) {
    const bool wrong_unit =
        std::any_of(context.findings.begin(), context.findings.end(), [&](const CheckFinding& f) {
          return f.where == signal.input->name &&
                 (f.id == "pressure_unit" || f.id == "angle_unit" || f.id == "tension_unit");
        });
    const auto level = signal.mean(rest.from_s, rest.to_s);
    if (!level || wrong_unit) continue;
    const double values = std::max(1.0, (rest.to_s - rest.from_s) / std::max(signal.period_s, 1e-3));
    levels.push_back({&signal, *level, signal.noise_sd / std::sqrt(values)});
  }
  return levels;
}

/// Says so where all chambers rest at one exact level: they are commanded there.
bool held_at_one_level(Context& context, const std::vector<Level>& levels) {
  std::vector<double> chambers;
  for (const Level& level : levels) {
    if (level.signal->input->kind != arm::InputKind::kPressure) continue;
    if (level.signal->is_measured) return false;
    chambers.push_back(level.value);
  }
  if (chambers.size() < 2) return false;
  const auto [low, high] = std::minmax_element(chambers.begin(), chambers.end());
  const double common = math::median(chambers);
  if (!(*high - *low < kPolicy.inputs.one_level_pa && common > kPolicy.inputs.offset_pa)) return false;
  context
      .add("pressurised_at_rest", "",
           fmt::format("all chambers rest at {:.2f} kPa to the last bit: taken as commanded", 1e-3 * common))
      .remedy = "if these are sensors, their zeros are off by that";
  return true;
}

/// What a level at rest may be.
double limit_of(const Level& level) {
  const double error = kPolicy.inputs.offset_errors * level.error;
  const double share = kPolicy.inputs.offset_share * level.signal->range();
  switch (level.signal->input->kind) {
    case arm::InputKind::kPressure:
    case arm::InputKind::kVacuum:
      break;
    case arm::InputKind::kTension:
      return share + error + kPolicy.inputs.least_tension_n;
    case arm::InputKind::kAngle:
      return share + error + kPolicy.inputs.least_angle_rad;
  }
  return std::max(kPolicy.inputs.least_offset_pa, std::min(kPolicy.inputs.offset_pa, share)) + error;
}

std::string words_of(const Context& context, const Level& level) {
  const Signal& signal = *level.signal;
  const arm::InputKind kind = signal.input->kind;
  std::string what;
  if (signal.is_pressure()) {
    what = fmt::format("rests {:.2f} kPa ({}) {} ambient", 1e-3 * std::abs(level.value),
                       zero_of(context, signal).of_layout
                           ? in_unit(zero_of(context, signal), level.value)
                           : fmt::format("{:.2f} psi", std::abs(level.value) / 6894.757),
                       (level.value < 0.0) != (kind == arm::InputKind::kVacuum) ? "below" : "above");
  } else {
    what = fmt::format("rests at {:.3g} {}", level.value, kind == arm::InputKind::kTension ? "N" : "rad");
  }
  const double share = signal.range() > 0.0 ? std::abs(level.value) / signal.range() : 0.0;
  if (share > 0.0 && share < 1.0) what += fmt::format(", {:.0f} % of its range", 100.0 * share);
  if (level.value < 0.0 && kind == arm::InputKind::kPressure)
    what += ": the sensor's zero is off, chambers are not evacuated";
  return what;
}

void say_offset(Context& context, const Level& level, const CheckSpan& rest) {
  const Signal& signal = *level.signal;
  const arm::ScalarInput& input = *signal.input;
  const bool is_tension = input.kind == arm::InputKind::kTension;
  // A servo or a tendon may well be commanded to rest at a value; one that is exact is no sensor.
  const bool commanded = !signal.is_pressure() && !signal.is_measured;
  const bool held = level.may_be_held();
  CheckFinding& finding = context.add(
      commanded || held ? Severity::kInformation : Severity::kWarning, "offset_at_rest", input.name,
      words_of(context, level) + (held ? " and never changes: held there, or its zero is off" : ""));
  finding.figure = level.value;
  finding.figure_sd = level.error;
  finding.unit = signal.is_pressure() ? "Pa" : is_tension ? "N" : "rad";
  finding.spans = {rest};
  if (held) return;
  finding.remedy = signal.is_pressure()
                       ? "if it is not really driven at rest, the sensor's zero is off: subtract it (vent "
                         "before each trial and take the zero there). If all sensors are off by the same "
                         "amount, it is the day's ambient pressure (inputs.ambient_pressure_pa)"
                       : "if the arm is not driven at rest, subtract it";
  finding.setting = zero_setting(zero_of(context, signal), level.value);
}

/// For what several trials say together.
ZeroAtRest zero_at(const Context& context, const Level& level, double limit) {
  ZeroAtRest zero = zero_of(context, *level.signal);
  zero.level = level.value;
  zero.limit = limit;
  zero.may_be_held = level.may_be_held() || (!level.signal->is_pressure() && !level.signal->is_measured);
  return zero;
}

void check_input_levels(Context& context) {
  const auto rest = context.rest();
  if (!rest) return;
  const std::vector<Level> levels = levels_at(context, *rest);
  const bool held = held_at_one_level(context, levels);
  for (const Level& level : levels) {
    if (held && level.signal->input->kind == arm::InputKind::kPressure) continue;
    if (level.falls_below()) continue;
    const double limit = limit_of(level);
    context.zeros.push_back(zero_at(context, level, limit));
    if (std::abs(level.value) >= limit) say_offset(context, level, *rest);
  }
}

}  // namespace

Check make_input_levels() {
  return {check_input_levels, {{"pressurised_at_rest", Severity::kInformation}, {"offset_at_rest", {}}}};
}

}  // namespace softarm::check
