// Units of the inputs, and their levels at rest.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

struct Unit {
  const char* name;
  double pa;
};
constexpr std::array<Unit, 6> kUnits{
    {{"Pa", 1.0}, {"kPa", 1e3}, {"MPa", 1e6}, {"bar", 1e5}, {"mbar", 100.0}, {"psi", 6894.757293168}}};

bool is_pressure(const Signal& signal) {
  return signal.input->kind == arm::InputKind::kPressure || signal.input->kind == arm::InputKind::kVacuum;
}

/// Level at rest (or the least of all) and extremes of the raw values.
struct Raw {
  double rest = 0.0, low = 0.0, high = 0.0;
};

Raw raw_of(const Context& context, std::size_t i) {
  const auto& values = context.recording.inputs[i];
  std::vector<double> numbers, first;
  for (const trial::RecordedValue& v : values) {
    if (!std::isfinite(v.value)) continue;
    numbers.push_back(v.value / context.arm.inputs.scalars[i].scale_to_si);
  }
  Raw raw;
  raw.low = math::quantile(numbers, 0.01);
  raw.high = math::quantile(numbers, 0.99);
  first.assign(numbers.begin(),
               numbers.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(numbers.size(), 15)));
  raw.rest = math::median(first);
  return raw;
}

bool plausible(const Raw& raw, double scale, bool absolute, bool vacuum, double ambient_pa) {
  const double zero = absolute ? ambient_pa : 0.0;
  const double rest = raw.rest * scale - zero, low = raw.low * scale - zero, high = raw.high * scale - zero;
  if (vacuum) return high < kPolicy.inputs.most_rest_pa && low > -1.1e5;
  return std::abs(rest) < kPolicy.inputs.most_rest_pa && high < kPolicy.inputs.most_gauge_pa && low > -6e4;
}

bool never_driven(const Raw& raw, double scale) {
  return (raw.high - raw.low) * scale < kPolicy.inputs.least_most_pa;
}

void say_unit(Context& context, std::size_t i) {
  const arm::ScalarInput& input = *context.signals[i].input;
  if (context.signals[i].points.size() < 5) return;
  const Raw raw = raw_of(context, i);
  const bool vacuum = input.kind == arm::InputKind::kVacuum;
  const bool absolute = input.reference == arm::PressureReference::kAbsolute;
  const double ambient = context.arm.inputs.ambient_pressure_pa;
  const bool still = never_driven(raw, input.scale_to_si);
  const double span = raw.high - raw.low;
  // As gauge, values below a kPa that nonetheless change are of another unit.
  const bool tiny = !absolute && still && span > 0.5 && std::abs(raw.high) > 0.5;
  if (plausible(raw, input.scale_to_si, absolute, vacuum, ambient) && !tiny) return;
  std::vector<std::string> fits, settings;
  for (const Unit& unit : kUnits) {
    for (const bool as_absolute : {true, false}) {
      if (unit.pa == input.scale_to_si && as_absolute == absolute) continue;
      if (!plausible(raw, unit.pa, as_absolute, vacuum, ambient)) continue;
      const double high = raw.high * unit.pa - (as_absolute ? ambient : 0.0);
      const double low = raw.low * unit.pa - (as_absolute ? ambient : 0.0);
      if (span > 0.0 && std::max(std::abs(high), std::abs(low)) < kPolicy.inputs.least_most_pa) continue;
      fits.push_back(fmt::format("{} {}", unit.name, as_absolute ? "absolute" : "gauge"));
      settings.push_back(
          fmt::format("unit: {}, reference: {}", unit.name, as_absolute ? "absolute" : "gauge"));
    }
  }
  std::string list;
  for (std::size_t k = 0; k < fits.size(); ++k)
    list += (k == 0 ? "" : k + 1 == fits.size() ? " or " : ", ") + fits[k];
  CheckFinding& finding = context.add(
      Severity::kSerious, "pressure_unit", input.name,
      fmt::format("values of {:.4g} to {:.4g} (first {:.4g}) cannot be {} as the arm file has them{}",
                  raw.low, raw.high, raw.rest, absolute ? "absolute pressures" : "gauge pressures",
                  list.empty() ? "" : "; they look like " + list));
  finding.figure = raw.rest * input.scale_to_si;
  finding.unit = "Pa";
  finding.remedy = "name unit and reference as the source has them";
  if (settings.size() == 1) {
    finding.setting = fmt::format("inputs.pressures[{}]: {{{}}}", input.name, settings.front());
  } else if (!settings.empty()) {
    finding.setting = fmt::format("inputs.pressures[{}].unit, .reference (several fit)", input.name);
  }
}

void say_angle_unit(Context& context, std::size_t i) {
  const Signal& signal = context.signals[i];
  const double most = std::max(std::abs(signal.low), std::abs(signal.high));
  const bool radians = std::abs(signal.input->scale_to_si - 1.0) < 1e-9;
  if (!(radians && most > 30.0)) return;
  CheckFinding& finding = context.add(
      Severity::kSerious, "angle_unit", signal.input->name,
      fmt::format("turns by up to {:.3g} rad, {:.0f} turns: these are degrees", most, most / (2.0 * M_PI)));
  finding.figure = most;
  finding.unit = "rad";
  finding.remedy = "name the unit";
  finding.setting = fmt::format("inputs.angles[{}].unit: deg", signal.input->name);
}

void say_tension_unit(Context& context, std::size_t i) {
  const Signal& signal = context.signals[i];
  if (std::max(std::abs(signal.low), std::abs(signal.high)) < 1000.0) return;
  CheckFinding& finding = context.add(Severity::kSerious, "tension_unit", signal.input->name,
                                      fmt::format("pulls with up to {:.3g} N: no tendon of a soft arm does",
                                                  std::max(std::abs(signal.low), std::abs(signal.high))));
  finding.figure = signal.high;
  finding.unit = "N";
  finding.remedy = "name the unit (mN, gf)";
  finding.setting = fmt::format("inputs.tensions[{}].unit: mN", signal.input->name);
}

