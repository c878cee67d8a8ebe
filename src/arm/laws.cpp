#include "softarm/arm/laws.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>

#include "mooney_rivlin.h"

namespace softarm::arm {
namespace {

using Eigen::Vector2d;

/// The segment's inputs, all known.
struct SegmentInputs {
  std::vector<double> chamber_gauge_pa;  ///< in the order of Segment::chambers
  double vacuum_pa = 0.0;                ///< V
  double central_gauge_pa = 0.0;
  std::vector<double> tension_n, angle_rad;  ///< in the order of tendons and cables
};

std::optional<double> find_input(const Arm& arm, const std::string& name, const InputValues& inputs) {
  const std::vector<ScalarInput>& declared = arm.inputs.scalars;
  for (std::size_t i = 0; i < declared.size() && i < inputs.size(); ++i) {
    if (declared[i].name == name && inputs[i] && std::isfinite(*inputs[i])) return inputs[i];
  }
  return std::nullopt;
}

/// Without a jammable core the vacuum does nothing, so its absence does not matter either.
bool needs_vacuum(const Segment& segment) {
  return segment.jamming_input && segment.bending_stiffness.per_jamming_pressure_nm2_per_pa != 0.0;
}

std::optional<SegmentInputs> collect(const Arm& arm, const Segment& segment, const InputValues& inputs) {
  SegmentInputs collected;
  const auto read_all = [&](const auto& actuators, std::vector<double>* values) {
    values->reserve(actuators.size());
    for (const auto& actuator : actuators) {
      const std::optional<double> value = find_input(arm, actuator.input, inputs);
      if (!value) return false;
      values->push_back(*value);
    }
    return true;
  };
  if (!read_all(segment.chambers, &collected.chamber_gauge_pa)) return std::nullopt;
  if (!read_all(segment.tendons, &collected.tension_n)) return std::nullopt;
  if (!read_all(segment.cables, &collected.angle_rad)) return std::nullopt;
  if (needs_vacuum(segment)) {
    const std::optional<double> vacuum = find_input(arm, *segment.jamming_input, inputs);
    if (!vacuum) return std::nullopt;
    collected.vacuum_pa = *vacuum;
  }
  if (segment.central_chamber) {
    const std::optional<double> pressure = find_input(arm, segment.central_chamber->input, inputs);
    if (!pressure) return std::nullopt;
    collected.central_gauge_pa = *pressure;
  }
  for (double& tension : collected.tension_n) tension = std::max(0.0, tension);
  return collected;
}

/// (3)-(6): on the bending axis, a quarter turn from the bending direction, the cosine terms of (3) cancel,
/// and what is left is L0 + sum P_i (a_near + a_far).
double chamber_length_m(const Segment& segment, const SegmentInputs& inputs) {
  double length = segment.length_m;
  for (std::size_t i = 0; i < segment.chambers.size(); ++i) {
    const Chamber& chamber = segment.chambers[i];
    length +=
        inputs.chamber_gauge_pa[i] * (chamber.near_elongation_m_per_pa + chamber.far_elongation_m_per_pa);
  }
  return length;
}

/// Axial stretch by central chamber and tendons, and the tangent modulus there over the unstretched one.
struct Stretch {
  double stretch = 1.0;
  double modulus_ratio = 1.0;
};

std::optional<Stretch> axial_stretch(const Segment& segment, const SegmentInputs& inputs) {
  if (!segment.axial_stiffness_n) return Stretch();
  double force_n = segment.central_chamber ? inputs.central_gauge_pa * segment.central_chamber->area_m2 : 0.0;
  for (const double tension : inputs.tension_n) force_n -= tension;
  const double strain = force_n / *segment.axial_stiffness_n;  // of a linear material
  if (!segment.material) return Stretch{1.0 + strain, 1.0};
  const MooneyRivlin rubber{segment.material->c10_pa, segment.material->c01_pa};
  const std::optional<double> stretch = rubber.stretch_at(strain * rubber.initial_modulus_pa());
  if (!stretch) return std::nullopt;
  return Stretch{*stretch, rubber.tangent_modulus_pa(*stretch) / rubber.initial_modulus_pa()};
}

double interpolate(const std::vector<PressureKnot>& knots, double pressure_pa) {
  const auto above = std::find_if(knots.begin(), knots.end(),
                                  [&](const PressureKnot& k) { return k.pressure_pa > pressure_pa; });
  if (above == knots.begin()) return knots.front().bending_stiffness_nm2;
  if (above == knots.end()) return knots.back().bending_stiffness_nm2;
  const PressureKnot& below = *(above - 1);
  const double share = (pressure_pa - below.pressure_pa) / (above->pressure_pa - below.pressure_pa);
  return below.bending_stiffness_nm2 + share * (above->bending_stiffness_nm2 - below.bending_stiffness_nm2);
}

/// (7)-(9) on the base stiffness that the central chamber and the material leave. The laws hold for P, V >=
/// 0; a sensor whose zero lies a little low must not take stiffness away.
double bending_stiffness_nm2(const StiffnessLaw& law, const SegmentInputs& inputs, double modulus_ratio) {
  double min_pa = 0.0;
  double mean_pa = 0.0;
  if (!inputs.chamber_gauge_pa.empty()) {
    min_pa = *std::min_element(inputs.chamber_gauge_pa.begin(), inputs.chamber_gauge_pa.end());
    for (const double pressure : inputs.chamber_gauge_pa) mean_pa += pressure;
    mean_pa /= static_cast<double>(inputs.chamber_gauge_pa.size());
  }
  const double base = law.by_pressure.empty() ? law.base_nm2 * modulus_ratio
                                              : interpolate(law.by_pressure, inputs.central_gauge_pa);
  return base + law.per_min_pressure_nm2_per_pa * std::max(0.0, min_pa) +
         law.per_jamming_pressure_nm2_per_pa * std::max(0.0, inputs.vacuum_pa + mean_pa);
}

Vector2d towards(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad)};
}

