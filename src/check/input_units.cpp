// Units of the inputs, by what such values can be.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

struct Unit {
  const char* name;
  double pa;
};
constexpr std::array<Unit, 6> kUnits{
    {{"Pa", 1.0}, {"kPa", 1e3}, {"MPa", 1e6}, {"bar", 1e5}, {"mbar", 100.0}, {"psi", 6894.757293168}}};

/// What is shown first, and extremes of the raw values, in their unit.
struct Raw {
  double first = 0.0, low = 0.0, high = 0.0;
};

Raw raw_of(const Context& context, std::size_t i) {
  const auto& values = context.recording.inputs[i];
  std::vector<double> numbers, first;
  for (const trial::RecordedValue& v : values) {
    if (!std::isfinite(v.value)) continue;
    numbers.push_back(v.value / context.arm.inputs.scalars[i].scale_to_si);
  }
  Raw raw;
  raw.low = math::quantile(numbers, kPolicy.inputs.spikes);
  raw.high = math::quantile(numbers, 1.0 - kPolicy.inputs.spikes);
  first.assign(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(
                                                      std::min(numbers.size(), kPolicy.inputs.first_values)));
  raw.first = math::median(first);
  return raw;
}

/// Whether values can be of such a unit at all. A trial may begin driven, and an arm may be under pressure
/// throughout: only what no chamber stands, or what would be the air's own pressure, is impossible.
bool possible(const Raw& raw, double scale, bool absolute, bool vacuum, double ambient_pa) {
  const double zero = absolute ? ambient_pa : 0.0;
  const double low = raw.low * scale - zero, high = raw.high * scale - zero;
  if (vacuum) return high < kPolicy.inputs.most_rest_pa && low > kPolicy.inputs.least_vacuum_pa;
  const bool is_ambient = !absolute && std::abs(low - ambient_pa) < kPolicy.inputs.near_ambient * ambient_pa;
  return high < kPolicy.inputs.most_gauge_pa && low > kPolicy.inputs.least_gauge_pa && !is_ambient;
}

/// Whether they look like one: the least of them is near ambient.
bool plausible(const Raw& raw, double scale, bool absolute, bool vacuum, double ambient_pa) {
  const double low = raw.low * scale - (absolute ? ambient_pa : 0.0);
  return possible(raw, scale, absolute, vacuum, ambient_pa) && (vacuum || low < kPolicy.inputs.most_rest_pa);
}

bool never_driven(const Raw& raw, double scale) {
  return (raw.high - raw.low) * scale < kPolicy.inputs.least_most_pa;
}

void say_unit(Context& context, std::size_t i) {
  const arm::ScalarInput& input = *context.signals[i].input;
  if (context.signals[i].points.size() < kPolicy.inputs.least_values) return;
  const Raw raw = raw_of(context, i);
  const bool vacuum = input.kind == arm::InputKind::kVacuum;
  const bool absolute = input.reference == arm::PressureReference::kAbsolute;
  const double ambient = context.arm.inputs.ambient_pressure_pa;
  const bool still = never_driven(raw, input.scale_to_si);
  const double span = raw.high - raw.low;
  // As gauge, values below a kPa that nonetheless change are of another unit.
  const bool tiny =
      !absolute && still && span > kPolicy.inputs.tiny && std::abs(raw.high) > kPolicy.inputs.tiny;
  if (possible(raw, input.scale_to_si, absolute, vacuum, ambient) && !tiny) return;
  std::vector<std::string> fits, settings;
  for (const Unit& unit : kUnits) {
    for (const bool as_absolute : {true, false}) {
      if (unit.pa == input.scale_to_si && as_absolute == absolute) continue;
      if (!plausible(raw, unit.pa, as_absolute, vacuum, ambient)) continue;
      const double high = raw.high * unit.pa - (as_absolute ? ambient : 0.0);
      const double low = raw.low * unit.pa - (as_absolute ? ambient : 0.0);
      if (span > 0.0 && std::max(std::abs(high), std::abs(low)) < kPolicy.inputs.least_most_pa) continue;
      fits.push_back(fmt::format("{} {}", unit.name, as_absolute ? "absolute" : "gauge"));
      settings.push_back(fmt::format("{0}.unit: {1}; {0}.reference: {2}", path_of(input), unit.name,
                                     as_absolute ? "absolute" : "gauge"));
    }
  }
  std::string list;
  for (std::size_t k = 0; k < fits.size(); ++k)
    list += (k == 0 ? "" : k + 1 == fits.size() ? " or " : ", ") + fits[k];
  CheckFinding& finding = context.add(
      "pressure_unit", input.name,
      fmt::format("values of {:.4g} to {:.4g} (first {:.4g}) cannot be {} as the arm file states{}", raw.low,
                  raw.high, raw.first, absolute ? "absolute pressures" : "gauge pressures",
                  list.empty() ? "" : "; they look like " + list));
  finding.figure = raw.first * input.scale_to_si;
  finding.unit = "Pa";
  finding.remedy = "state the unit and reference of the source, in the arm file or in the import layout";
  // An import has converted it already: the unit is the layout's to say.
  if (settings.size() == 1 && !context.layout) finding.setting = settings.front();
}

void say_angle_unit(Context& context, std::size_t i) {
  const Signal& signal = context.signals[i];
  const double most = std::max(std::abs(signal.low), std::abs(signal.high));
  const bool radians = std::abs(signal.input->scale_to_si - 1.0) < 1e-9;
  if (!(radians && most > kPolicy.inputs.most_rad)) return;
  CheckFinding& finding = context.add(
      "angle_unit", signal.input->name,
      fmt::format("turns by up to {:.3g} rad, {:.0f} turns: these are degrees", most, most / (2.0 * M_PI)));
  finding.figure = most;
  finding.unit = "rad";
  finding.remedy = "name the unit";
  finding.setting = path_of(*signal.input) + ".unit: deg";
}

void say_tension_unit(Context& context, std::size_t i) {
  const Signal& signal = context.signals[i];
  if (std::max(std::abs(signal.low), std::abs(signal.high)) < kPolicy.inputs.most_tension_n) return;
  CheckFinding& finding = context.add("tension_unit", signal.input->name,
                                      fmt::format("pulls with up to {:.3g} N: no tendon of a soft arm does",
                                                  std::max(std::abs(signal.low), std::abs(signal.high))));
  finding.figure = signal.high;
  finding.unit = "N";
  finding.remedy = "name the unit (mN, gf)";
  finding.setting = path_of(*signal.input) + ".unit: mN";
}

void check_input_units(Context& context) {
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    if (context.signals[i].points.empty()) continue;
    if (context.signals[i].is_pressure()) {
      say_unit(context, i);
    } else if (context.signals[i].input->kind == arm::InputKind::kAngle) {
      say_angle_unit(context, i);
    } else {
      say_tension_unit(context, i);
    }
  }
}

}  // namespace

Check make_input_units() {
  return {check_input_units,
          {{"pressure_unit", Severity::kSerious},
           {"angle_unit", Severity::kSerious},
           {"tension_unit", Severity::kSerious}}};
}

}  // namespace softarm::check
