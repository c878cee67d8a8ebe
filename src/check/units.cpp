// The unit of the positions, by the arm's size.
#include <fmt/format.h>

#include "context.h"
#include "policy.h"
#include "shape.h"

namespace softarm::check {
namespace {

void check_units(Context& context) {
  const auto ratio = length_ratio(places_in(context, shape_span(context)));
  if (!ratio || (*ratio > kPolicy.geometry.least_ratio && *ratio < kPolicy.geometry.most_ratio)) return;
  struct Unit {
    const char* name;
    double metres;
    const char* remedy;
  };
  constexpr Unit kUnits[] = {{"mm", 1e-3, "mm"}, {"cm", 1e-2, "cm"}, {"m", 1.0, "m"}, {"inch", 0.0254, ""}};
  const double now = context.arm.inputs.bodies.scale_to_m;
  CheckFinding& finding =
      context.add("length_unit", "",
                  fmt::format("base and bodies lie {:.3g} times as far apart as the arm file says", *ratio));
  finding.figure = *ratio;
  finding.unit = "1";
  for (const Unit& unit : kUnits) {
    const double corrected = *ratio * unit.metres / now;
    if (!(corrected > kPolicy.geometry.least_unit && corrected < kPolicy.geometry.most_unit) ||
        unit.metres == now)
      continue;
    finding.what += fmt::format(": positions are in {}", unit.name);
    finding.remedy = *unit.remedy ? "name the unit of the positions in the arm file"
                                  : "let the driver publish metres; inches cannot be named";
    if (*unit.remedy) finding.setting = fmt::format("inputs.bodies.unit: {}", unit.remedy);
    return;
  }
  finding.remedy =
      "another arm's file, another body's name for the base, or arclengths that are wrong: measure "
      "from the clamp along the backbone";
}

}  // namespace

Check make_units() {
  return {check_units, {{"length_unit", Severity::kSerious}}};
}

}  // namespace softarm::check
