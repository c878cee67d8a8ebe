#include "mismatch_message.h"

#include <fmt/format.h>

#include <algorithm>

#include "backbone_sampling.h"
#include "conversions.h"
#include "labels.h"
#include "tube.h"

namespace softarm {
namespace {

using visualization_msgs::Marker;

constexpr double kMismatchLifetime_s = 0.5;
constexpr double kShortest = 0.06;  // of the arm: a sleeve that can be seen
constexpr int kSections = 12;
constexpr std::size_t kAlarmWidth = 22;

Marker marker(const MessageContext& context, const char* ns, int type) {
  Marker m;
  m.header.frame_id = context.frames.mocap;
  m.header.stamp = context.stamp;
  m.ns = ns;
  m.type = type;
  m.action = Marker::ADD;
  m.pose.orientation.w = 1.0;
  m.scale.x = m.scale.y = m.scale.z = 1.0;
  m.color.r = 1.0f;
  m.color.g = 0.25f;
  m.color.b = 0.2f;
  m.color.a = 1.0f;
  m.lifetime = ros::Duration(kMismatchLifetime_s);
  return m;
}

Marker sleeve(const monitor::Mismatch& mismatch, const estimate::Estimate& estimate,
              const MessageContext& context) {
  const double length_m = context.arm.total_length_m();
  const double middle_m = 0.5 * (mismatch.s_from_m + mismatch.s_to_m);
  const double half_m = std::max(0.5 * (mismatch.s_to_m - mismatch.s_from_m), 0.5 * kShortest * length_m);
  const double from_m = std::max(0.0, middle_m - half_m), to_m = std::min(length_m, middle_m + half_m);
  Marker m = marker(context, "mismatch", Marker::TRIANGLE_LIST);
  m.pose = to_pose(estimate.base_in_mocap);
  std::vector<TubeSection> sections;
  for (int i = 0; i < kSections; ++i) {
    const double s = from_m + (to_m - from_m) * i / (kSections - 1);
    const estimate::BackbonePoint at = backbone_at(estimate.backbone, s);
    sections.push_back({at.p_base, at.q_base, 0.62 * diameter_at(context.arm, s), 1.0});
  }
  add_tube(sections, 0.55f, &m);
  for (std_msgs::ColorRGBA& color : m.colors) {
    color.r = 1.0f;
    color.g = 0.1f;
    color.b = 0.15f;
  }
  return m;
}

Marker alarm_label(const monitor::Mismatch& mismatch, const estimate::Estimate& estimate,
                   const MessageContext& context) {
  Marker m = marker(context, "alarm", Marker::TEXT_VIEW_FACING);
  const double unit_m = context.arm.total_length_m();
  m.scale.z = 0.07 * unit_m;
  const double since_s = mismatch.onset_s ? std::max(0.0, mismatch.stamp_s - *mismatch.onset_s) : 0.0;
  m.text = in_lines(mismatch.description, kAlarmWidth) + fmt::format("\n{:.1f} s ago", since_s);
  // Beside the place, off the arm's plane where it bends down or up: level and away from the base's axis.
  const estimate::BackbonePoint at = backbone_at(estimate.backbone, mismatch.s_m);
  const Eigen::Vector3d place = estimate.base_in_mocap * at.p_base;
  const Eigen::Vector3d up = -context.arm.gravity_m_s2.normalized();
  Eigen::Vector3d aside = estimate.base_in_mocap.linear() * (at.q_base * Eigen::Vector3d::UnitZ());
  aside = up.cross(aside);
  if (!up.allFinite() || aside.norm() < 0.1) aside = Eigen::Vector3d::UnitX();
  m.pose = to_pose(place + 0.6 * unit_m * aside.normalized(), Eigen::Quaterniond::Identity());
  return m;
}

}  // namespace

softarm_estimator::Mismatch to_message(const monitor::Mismatch& mismatch, const MessageContext& context) {
  softarm_estimator::Mismatch message;
  message.header.stamp = context.stamp;
  message.header.frame_id = context.frames.base();
  message.valid = mismatch.valid;
  message.laws = mismatch.laws;
  message.score = mismatch.score_sd;
  message.rms = mismatch.rms_m;
  message.change = mismatch.change_sd;
  message.threshold = mismatch.threshold_sd;
  message.alarm = mismatch.alarm;
  if (mismatch.onset_s) message.onset = nearest_time(trial::to_nanoseconds(*mismatch.onset_s));
  message.kind = to_string(mismatch.kind);
  if (mismatch.or_kind) message.or_kind = to_string(*mismatch.or_kind);
  message.size = mismatch.size_m;
  message.s = mismatch.s_m;
  message.s_from = mismatch.s_from_m;
  message.s_to = mismatch.s_to_m;
  if (mismatch.body) message.body = context.arm.bodies.at(static_cast<std::size_t>(*mismatch.body)).name;
  message.axis = to_string(mismatch.axis);
  message.description = mismatch.description;
  return message;
}

visualization_msgs::MarkerArray to_markers(const monitor::Mismatch& mismatch,
                                           const estimate::Estimate& estimate,
                                           const MessageContext& context) {
  visualization_msgs::MarkerArray array;
  if (!mismatch.alarm) return array;
  array.markers.push_back(sleeve(mismatch, estimate, context));
  array.markers.push_back(alarm_label(mismatch, estimate, context));
  return array;
}

}  // namespace softarm
