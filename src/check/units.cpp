// The unit of the positions, by the arm's size; bodies that are nowhere near.
#include <fmt/format.h>

#include "context.h"
#include "policy.h"
#include "shape.h"

namespace softarm::check {
namespace {

struct LengthUnit {
  const char* name;
  double metres;
  bool named;  ///< arm file and layout know it
};
constexpr LengthUnit kLengthUnits[] = {
    {"mm", 1e-3, true}, {"cm", 1e-2, true}, {"m", 1.0, true}, {"inch", 0.0254, false}};

void say_far_away(Context& context, const Place& place) {
  const double far_m = place.p_base.norm();
  CheckFinding& finding = context.add(
      "body_far_away", context.tracks[place.track].name,
      fmt::format("it is {:.3g} m from the base, further than the arm reaches; most bodies are not", far_m));
  finding.figure = far_m;
  finding.unit = "m";
  finding.remedy =
      "another rigid body under that name, or markers of another thing in it: look at the mocap system. The "
      "arm's shape is checked without it";
}

void check_units(Context& context) {
  const Shape shape = shape_in(context, shape_span(context));
  for (const Place& place : shape.far_away) say_far_away(context, place);
  const auto ratio = length_ratio(shape.places);
  if (!ratio || (*ratio > kPolicy.geometry.least_ratio && *ratio < kPolicy.geometry.most_ratio)) return;
  // An import writes metres. Where the arm file takes them so, the layout is wrong.
  const double arm_unit_m = context.arm.inputs.bodies.scale_to_m;
  const bool of_layout = context.layout && arm_unit_m == 1.0;
  const double now = of_layout ? context.layout->position_scale_to_m : arm_unit_m;
  CheckFinding& finding =
      context.add("length_unit", "",
                  fmt::format("base and bodies lie {:.3g} times as far apart as the arm file says", *ratio));
  finding.figure = *ratio;
  finding.unit = "1";
  for (const LengthUnit& unit : kLengthUnits) {
    const double corrected = *ratio * unit.metres / now;
    if (!(corrected > kPolicy.geometry.least_unit && corrected < kPolicy.geometry.most_unit) ||
        unit.metres == now)
      continue;
    finding.what += fmt::format(": positions {} in {}", of_layout ? "of the import were" : "are", unit.name);
    if (!unit.named) {
      finding.remedy = of_layout ? "convert the positions to mm before the import; inches cannot be named"
                                 : "let the driver publish metres; inches cannot be named";
    } else if (of_layout) {
      finding.remedy = "name the unit of the positions in the layout, and import again";
      finding.setting = fmt::format("mocap.unit: {} (of the layout)", unit.name);
    } else {
      finding.remedy = "name the unit of the positions in the arm file";
      finding.setting = fmt::format("inputs.bodies.unit: {}", unit.name);
    }
    return;
  }
  finding.remedy =
      "the file of another arm, the name of another body for the base, or wrong arclengths: measure from the "
      "clamp along the backbone";
}

}  // namespace

Check make_units() {
  return {check_units, {{"body_far_away", Severity::kSerious}, {"length_unit", Severity::kSerious}}};
}

}  // namespace softarm::check
