#include "markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "arm/actuators/actuator.h"
#include "backbone_sampling.h"
#include "conversions.h"
#include "labels.h"
#include "tube.h"

namespace softarm {
namespace {

using visualization_msgs::Marker;

constexpr double kLifetime_s = 0.5;
constexpr double kFullScale_rad = 2.5;  // an arm bent evenly by so much is all red
constexpr int kTubeSections = 48;
constexpr int kRingSides = 48;
constexpr int kTendonPieces = 24;

Marker marker(const estimate::Estimate& estimate, const MessageContext& context, const char* ns, int type) {
  Marker m;
  m.header.frame_id = context.frames.mocap;
  m.header.stamp = context.stamp;
  m.ns = ns;
  m.type = type;
  m.action = Marker::ADD;
  m.pose = to_pose(estimate.base_in_mocap);
  m.scale.x = m.scale.y = m.scale.z = 1.0;
  m.color = color(1, 1, 1, 1);
  m.lifetime = ros::Duration(kLifetime_s);
  return m;
}

void set_scale(Marker& m, double size) {
  m.scale.x = m.scale.y = m.scale.z = size;
}

/// Curvature that is all red, 1/m.
double full_scale(const arm::Arm& arm) {
  return kFullScale_rad / arm.total_length_m();
}

Marker backbone_tube(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "backbone", Marker::TRIANGLE_LIST);
  const double full_scale_per_m = full_scale(context.arm);
  std::vector<TubeSection> sections;
  for (const estimate::BackbonePoint& point : resample_backbone(estimate.backbone, kTubeSections)) {
    const double bend = point.curvature_per_m.head<2>().norm() / full_scale_per_m;
    sections.push_back({point.p_base, point.q_base, 0.5 * diameter_at(context.arm, point.arclength_m), bend});
  }
  add_tube(sections, 0.35f, &m);
  return m;
}

Marker rings(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "rings", Marker::LINE_LIST);
  m.scale.x = 0.004 * context.arm.total_length_m();
  m.color = color(0.95, 0.95, 0.95, 0.9);
  for (const arm::MeasuredBody& body : context.arm.bodies) {
    if (body.kind != arm::BodyKind::kRing) continue;
    const estimate::BackbonePoint at = backbone_at(estimate.backbone, body.arclength_m);
    const double radius_m = 0.53 * diameter_at(context.arm, body.arclength_m);
    const auto on_ring = [&](int i) {
      const double angle = 2.0 * M_PI * i / kRingSides;
      return to_point(at.p_base +
                      at.q_base * (radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)));
    };
    for (int i = 0; i < kRingSides; ++i) {
      m.points.push_back(on_ring(i));
      m.points.push_back(on_ring(i + 1));
    }
  }
  return m;
}

/// Actuators whose place in the section is known (tendons, cables), as lines.
std::optional<Marker> tendons(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "tendons", Marker::LINE_LIST);
  m.scale.x = 0.006 * context.arm.total_length_m();
  m.color = color(0.98, 0.9, 0.55, 1.0);
  double begin_m = 0.0;
  const auto add = [&](const arm::Segment& segment, const Eigen::Vector2d& place_m) {
    const Eigen::Vector3d offset(place_m.x(), place_m.y(), 0.0);
    const auto at = [&](int i) {
      const estimate::BackbonePoint point =
          backbone_at(estimate.backbone, begin_m + segment.length_m * i / kTendonPieces);
      return to_point(point.p_base + point.q_base * offset);
    };
    for (int i = 0; i < kTendonPieces; ++i) {
      m.points.push_back(at(i));
      m.points.push_back(at(i + 1));
    }
  };
  for (const arm::Segment& segment : context.arm.segments) {
    for (const arm::ActuatorKind* kind : arm::actuator_kinds()) {
      for (int i = 0; i < kind->count(segment); ++i) {
        if (const auto place_m = kind->place_m(segment, i)) add(segment, *place_m);
      }
    }
    begin_m += segment.length_m;
  }
  return m.points.empty() ? std::nullopt : std::optional(m);
}

