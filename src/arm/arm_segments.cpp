// Segments, their stiffness and chambers.
#include <fmt/format.h>

#include <cmath>

#include "arm_parts.h"

namespace softarm::yaml {
namespace {

const ScalarInput* find_input(const Inputs& inputs, const std::string& name) {
  for (const ScalarInput& input : inputs.scalars) {
    if (input.name == name) return &input;
  }
  return nullptr;
}

/// The input that `key` refers to, of the kind that is wanted there.
std::string read_input(const Section& section, const std::string& key, const Inputs& inputs,
                       bool wants_vacuum) {
  const std::string name = section.text(key);
  const ScalarInput* const input = find_input(inputs, name);
  if (input == nullptr) {
    std::string declared;
    for (const ScalarInput& known : inputs.scalars) declared += (declared.empty() ? "" : ", ") + known.name;
    section.fail_value(
        key, "is no input of inputs.pressures; declared: " + (declared.empty() ? "none" : declared));
  }
  if ((input->kind == InputKind::kVacuum) != wants_vacuum) {
    section.fail_value(key, wants_vacuum ? "is not a vacuum input; mark it `vacuum: true` in inputs.pressures"
                                         : "is a vacuum input; a chamber needs a pressure");
  }
  return name;
}

std::vector<StiffnessKnot> read_profile(const Section& stiffness) {
  std::vector<StiffnessKnot> knots;
  for (const Section& item : stiffness.list("profile", profile_keys())) {
    const StiffnessKnot knot{item.number("fraction"), item.number("factor")};
    if (!knots.empty() && !(knot.fraction > knots.back().fraction)) {
      item.fail_value("fraction",
                      fmt::format("does not lie beyond the knot before it, {:g}", knots.back().fraction));
    }
    knots.push_back(knot);
  }
  return knots;
}

void read_stiffness(const Section& section, Segment* segment) {
  StiffnessLaw& law = segment->bending_stiffness;
  law.base_nm2 = section.number("base_nm2");
  law.per_min_pressure_nm2_per_pa = section.number("per_min_pressure_nm2_per_pa");
  law.per_jamming_pressure_nm2_per_pa = section.number("per_jamming_pressure_nm2_per_pa");
  if (law.per_jamming_pressure_nm2_per_pa > 0.0 && !segment->jamming_input) {
    section.fail_value("per_jamming_pressure_nm2_per_pa", "needs the segment's jamming_input");
  }
  segment->bending_stiffness_range_nm2 = section.range("range_nm2");
  const Range& range = segment->bending_stiffness_range_nm2;
  if (!(law.base_nm2 >= range.low && law.base_nm2 <= range.high)) {
    section.fail_value("base_nm2", fmt::format("is outside the segment's own range_nm2 [{:g}, {:g}] N m^2",
                                               range.low, range.high));
  }
  segment->stiffness_profile = read_profile(section);
}

Chamber read_chamber(const Section& section, const Inputs& inputs) {
  Chamber chamber;
  chamber.input = read_input(section, "input", inputs, false);
  chamber.bending_direction_rad = section.number("bending_direction_deg") * M_PI / 180.0;
  chamber.moment_gain_nm_per_pa = section.number("moment_gain_nm_per_pa");
  chamber.near_elongation_m_per_pa = section.number("near_elongation_m_per_pa");
  chamber.far_elongation_m_per_pa = section.number("far_elongation_m_per_pa");
  return chamber;
}

Range read_length_range(const Section& section, double length_m) {
  if (!section.has("length_range_m")) return {0.7 * length_m, 1.5 * length_m};
  const Range range = section.range("length_range_m");
  if (!(range.low <= length_m && length_m <= range.high)) {
    section.fail_value("length_range_m", fmt::format("does not contain length_m, {:g} m", length_m));
  }
  return range;
}

Segment read_segment(const Section& section, const Inputs& inputs) {
  Segment segment;
  segment.name = section.name("name");
  segment.length_m = section.number("length_m");
  segment.length_range_m = read_length_range(section, segment.length_m);
  segment.mass_per_length_kg_m = section.number("mass_per_length_kg_m");
  segment.diameter_m = section.number("diameter_m");
  if (section.has("jamming_input"))
    segment.jamming_input = read_input(section, "jamming_input", inputs, true);
  read_stiffness(section.section("bending_stiffness", stiffness_keys()), &segment);
  segment.torsional_stiffness_nm2 = section.number_or_word("torsional_stiffness_nm2");
  segment.axial_stiffness_n = section.number_or_word("axial_stiffness_n");
  segment.shear_stiffness_n = section.number_or_word("shear_stiffness_n");
  segment.rest_curvature_per_m = section.vector("rest_curvature_per_m");
  for (const Section& item : section.list("chambers", chamber_keys())) {
    segment.chambers.push_back(read_chamber(item, inputs));
  }
  return segment;
}

}  // namespace

std::vector<Segment> read_segments(const Section& arm, const Inputs& inputs) {
  std::vector<Segment> segments;
  for (const Section& item : arm.list("segments", segment_keys())) {
    Segment segment = read_segment(item, inputs);
    for (const Segment& other : segments) {
      if (other.name == segment.name)
        item.fail_value("name", "is given to another segment already; names are unique");
    }
    segments.push_back(std::move(segment));
  }
  if (segments.empty()) arm.fail("segments", "is empty; an arm has at least one segment");
  return segments;
}

}  // namespace softarm::yaml
