// Whether what the drivers report is enough for what the arm asks of its bodies.
#include <fmt/format.h>

#include <algorithm>

#include "arm_parts.h"
#include "body_source.h"

namespace softarm::arm::yaml {
namespace {

constexpr std::size_t kFewestForAPose = 3;
constexpr double kLeastSpreadM = 1e-3;  // of markers across their common line: less gives no orientation

/// Markers that determine an orientation: all say where they sit, and not on one line.
void check_template(const Section& section, const std::vector<LabelledMarker>& markers) {
  const auto has_place = [](const LabelledMarker& m) { return m.p_body.has_value(); };
  const auto places = std::count_if(markers.begin(), markers.end(), has_place);
  if (places == 0) return;
  const char* const key = "labelled_markers";
  if (places < static_cast<std::ptrdiff_t>(markers.size())) {
    section.fail(key, "have a position_m for some of them; give it for all (a pose) or for none (centroid)");
  }
  if (markers.size() < kFewestForAPose) {
    section.fail(key, fmt::format("have positions, but a pose takes {} of them or more", kFewestForAPose));
  }
  const Eigen::Vector3d origin = *markers.front().p_body;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const LabelledMarker& m : markers) {
    if ((*m.p_body - origin).norm() > along.norm()) along = *m.p_body - origin;
  }
  double spread = 0.0;
  for (const LabelledMarker& m : markers) {
    spread = std::max(spread, along.normalized().cross(*m.p_body - origin).norm());
  }
  if (!(spread > kLeastSpreadM)) section.fail(key, "sit on one line, which gives no orientation");
}

void check_body(const Section& section, const std::vector<LabelledMarker>& markers,
                const BodySource& source) {
  check_template(section, markers);
  const bool has_labels = body_type(source.type).message == BodyMessage::kMarkers && source.labelled;
  if (!markers.empty() && !has_labels) {
    section.fail("labelled_markers",
                 fmt::format("need a list of labelled markers, which {} {} not", source.type,
                             source.labelled ? "is" : "with labels: false is"));
  }
}

/// Whether the source gives the orientation of a body with these markers.
bool gives_orientation(const std::vector<LabelledMarker>& markers, const BodySource& source) {
  const BodyMessage message = body_type(source.type).message;
  if (message == BodyMessage::kPose || message == BodyMessage::kFrames) return true;
  return source.labelled && !markers.empty() && markers.front().p_body.has_value();
}

}  // namespace

std::vector<LabelledMarker> read_labelled_markers(const Section& body) {
  std::vector<LabelledMarker> markers;
  for (const Section& item : body.list("labelled_markers", labelled_marker_keys())) {
    LabelledMarker marker;
    marker.label = item.text("label");
    for (const LabelledMarker& other : markers) {
      if (other.label == marker.label) item.fail_value("label", "is given to another marker already");
    }
    if (item.has("position_m")) marker.p_body = Eigen::Vector3d(item.vector("position_m"));
    markers.push_back(std::move(marker));
  }
  return markers;
}

void check_sources(const Section& root, const Arm& arm) {
  constexpr char kRemedy[] = "three labelled_markers with position_m";
  const Section base = root.section("base", base_keys());
  const BodySource& base_source = arm.inputs.base ? *arm.inputs.base : arm.inputs.bodies;
  check_body(base, arm.base.labelled_markers, base_source);
  if (arm.base.body && !gives_orientation(arm.base.labelled_markers, base_source)) {
    base.fail_value("body", fmt::format("needs a pose, but {} has points only; give fixed instead, or "
                                        "inputs.base, or {}",
                                        base_source.type, kRemedy));
  }
  if (arm.inputs.base && !arm.base.body) {
    root.section("inputs", inputs_keys()).fail("base", "is given, but base.body is not");
  }
  std::size_t i = 0;
  for (const Section& item : root.list("bodies", body_keys())) {
    const MeasuredBody& body = arm.bodies.at(i++);
    check_body(item, body.labelled_markers, arm.inputs.bodies);
    if (body.orientation_usable && !gives_orientation(body.labelled_markers, arm.inputs.bodies)) {
      item.fail_value("orientation_usable", fmt::format("needs a pose, but {} has points only; give {}",
                                                        arm.inputs.bodies.type, kRemedy));
    }
    if (body.markers > 1 && arm.inputs.bodies.labelled) {
      item.fail_value("markers", "applies to points without labels only; give labelled_markers");
    }
  }
}

}  // namespace softarm::arm::yaml