std::array<Marker, 3> points(const estimate::Estimate& estimate, const MessageContext& context) {
  const double unit_m = context.arm.total_length_m();
  Marker measured = marker(estimate, context, "measured", Marker::SPHERE_LIST);
  set_scale(measured, 0.045 * unit_m);
  Marker estimated = marker(estimate, context, "estimated", Marker::SPHERE_LIST);
  set_scale(estimated, 0.03 * unit_m);
  estimated.color = kEstimatedColor;
  Marker lines = marker(estimate, context, "residuals", Marker::LINE_LIST);
  lines.scale.x = 0.012 * unit_m;
  lines.color = color(1.0, 0.15, 0.25, 1.0);
  for (const estimate::BodyResidual& residual : estimate.residuals) {
    measured.points.push_back(to_point(residual.measured_base));
    measured.colors.push_back(residual.used ? kMeasuredColor : color(0.6, 0.6, 0.6, 1.0));
    estimated.points.push_back(to_point(residual.estimated_base));
    lines.points.push_back(measured.points.back());
    lines.points.push_back(estimated.points.back());
  }
  return {measured, estimated, lines};
}

Marker payload_arrow(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "payload", Marker::ARROW);
  const Eigen::Vector3d gravity = context.arm.gravity_m_s2;
  const double weight_n = estimate.payload_kg.value_or(0.0) * gravity.norm();
  if (!(weight_n > 0.0)) {
    m.action = Marker::DELETE;
    return m;
  }
  // A load that the arm itself weighs is drawn 0.4 times as long as the arm.
  double own_n = context.arm.tip_mass_kg * gravity.norm();
  for (const arm::Segment& s : context.arm.segments)
    own_n += s.mass_per_length_kg_m * s.length_m * gravity.norm();
  const double unit_m = context.arm.total_length_m();
  const double length_m = std::min(2.0, own_n > 0.0 ? 0.4 * weight_n / own_n : 0.4) * unit_m;
  const estimate::BackbonePoint at = backbone_at(estimate.backbone, context.arm.payload.arclength_m);
  const Eigen::Vector3d from = at.p_base + at.q_base * context.arm.payload.offset_m;
  const Eigen::Vector3d down = estimate.base_in_mocap.linear().transpose() * gravity.normalized();
  m.points = {to_point(from), to_point(from + length_m * down)};
  m.scale.x = 0.035 * unit_m;
  m.scale.y = 0.08 * unit_m;
  m.scale.z = std::min(0.1 * unit_m, 0.5 * length_m);
  const bool sure = context.options.unknown == arm::Unknown::kStiffness || estimate.identifiable_payload;
  m.color = sure ? kPayloadColor : color(0.6, 0.6, 0.6, 0.8);
  return m;
}

}  // namespace

visualization_msgs::MarkerArray to_markers(const estimate::Estimate& estimate,
                                           const MessageContext& context) {
  visualization_msgs::MarkerArray array;
  if (estimate.status == estimate::Status::kOk && !estimate.backbone.empty()) {
    array.markers.push_back(backbone_tube(estimate, context));
    array.markers.push_back(rings(estimate, context));
    if (const auto m = tendons(estimate, context)) array.markers.push_back(*m);
    for (const Marker& m : points(estimate, context)) array.markers.push_back(m);
    array.markers.push_back(payload_arrow(estimate, context));
    for (const Marker& m : key_markers(full_scale(context.arm), estimate.base_in_mocap, context))
      array.markers.push_back(m);
  } else {
    for (const char* ns : {"backbone", "rings", "tendons", "measured", "estimated", "residuals", "payload"}) {
      Marker gone = marker(estimate, context, ns, Marker::SPHERE);
      gone.action = Marker::DELETE;
      array.markers.push_back(gone);
    }
  }
  const bool trouble = estimate.status != estimate::Status::kOk;
  const std::string words = estimate_text(estimate, context.arm, context.options);
  for (const Marker& m : text_lines(words, trouble, estimate.base_in_mocap, context))
    array.markers.push_back(m);
  return array;
}

}  // namespace softarm
