#include "softarm/arm/laws.h"

#include <cmath>
#include <cstddef>
#include <set>
#include <string>

#include "actuators/actuator.h"
#include "drive.h"
#include "mooney_rivlin.h"

namespace softarm::arm {
namespace {

std::optional<Stretch> axial_stretch(const Segment& segment, double force_n) {
  if (!segment.axial_stiffness_n) return Stretch();
  const double strain = force_n / *segment.axial_stiffness_n;  // of a linear material
  if (!segment.material) return Stretch{1.0 + strain, 1.0, 1.0, 0.0};
  const MooneyRivlin rubber{segment.material->c10_pa, segment.material->c01_pa};
  const double initial_pa = rubber.initial_modulus_pa();
  const std::optional<double> stretch = rubber.stretch_at(strain * initial_pa);
  if (!stretch) return std::nullopt;
  const double ratio = rubber.tangent_modulus_pa(*stretch) / initial_pa;
  return Stretch{*stretch, ratio, 1.0 / ratio,
                 rubber.tangent_modulus_slope_pa(*stretch) / initial_pa / ratio};
}

}  // namespace

std::optional<Drive> drive_of(const Segment& segment, const InputReader& inputs) {
  Drive drive;
  drive.length_m = segment.length_m;
  drive.base_stiffness_nm2 = segment.bending_stiffness.base_nm2;
  for (const ActuatorKind* kind : actuator_kinds()) {
    if (!kind->drive(segment, inputs, drive)) return std::nullopt;
  }
  return drive;
}

std::optional<SegmentResponse> respond(const Segment& segment, const InputReader& inputs) {
  const std::optional<Drive> drive = drive_of(segment, inputs);
  if (!drive) return std::nullopt;
  const std::optional<Stretch> stretch = axial_stretch(segment, drive->axial_force_n);
  if (!stretch) return std::nullopt;
  SegmentPrediction p;
  p.length_m = drive->length_m * stretch->stretch;
  p.modulus_ratio = stretch->modulus_ratio;
  p.bending_stiffness_nm2 =
      drive->base_stiffness_nm2 * (drive->base_with_modulus ? stretch->modulus_ratio : 1.0) +
      drive->added_stiffness_nm2;
  p.moment_nm = drive->moment_nm;
  p.curvature_per_m = drive->curvature_per_m;
  p.tendon_shear_stiffness_n = drive->shear_stiffness_n;
  p.tendon_torsional_stiffness_nm2 = drive->torsional_stiffness_nm2;
  if (!(p.length_m > 0.0) || !(p.bending_stiffness_nm2 > 0.0)) return std::nullopt;
  return SegmentResponse{*drive, *stretch, p};
}

SegmentDerivative differentiate(const Segment& segment, const SegmentResponse& at, const Change& change) {
  const Drive& by = change.drive;
  double strain = 0.0;
  if (segment.axial_stiffness_n) {
    const double ea = *segment.axial_stiffness_n;
    strain = (by.axial_force_n - at.drive.axial_force_n / ea * change.axial_stiffness_n) / ea;
  }
  SegmentDerivative d;
  SegmentPrediction& p = d.prediction;
  p.modulus_ratio = at.stretch.modulus_ratio_by_strain * strain;
  p.length_m = by.length_m * at.stretch.stretch + at.drive.length_m * at.stretch.stretch_by_strain * strain;
  p.bending_stiffness_nm2 = by.added_stiffness_nm2 + by.base_stiffness_nm2;
  if (at.drive.base_with_modulus) {
    p.bending_stiffness_nm2 = by.added_stiffness_nm2 + by.base_stiffness_nm2 * at.stretch.modulus_ratio +
                              at.drive.base_stiffness_nm2 * p.modulus_ratio;
  }
  p.moment_nm = by.moment_nm;
  p.curvature_per_m = by.curvature_per_m;
  p.tendon_shear_stiffness_n = by.shear_stiffness_n;
  p.tendon_torsional_stiffness_nm2 = by.torsional_stiffness_nm2;
  d.axial_stiffness_n = change.axial_stiffness_n;
  d.joint_compliance_rad_per_nm = change.joint_compliance_rad_per_nm;
  d.rest_curvature_per_m = change.rest_curvature_per_m;
  return d;
}

std::optional<SegmentPrediction> predict_segment(const Arm& arm, const Segment& segment,
                                                 const InputValues& inputs) {
  const std::optional<SegmentResponse> response = respond(segment, InputReader(arm, inputs));
  if (!response) return std::nullopt;
  return response->prediction;
}

std::optional<std::vector<SegmentPrediction>> predict(const Arm& arm, const InputValues& inputs) {
  std::vector<SegmentPrediction> all;
  all.reserve(arm.segments.size());
  for (const Segment& segment : arm.segments) {
    const std::optional<SegmentPrediction> one = predict_segment(arm, segment, inputs);
    if (!one) return std::nullopt;
    all.push_back(*one);
  }
  return all;
}

bool stiffness_depends_on_inputs(const Segment& segment) {
  for (const ActuatorKind* kind : actuator_kinds()) {
    if (kind->stiffens(segment)) return true;
  }
  return segment.material && segment.axial_stiffness_n;
}

std::vector<int> inputs_of(const Arm& arm, const Segment& segment) {
  std::set<std::string> names;
  for (const ActuatorKind* kind : actuator_kinds()) {
    if (!kind->needs_inputs(segment)) continue;
    for (int i = 0; i < kind->count(segment); ++i) names.insert(kind->input(segment, i));
  }
  std::vector<int> indices;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    if (names.count(arm.inputs.scalars[i].name)) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

std::string missing_inputs(const Arm& arm, const Segment& segment, const InputValues& inputs) {
  std::string missing;
  for (const int i : inputs_of(arm, segment)) {
    const auto index = static_cast<std::size_t>(i);
    if (index < inputs.size() && inputs[index] && std::isfinite(*inputs[index])) continue;
    missing += (missing.empty() ? "" : ", ") + arm.inputs.scalars[index].name;
  }
  return missing;
}

}  // namespace softarm::arm