struct Level {
  std::size_t signal = 0;
  double value = 0.0;
};

}  // namespace

void check_pressure_units(Context& context) {
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    if (context.signals[i].points.empty()) continue;
    if (is_pressure(context.signals[i])) {
      say_unit(context, i);
    } else if (context.signals[i].input->kind == arm::InputKind::kAngle) {
      say_angle_unit(context, i);
    } else {
      say_tension_unit(context, i);
    }
  }
}

void check_input_levels(Context& context) {
  const auto rest = context.rest();
  if (!rest) return;
  std::vector<Level> levels;
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    const Signal& signal = context.signals[i];
    const bool wrong_unit =
        std::any_of(context.findings.begin(), context.findings.end(), [&](const CheckFinding& f) {
          return f.where == signal.input->name &&
                 (f.id == "pressure_unit" || f.id == "angle_unit" || f.id == "tension_unit");
        });
    if (const auto level = signal.mean(rest->from_s, rest->to_s); level && !wrong_unit)
      levels.push_back({i, *level});
  }
  // Chambers that all rest at one exact level are commanded there.
  std::vector<double> chambers;
  bool exact = true;
  for (const Level& level : levels) {
    const Signal& signal = context.signals[level.signal];
    if (signal.input->kind != arm::InputKind::kPressure) continue;
    chambers.push_back(level.value);
    exact = exact && !signal.is_measured;
  }
  const double common = math::median(chambers);
  const double scatter = chambers.empty() ? 0.0
                                          : *std::max_element(chambers.begin(), chambers.end()) -
                                                *std::min_element(chambers.begin(), chambers.end());
  const bool held = exact && chambers.size() > 1 && scatter < 1.0 && common > kPolicy.inputs.offset_pa;
  if (held) {
    context
        .add(
            Severity::kInformation, "pressurised_at_rest", "",
            fmt::format("all chambers rest at {:.2f} kPa to the last bit: taken as commanded", 1e-3 * common))
        .remedy = "if these are sensors, their zeros are off by that";
  }
  for (const Level& level : levels) {
    const Signal& signal = context.signals[level.signal];
    const arm::ScalarInput& input = *signal.input;
    const bool pressure = is_pressure(signal);
    if (held && input.kind == arm::InputKind::kPressure) continue;
    const double span = rest->to_s - rest->from_s;
    const double se = signal.noise_sd / std::sqrt(std::max(1.0, span / std::max(signal.period_s, 1e-3)));
    double limit = 0.0;
    if (pressure)
      limit = std::max(kPolicy.inputs.least_offset_pa,
                       std::min(kPolicy.inputs.offset_pa, kPolicy.inputs.offset_share * signal.range())) +
              5.0 * se;
    if (input.kind == arm::InputKind::kTension)
      limit = 0.02 * signal.range() + 5.0 * se + kPolicy.inputs.least_tension_n;
    if (input.kind == arm::InputKind::kAngle)
      limit = 0.02 * signal.range() + 5.0 * se + kPolicy.inputs.least_angle_rad;
    if (std::abs(level.value) < limit) continue;
    const bool below = pressure && level.value < 0.0;
    const double share = signal.range() > 0.0 ? std::abs(level.value) / signal.range() : 0.0;
    std::string what;
    if (pressure) {
      what = fmt::format("rests {:.2f} kPa ({:.2f} psi) {} ambient", 1e-3 * std::abs(level.value),
                         std::abs(level.value) / 6894.757,
                         (level.value < 0.0) != (input.kind == arm::InputKind::kVacuum) ? "below" : "above");
    } else {
      what = fmt::format("rests at {:.3g} {}", level.value,
                         input.kind == arm::InputKind::kTension ? "N" : "rad");
    }
    if (share > 0.0 && share < 1.0) what += fmt::format(", {:.0f} % of its range", 100.0 * share);
    if (below && input.kind == arm::InputKind::kPressure)
      what += ": the sensor's zero is off, chambers are not evacuated";
    // A servo or a tendon may well be commanded to rest at a value; one that is exact is no sensor.
    const bool commanded = !pressure && !signal.is_measured;
    CheckFinding& finding = context.add(commanded ? Severity::kInformation : Severity::kWarning,
                                        "offset_at_rest", input.name, what);
    finding.figure = level.value;
    finding.figure_sd = se;
    finding.unit = pressure ? "Pa" : input.kind == arm::InputKind::kTension ? "N" : "rad";
    finding.spans = {*rest};
    if (pressure) {
      finding.remedy =
          "if it is not really driven at rest, the sensor's zero is off: subtract it (vent before each "
          "trial and take the zero there). If all sensors are off alike, it is the day's ambient";
      const double raw_zero = input.kind == arm::InputKind::kVacuum ? -level.value : level.value;
      finding.setting = fmt::format(
          "zero of the column in the import layout: {:.4g} more, in its unit ({:.0f} Pa); if all are off "
          "alike, inputs.ambient_pressure_pa: {:.0f}",
          raw_zero / input.scale_to_si, raw_zero, context.arm.inputs.ambient_pressure_pa + raw_zero);
    } else {
      finding.remedy = "if the arm is not driven at rest, subtract it";
      finding.setting = fmt::format("inputs.{}[{}].zero: {:.4g}",
                                    input.kind == arm::InputKind::kTension ? "tensions" : "angles",
                                    input.name, (input.zero_si + level.value) / input.scale_to_si);
    }
  }
}

}  // namespace softarm::check