/// (10)-(13) with every chamber and tendon pulling towards its own azimuth.
Vector2d moment_nm(const Segment& segment, const SegmentInputs& inputs) {
  Vector2d moment = Vector2d::Zero();
  for (std::size_t i = 0; i < segment.chambers.size(); ++i) {
    const Chamber& chamber = segment.chambers[i];
    moment +=
        chamber.moment_gain_nm_per_pa * inputs.chamber_gauge_pa[i] * towards(chamber.bending_direction_rad);
  }
  for (std::size_t i = 0; i < segment.tendons.size(); ++i) {
    const Tendon& tendon = segment.tendons[i];
    moment += inputs.tension_n[i] * tendon.offset_m * towards(tendon.bending_direction_rad);
  }
  return moment;
}

}  // namespace

std::optional<SegmentPrediction> predict_segment(const Arm& arm, const Segment& segment,
                                                 const InputValues& inputs) {
  const std::optional<SegmentInputs> known = collect(arm, segment, inputs);
  if (!known) return std::nullopt;
  const std::optional<Stretch> stretch = axial_stretch(segment, *known);
  if (!stretch) return std::nullopt;
  SegmentPrediction prediction;
  prediction.length_m = chamber_length_m(segment, *known) * stretch->stretch;
  prediction.modulus_ratio = stretch->modulus_ratio;
  prediction.bending_stiffness_nm2 =
      bending_stiffness_nm2(segment.bending_stiffness, *known, stretch->modulus_ratio);
  prediction.moment_nm = moment_nm(segment, *known);
  for (std::size_t i = 0; i < segment.tendons.size(); ++i) {
    const double offset_m = segment.tendons[i].offset_m;
    prediction.tendon_shear_stiffness_n += known->tension_n[i];
    prediction.tendon_torsional_stiffness_nm2 += known->tension_n[i] * offset_m * offset_m;
  }
  for (std::size_t i = 0; i < segment.cables.size(); ++i) {
    const Cable& cable = segment.cables[i];
    prediction.curvature_per_m +=
        cable.curvature_gain_per_m_rad * known->angle_rad[i] * towards(cable.bending_direction_rad);
  }
  if (!(prediction.length_m > 0.0) || !(prediction.bending_stiffness_nm2 > 0.0)) return std::nullopt;
  return prediction;
}

std::optional<std::vector<SegmentPrediction>> predict(const Arm& arm, const InputValues& inputs) {
  std::vector<SegmentPrediction> all;
  for (const Segment& segment : arm.segments) {
    const std::optional<SegmentPrediction> one = predict_segment(arm, segment, inputs);
    if (!one) return std::nullopt;
    all.push_back(*one);
  }
  return all;
}

bool stiffness_depends_on_inputs(const Segment& segment) {
  const StiffnessLaw& law = segment.bending_stiffness;
  return law.per_min_pressure_nm2_per_pa != 0.0 || law.per_jamming_pressure_nm2_per_pa != 0.0 ||
         !law.by_pressure.empty() || (segment.material && segment.axial_stiffness_n);
}

std::vector<int> inputs_of(const Arm& arm, const Segment& segment) {
  std::set<std::string> names;
  for (const Chamber& chamber : segment.chambers) names.insert(chamber.input);
  for (const Tendon& tendon : segment.tendons) names.insert(tendon.input);
  for (const Cable& cable : segment.cables) names.insert(cable.input);
  if (segment.central_chamber) names.insert(segment.central_chamber->input);
  if (needs_vacuum(segment)) names.insert(*segment.jamming_input);
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
