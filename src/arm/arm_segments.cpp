// Segments, their stiffness and what drives them.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "arm_parts.h"
#include "mooney_rivlin.h"

namespace softarm::arm::yaml {
namespace {

const ScalarInput* find_input(const Inputs& inputs, const std::string& name) {
  for (const ScalarInput& input : inputs.scalars) {
    if (input.name == name) return &input;
  }
  return nullptr;
}

/// The list of `inputs` that declares a kind.
std::string list_of(InputKind kind) {
  switch (kind) {
    case InputKind::kPressure:
    case InputKind::kVacuum:
      return "inputs.pressures";
    case InputKind::kTension:
      return "inputs.tensions";
    case InputKind::kAngle:
      return "inputs.angles";
  }
  throw std::logic_error("kind of input without a list");
}

/// The input that `key` refers to, of the kind that is wanted there.
/// @param user what the section describes, for messages: "a chamber"
std::string read_input(const Section& section, const std::string& key, const Inputs& inputs, InputKind wanted,
                       const std::string& user) {
  const std::string name = section.text(key);
  const ScalarInput* const input = find_input(inputs, name);
  if (input == nullptr) {
    std::string declared;
    for (const ScalarInput& known : inputs.scalars) {
      if (list_of(known.kind) == list_of(wanted)) declared += (declared.empty() ? "" : ", ") + known.name;
    }
    section.fail_value(key, fmt::format("is no input of {}; declared: {}", list_of(wanted),
                                        declared.empty() ? "none" : declared));
  }
  if (input->kind == wanted) return name;
  if (list_of(input->kind) != list_of(wanted)) {
    section.fail_value(
        key, fmt::format("is one of {}; {} needs one of {}", list_of(input->kind), user, list_of(wanted)));
  }
  section.fail_value(key, wanted == InputKind::kVacuum
                              ? "is not a vacuum input; mark it `vacuum: true` in inputs.pressures"
                              : fmt::format("is a vacuum input; {} needs a pressure", user));
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

std::vector<PressureKnot> read_pressure_knots(const Section& stiffness, const Segment& segment) {
  std::vector<PressureKnot> knots;
  const Range& range = segment.bending_stiffness_range_nm2;
  for (const Section& item : stiffness.list("by_pressure", pressure_knot_keys())) {
    const PressureKnot knot{item.number("pressure_pa"), item.number("bending_stiffness_nm2")};
    if (!knots.empty() && !(knot.pressure_pa > knots.back().pressure_pa)) {
      item.fail_value("pressure_pa", fmt::format("does not lie beyond the knot before it, {:g} Pa",
                                                 knots.back().pressure_pa));
    }
    if (!(knot.bending_stiffness_nm2 >= range.low && knot.bending_stiffness_nm2 <= range.high)) {
      item.fail_value(
          "bending_stiffness_nm2",
          fmt::format("is outside the segment's own range_nm2 [{:g}, {:g}] N m^2", range.low, range.high));
    }
    knots.push_back(knot);
  }
  if (!knots.empty() && !segment.central_chamber) {
    stiffness.fail("by_pressure", "needs the segment's central_chamber, whose pressure it is about");
  }
  return knots;
}

/// Needs segment's inputs to be read.
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
  law.by_pressure = read_pressure_knots(section, *segment);
  segment->stiffness_profile = read_profile(section);
}

Chamber read_chamber(const Section& section, const Inputs& inputs) {
  Chamber chamber;
  chamber.input = read_input(section, "input", inputs, InputKind::kPressure, "a chamber");
  chamber.bending_direction_rad = section.number("bending_direction_deg") * M_PI / 180.0;
  chamber.moment_gain_nm_per_pa = section.number("moment_gain_nm_per_pa");
  chamber.near_elongation_m_per_pa = section.number("near_elongation_m_per_pa");
  chamber.far_elongation_m_per_pa = section.number("far_elongation_m_per_pa");
  return chamber;
}

CentralChamber read_central_chamber(const Section& section, const Inputs& inputs) {
  return {read_input(section, "input", inputs, InputKind::kPressure, "a chamber"), section.number("area_m2")};
}

Tendon read_tendon(const Section& section, const Inputs& inputs) {
  return {read_input(section, "input", inputs, InputKind::kTension, "a tendon"),
          section.number("bending_direction_deg") * M_PI / 180.0, section.number("offset_m")};
}

Cable read_cable(const Section& section, const Inputs& inputs, double length_m) {
  Cable cable;
  cable.input = read_input(section, "input", inputs, InputKind::kAngle, "a cable");
  cable.bending_direction_rad = section.number("bending_direction_deg") * M_PI / 180.0;
  if (section.has("curvature_gain_per_m_rad")) {
    for (const char* const key : {"spool_radius_m", "lever_m"}) {
      if (section.has(key))
        section.fail(key, "is given beside curvature_gain_per_m_rad, which it is part of");
    }
    cable.curvature_gain_per_m_rad = section.number("curvature_gain_per_m_rad");
    return cable;
  }
  for (const char* const key : {"spool_radius_m", "lever_m"}) {
    section.require(key, "a cable needs it, or curvature_gain_per_m_rad");
  }
  cable.curvature_gain_per_m_rad = section.number("spool_radius_m") / (length_m * section.number("lever_m"));
  return cable;
}

/// @param segment whose axial stiffness is read
Material read_material(const Section& section, const Segment& segment) {
  const Material material{section.number("c10_pa"), section.number("c01_pa")};
  const double modulus_pa = MooneyRivlin{material.c10_pa, material.c01_pa}.initial_modulus_pa();
  if (!(modulus_pa > 0.0)) {
    section.fail_value("c01_pa",
                       fmt::format("makes 6 (c10_pa + c01_pa), the modulus at rest, {:g} Pa; it must "
                                   "be positive",
                                   modulus_pa));
  }
  if (!segment.axial_stiffness_n) {
    section.fail("c10_pa",
                 "needs the segment's axial_stiffness_n: a rigid axis does not stretch the material");
  }
  return material;
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
    segment.jamming_input = read_input(section, "jamming_input", inputs, InputKind::kVacuum, "a core");
  if (section.has("central_chamber")) {
    segment.central_chamber =
        read_central_chamber(section.section("central_chamber", central_chamber_keys()), inputs);
  }
  read_stiffness(section.section("bending_stiffness", stiffness_keys()), &segment);
  segment.torsional_stiffness_nm2 = section.number_or_word("torsional_stiffness_nm2");
  segment.axial_stiffness_n = section.number_or_word("axial_stiffness_n");
  segment.shear_stiffness_n = section.number_or_word("shear_stiffness_n");
  segment.rest_curvature_per_m = section.vector("rest_curvature_per_m");
  for (const Section& item : section.list("chambers", chamber_keys())) {
    segment.chambers.push_back(read_chamber(item, inputs));
  }
  for (const Section& item : section.list("tendons", tendon_keys())) {
    segment.tendons.push_back(read_tendon(item, inputs));
  }
  for (const Section& item : section.list("cables", cable_keys())) {
    segment.cables.push_back(read_cable(item, inputs, segment.length_m));
  }
  if (section.has("material")) {
    segment.material = read_material(section.section("material", material_keys()), segment);
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

}  // namespace softarm::arm::yaml
