#include "softarm/arm/laws.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace softarm {
namespace {

/// The segment's pressures, all known.
struct SegmentInputs {
  std::vector<double> chamber_gauge_pa;  ///< in the order of Segment::chambers
  double vacuum_pa = 0.0;                ///< V
};

std::optional<double> find_input(const Arm& arm, const std::string& name, const InputValues& inputs) {
  const std::vector<PressureInput>& declared = arm.inputs.pressures;
  for (std::size_t i = 0; i < declared.size() && i < inputs.size(); ++i) {
    if (declared[i].name == name && inputs[i] && std::isfinite(*inputs[i])) return inputs[i];
  }
  return std::nullopt;
}

std::optional<SegmentInputs> collect(const Arm& arm, const Segment& segment, const InputValues& inputs) {
  SegmentInputs collected;
  collected.chamber_gauge_pa.reserve(segment.chambers.size());
  for (const Chamber& chamber : segment.chambers) {
    const std::optional<double> pressure = find_input(arm, chamber.input, inputs);
    if (!pressure) return std::nullopt;
    collected.chamber_gauge_pa.push_back(*pressure);
  }
  // Without a jammable core the vacuum does nothing, so its absence does not matter either.
  if (segment.jamming_input && segment.bending_stiffness.per_jamming_pressure_nm2_per_pa != 0.0) {
    const std::optional<double> vacuum = find_input(arm, *segment.jamming_input, inputs);
    if (!vacuum) return std::nullopt;
    collected.vacuum_pa = *vacuum;
  }
  return collected;
}

/// (3)-(6): on the bending axis, a quarter turn from the bending direction, the cosine terms of (3) cancel,
/// and what is left is L0 + sum P_i (a_near + a_far).
double length_m(const Segment& segment, const SegmentInputs& inputs) {
  double length = segment.length_m;
  for (std::size_t i = 0; i < segment.chambers.size(); ++i) {
    const Chamber& chamber = segment.chambers[i];
    length +=
        inputs.chamber_gauge_pa[i] * (chamber.near_elongation_m_per_pa + chamber.far_elongation_m_per_pa);
  }
  return length;
}

/// (7)-(9). The laws hold for P, V >= 0; a sensor whose zero lies a little low must not take stiffness away.
double bending_stiffness_nm2(const StiffnessLaw& law, const SegmentInputs& inputs) {
  double min_pa = 0.0;
  double mean_pa = 0.0;
  if (!inputs.chamber_gauge_pa.empty()) {
    min_pa = *std::min_element(inputs.chamber_gauge_pa.begin(), inputs.chamber_gauge_pa.end());
    for (const double pressure : inputs.chamber_gauge_pa) mean_pa += pressure;
    mean_pa /= static_cast<double>(inputs.chamber_gauge_pa.size());
  }
  return law.base_nm2 + law.per_min_pressure_nm2_per_pa * std::max(0.0, min_pa) +
         law.per_jamming_pressure_nm2_per_pa * std::max(0.0, inputs.vacuum_pa + mean_pa);
}

/// (10)-(13) with every chamber pulling towards its own azimuth.
Eigen::Vector2d moment_nm(const Segment& segment, const SegmentInputs& inputs) {
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < segment.chambers.size(); ++i) {
    const Chamber& chamber = segment.chambers[i];
    const Eigen::Vector2d direction(std::cos(chamber.bending_direction_rad),
                                    std::sin(chamber.bending_direction_rad));
    moment += chamber.moment_gain_nm_per_pa * inputs.chamber_gauge_pa[i] * direction;
  }
  return moment;
}

}  // namespace

std::optional<SegmentPrediction> predict_segment(const Arm& arm, const Segment& segment,
                                                 const InputValues& inputs) {
  const std::optional<SegmentInputs> known = collect(arm, segment, inputs);
  if (!known) return std::nullopt;
  SegmentPrediction prediction;
  prediction.length_m = length_m(segment, *known);
  prediction.bending_stiffness_nm2 = bending_stiffness_nm2(segment.bending_stiffness, *known);
  prediction.moment_nm = moment_nm(segment, *known);
  if (!(prediction.length_m > 0.0)) return std::nullopt;
  return prediction;
}

}  // namespace softarm
