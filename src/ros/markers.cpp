#include "markers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "arm/actuators/actuator.h"
#include "backbone_sampling.h"
#include "conversions.h"
#include "tube.h"

namespace softarm {
namespace {

using visualization_msgs::Marker;

constexpr double kLifetime_s = 0.5;
constexpr double kFullScale_rad = 2.5;  // an arm bent evenly by so much is all red
constexpr int kTubeSections = 48;
constexpr int kRingSides = 48;
constexpr int kTendonPieces = 24;

std_msgs::ColorRGBA color(double r, double g, double b, double a) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

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

Marker backbone_tube(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "backbone", Marker::TRIANGLE_LIST);
  const double full_scale_per_m = kFullScale_rad / context.arm.total_length_m();
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
  estimated.color = color(0.15, 0.85, 0.95, 1.0);
  Marker lines = marker(estimate, context, "residuals", Marker::LINE_LIST);
  lines.scale.x = 0.012 * unit_m;
  lines.color = color(1.0, 0.15, 0.25, 1.0);
  for (const estimate::BodyResidual& residual : estimate.residuals) {
    measured.points.push_back(to_point(residual.measured_base));
    measured.colors.push_back(residual.used ? color(1.0, 0.65, 0.1, 1.0) : color(0.6, 0.6, 0.6, 1.0));
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
  m.color = sure ? color(0.75, 0.45, 1.0, 1.0) : color(0.6, 0.6, 0.6, 0.8);
  return m;
}

Marker text(const estimate::Estimate& estimate, const MessageContext& context) {
  Marker m = marker(estimate, context, "text", Marker::TEXT_VIEW_FACING);
  const double unit_m = context.arm.total_length_m();
  m.text = estimate_text(estimate, context.arm, context.options);
  m.scale.z = 0.075 * unit_m;
  if (estimate.status != estimate::Status::kOk) m.color = color(1.0, 0.35, 0.3, 1.0);
  // Behind the base, or above it where the arm is level: the arm does not get there.
  Eigen::Vector3d at = estimate.base_in_mocap * Eigen::Vector3d(0.0, 0.0, -0.22 * unit_m);
  const Eigen::Vector3d up = -context.arm.gravity_m_s2.normalized();
  const bool level = std::abs(estimate.base_in_mocap.linear().col(2).dot(up)) < 0.5;
  if (level && up.allFinite())
    at = estimate.base_in_mocap * Eigen::Vector3d(0.0, 0.0, 0.35 * unit_m) + 0.5 * unit_m * up;
  m.pose = to_pose(at, Eigen::Quaterniond::Identity());
  return m;
}

}  // namespace

std::string estimate_text(const estimate::Estimate& estimate, const arm::Arm& arm,
                          const arm::EstimatorOptions& options) {
  if (estimate.status != estimate::Status::kOk) {
    return "no estimate: " + (estimate.detail.empty() ? to_string(estimate.status) : estimate.detail);
  }
  std::string lines;
  for (std::size_t i = 0; i < estimate.segments.size(); ++i) {
    const estimate::SegmentEstimate& segment = estimate.segments[i];
    const std::string name = estimate.segments.size() > 1 ? arm.segments.at(i).name + ": " : "";
    if (options.unknown == arm::Unknown::kPayload && segment.bending_stiffness_nm2) {
      lines += fmt::format("{}EI {:.3g} mN m² (known)\n", name, 1e3 * *segment.bending_stiffness_nm2);
    } else if (segment.identifiable_stiffness && segment.bending_stiffness_nm2 &&
               segment.sd_bending_stiffness_nm2) {
      lines += fmt::format("{}EI {:.3g} ± {:.2g} mN m²\n", name, 1e3 * *segment.bending_stiffness_nm2,
                           1e3 * *segment.sd_bending_stiffness_nm2);
    } else {
      lines += name + "EI not identifiable in this frame\n";
    }
  }
  if (options.unknown == arm::Unknown::kStiffness && estimate.payload_kg) {
    lines += fmt::format("payload {:.1f} g (known)", 1e3 * *estimate.payload_kg);
  } else if (estimate.identifiable_payload && estimate.payload_kg && estimate.sd_payload_kg) {
    lines +=
        fmt::format("payload {:.1f} ± {:.1f} g", 1e3 * *estimate.payload_kg, 1e3 * *estimate.sd_payload_kg);
  } else {
    lines += "payload not identifiable in this frame";
  }
  return lines;
}

visualization_msgs::MarkerArray to_markers(const estimate::Estimate& estimate,
                                           const MessageContext& context) {
  visualization_msgs::MarkerArray array;
  if (estimate.status == estimate::Status::kOk && !estimate.backbone.empty()) {
    array.markers.push_back(backbone_tube(estimate, context));
    array.markers.push_back(rings(estimate, context));
    if (const auto m = tendons(estimate, context)) array.markers.push_back(*m);
    for (const Marker& m : points(estimate, context)) array.markers.push_back(m);
    array.markers.push_back(payload_arrow(estimate, context));
  } else {
    for (const char* ns : {"backbone", "rings", "tendons", "measured", "estimated", "residuals", "payload"}) {
      Marker gone = marker(estimate, context, ns, Marker::SPHERE);
      gone.action = Marker::DELETE;
      array.markers.push_back(gone);
    }
  }
  array.markers.push_back(text(estimate, context));
  return array;
}

}  // namespace softarm
