// Segments and their stiffness. What drives them is read in actuators/.
#include <fmt/format.h>

#include <utility>

#include "actuators/actuator.h"
#include "arm_parts.h"
#include "mooney_rivlin.h"
#include "wall_memory.h"

namespace softarm::arm::yaml {
namespace {

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
  segment->bending_stiffness_range_nm2 = section.range("range_nm2");
  const Range& range = segment->bending_stiffness_range_nm2;
  if (!(law.base_nm2 >= range.low && law.base_nm2 <= range.high)) {
    section.fail_value("base_nm2", fmt::format("is outside the segment's own range_nm2 [{:g}, {:g}] N m^2",
                                               range.low, range.high));
  }
  segment->stiffness_profile = read_profile(section);
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

std::vector<WallElement> read_elements(const Section& wall, const char* key, const KeyTable& keys) {
  std::vector<WallElement> elements;
  double sum = 0.0;
  for (const Section& item : wall.list(key, keys)) {
    elements.push_back({item.number("time_s"), item.number("share")});
    sum += elements.back().share;
    if (sum > kMostWallShare + 1e-9)
      item.fail_value("share", fmt::format("makes {:g} of all shares of {} together; at most {:g} comes late",
                                           sum, key, kMostWallShare));
  }
  return elements;
}

Wall read_wall(const Section& section) {
  Wall wall;
  wall.bending = read_elements(section, "bending", bending_element_keys());
  wall.axial = read_elements(section, "axial", axial_element_keys());
  const auto optional = [&](const char* key, std::optional<double>& value) {
    if (section.has(key)) value = section.number(key);
  };
  optional("slows_per_pa", wall.slows_per_pa);
  optional("shares_grow_per_pa", wall.shares_grow_per_pa);
  optional("initial_curvature_sd_per_m", wall.initial_curvature_sd_per_m);
  optional("initial_length_sd_m", wall.initial_length_sd_m);
  optional("lag_s", wall.lag_s);
  return wall;
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
  const Section stiffness = section.section("bending_stiffness", stiffness_keys());
  read_stiffness(stiffness, &segment);
  segment.torsional_stiffness_nm2 = section.number_or_word("torsional_stiffness_nm2");
  segment.axial_stiffness_n = section.number_or_word("axial_stiffness_n");
  segment.shear_stiffness_n = section.number_or_word("shear_stiffness_n");
  if (section.has("joint_compliance_rad_per_nm"))
    segment.joint_compliance_rad_per_nm = section.number("joint_compliance_rad_per_nm");
  segment.rest_curvature_per_m = section.vector("rest_curvature_per_m");
  for (const ActuatorKind* kind : actuator_kinds()) kind->read(section, stiffness, inputs, segment);
  if (section.has("material")) {
    segment.material = read_material(section.section("material", material_keys()), segment);
  }
  if (section.has("wall")) segment.wall = read_wall(section.section("wall", wall_keys()));
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
