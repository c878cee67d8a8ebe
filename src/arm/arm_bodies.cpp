// What is measured, and the payload.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "arm_parts.h"

namespace softarm::arm::yaml {
namespace {

constexpr double kRoundingM = 1e-9;  // of sums of segment lengths

double read_arclength(const Section& section, double total_length_m) {
  const double arclength = section.number_or_word("arclength_m").value_or(total_length_m);
  if (arclength > total_length_m + kRoundingM) {
    section.fail_value("arclength_m", fmt::format("lies beyond the arm's length, {:g} m", total_length_m));
  }
  return std::min(arclength, total_length_m);
}

void read_ring(const Section& section, double default_orientation_sd_rad, MeasuredBody* body) {
  for (const char* const key : {"angle_deg", "radius_m"}) {
    if (section.has(key)) section.fail(key, "applies to bodies of kind skin_marker only");
  }
  body->orientation_usable = section.flag("orientation_usable");
  body->section_in_body = read_transform(section.section("section_in_body", transform_keys()));
  body->orientation_sd_rad =
      section.has("orientation_sd_rad") ? section.number("orientation_sd_rad") : default_orientation_sd_rad;
  body->labelled_markers = read_labelled_markers(section);
  body->markers = section.integer("markers");
  if (body->markers == 2)
    section.fail_value("markers",
                       "do not determine the centre of a marker cluster; allowed are 1 and 3 to 32");
  if (body->markers > 1) {
    section.require("marker_cluster_radius_m", "several markers need it");
    body->marker_cluster_radius_m = section.number("marker_cluster_radius_m");
  } else if (section.has("marker_cluster_radius_m")) {
    section.fail("marker_cluster_radius_m", "applies to rings of 3 markers or more only");
  }
}

void read_skin_marker(const Section& section, double default_orientation_sd_rad, MeasuredBody* body) {
  for (const char* const key : {"orientation_usable", "section_in_body", "orientation_sd_rad",
                                "labelled_markers", "markers", "marker_cluster_radius_m"}) {
    if (section.has(key)) section.fail(key, "applies to bodies of kind ring only");
  }
  for (const char* const key : {"angle_deg", "radius_m"}) section.require(key, "a skin_marker needs it");
  body->angle_rad = section.number("angle_deg") * M_PI / 180.0;
  body->radius_m = section.number("radius_m");
  body->orientation_sd_rad = default_orientation_sd_rad;
}

/// Bodies come in the order of the backbone; markers may share a station, rings may not.
void check_order(const Section& section, const MeasuredBody& body, const std::vector<MeasuredBody>& before) {
  if (before.empty()) return;
  if (body.arclength_m < before.back().arclength_m - kRoundingM) {
    section.fail_value("arclength_m",
                       fmt::format("lies before that of '{}', {:g} m; list bodies from base to tip",
                                   before.back().name, before.back().arclength_m));
  }
  for (const MeasuredBody& other : before) {
    if (body.kind == BodyKind::kRing && other.kind == BodyKind::kRing &&
        std::abs(body.arclength_m - other.arclength_m) <= kRoundingM) {
      section.fail_value("arclength_m", fmt::format("is that of ring '{}' already", other.name));
    }
  }
}

}  // namespace

std::vector<MeasuredBody> read_bodies(const Section& arm, const std::optional<std::string>& base_body,
                                      double total_length_m) {
  const Section noise = arm.section("noise", noise_keys());
  const double default_position_sd_m = noise.number("position_sd_m");
  const double default_orientation_sd_rad = noise.number("orientation_sd_rad");
  std::vector<MeasuredBody> bodies;
  for (const Section& item : arm.list("bodies", body_keys())) {
    MeasuredBody body;
    body.name = item.name("name", "/");
    if (base_body == body.name) item.fail_value("name", "is the base's body already; names are unique");
    for (const MeasuredBody& other : bodies) {
      if (other.name == body.name)
        item.fail_value("name", "is given to another body already; names are unique");
    }
    body.kind = item.word("kind") == "ring" ? BodyKind::kRing : BodyKind::kSkinMarker;
    body.arclength_m = read_arclength(item, total_length_m);
    body.position_sd_m = item.has("position_sd_m") ? item.number("position_sd_m") : default_position_sd_m;
    body.placement_sd_m = noise.number("placement_sd_m");
    body.placement_sd_rad = noise.number("placement_sd_deg") * M_PI / 180.0;
    if (body.kind == BodyKind::kRing) {
      read_ring(item, default_orientation_sd_rad, &body);
    } else {
      read_skin_marker(item, default_orientation_sd_rad, &body);
    }
    check_order(item, body, bodies);
    bodies.push_back(std::move(body));
  }
  if (bodies.empty()) arm.fail("bodies", "is empty; an arm needs at least one measured body");
  return bodies;
}

PayloadMount read_payload(const Section& section, double total_length_m) {
  PayloadMount mount;
  mount.arclength_m = read_arclength(section, total_length_m);
  mount.offset_m = section.vector("offset_m");
  mount.range_kg = section.range("range_kg");
  if (section.has("default_kg")) {
    mount.default_kg = section.number("default_kg");
    if (!(*mount.default_kg >= mount.range_kg.low && *mount.default_kg <= mount.range_kg.high)) {
      section.fail_value("default_kg", fmt::format("is outside the payload's own range_kg [{:g}, {:g}] kg",
                                                   mount.range_kg.low, mount.range_kg.high));
    }
  }
  return mount;
}

}  // namespace softarm::arm::yaml
