#include "estimate_message.h"

#include "backbone_sampling.h"
#include "conversions.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

using softarm_estimator::ArmEstimate;

std::uint8_t status_code(estimate::Status status) {
  switch (status) {
    case estimate::Status::kOk:
      return ArmEstimate::STATUS_OK;
    case estimate::Status::kNoBasePose:
      return ArmEstimate::STATUS_NO_BASE_POSE;
    case estimate::Status::kNotEnoughBodies:
      return ArmEstimate::STATUS_NOT_ENOUGH_BODIES;
    case estimate::Status::kMissingPayload:
      return ArmEstimate::STATUS_MISSING_PAYLOAD;
    case estimate::Status::kMissingInputs:
      return ArmEstimate::STATUS_MISSING_INPUTS;
    case estimate::Status::kInvalidInput:
      return ArmEstimate::STATUS_INVALID_INPUT;
    case estimate::Status::kNoConvergence:
      return ArmEstimate::STATUS_NO_CONVERGENCE;
    case estimate::Status::kInconsistent:
      return ArmEstimate::STATUS_INCONSISTENT;
  }
  return ArmEstimate::STATUS_INVALID_INPUT;
}

softarm_estimator::SegmentEstimate to_message(const estimate::SegmentEstimate& estimate,
                                              const std::string& name) {
  softarm_estimator::SegmentEstimate message;
  message.name = name;
  message.has_moment = estimate.moment_nm.has_value();
  message.moment = estimate.moment_nm.value_or(0.0);
  message.direction = estimate.direction_rad.value_or(0.0);
  message.has_bending_stiffness = estimate.bending_stiffness_nm2.has_value();
  message.bending_stiffness = estimate.bending_stiffness_nm2.value_or(0.0);
  message.length = estimate.length_m.value_or(0.0);
  message.actuation_curvature = estimate.actuation_curvature_per_m.value_or(0.0);
  message.bending_angle = estimate.bending_angle_rad;
  message.sd_moment = estimate.sd_moment_nm.value_or(0.0);
  message.sd_direction = estimate.sd_direction_rad.value_or(0.0);
  message.sd_bending_stiffness = estimate.sd_bending_stiffness_nm2.value_or(0.0);
  message.sd_length = estimate.sd_length_m.value_or(0.0);
  message.sd_actuation_curvature = estimate.sd_actuation_curvature_per_m.value_or(0.0);
  message.determined_moment = estimate.sd_moment_nm.has_value();
  message.determined_direction = estimate.sd_direction_rad.has_value();
  message.determined_bending_stiffness = estimate.sd_bending_stiffness_nm2.has_value();
  message.determined_length = estimate.sd_length_m.has_value();
  message.identifiable_moment = estimate.identifiable_moment;
  message.identifiable_bending_stiffness = estimate.identifiable_stiffness;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      message.covariance[static_cast<std::size_t>(4 * row + column)] = estimate.covariance(row, column);
    }
  }
  return message;
}

geometry_msgs::TransformStamped transform(const MessageContext& context, const std::string& parent,
                                          const std::string& child, const Eigen::Vector3d& p,
                                          const Eigen::Quaterniond& q) {
  geometry_msgs::TransformStamped message;
  message.header.stamp = context.stamp;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  message.transform = to_transform(p, q);
  return message;
}

}  // namespace

ArmEstimate to_message(const estimate::Estimate& estimate, const MessageContext& context,
                       double solve_time_s) {
  ArmEstimate message;
  message.header.stamp = context.stamp;
  message.header.frame_id = context.frames.base();
  message.status = status_code(estimate.status);
  message.detail = estimate.detail;
  message.settling = estimate.settling;
  message.method = to_string(context.options.method);
  message.unknown = to_string(context.options.unknown);
  message.prior = context.options.prior.enabled;
  message.window = context.options.window_s;
  message.iterations = static_cast<std::uint32_t>(std::max(0, estimate.solver.iterations));
  message.warm_start = estimate.solver.warm_start;
  message.solve_time = solve_time_s;

  const std::vector<arm::MeasuredBody>& bodies = context.arm.bodies;
  for (const estimate::BodyResidual& residual : estimate.residuals) {
    message.body_names.push_back(bodies.at(static_cast<std::size_t>(residual.body)).name);
    message.measured.push_back(to_point(residual.measured_base));
    message.estimated.push_back(to_point(residual.estimated_base));
    message.body_used.push_back(residual.used);
  }
  if (estimate.status != estimate::Status::kOk) return message;

  for (std::size_t i = 0; i < estimate.segments.size(); ++i) {
    message.segments.push_back(to_message(estimate.segments[i], context.arm.segments.at(i).name));
  }
  message.has_payload = estimate.payload_kg.has_value();
  message.payload_is_known = message.has_payload && context.options.unknown == arm::Unknown::kStiffness;
  message.payload = estimate.payload_kg.value_or(0.0);
  message.sd_payload = estimate.sd_payload_kg.value_or(0.0);
  message.determined_payload = estimate.sd_payload_kg.has_value();
  message.identifiable_payload = estimate.identifiable_payload;
  for (const estimate::BackbonePoint& point : estimate.backbone) {
    message.arclength.push_back(point.arclength_m);
    message.backbone.push_back(to_pose(point.p_base, point.q_base));
    message.curvature.push_back(to_vector(point.curvature_per_m));
  }
  message.rms_residual = estimate.rms_residual_m;
  message.reduced_chi_square = estimate.reduced_chi_square;
  message.degrees_of_freedom = static_cast<std::uint32_t>(std::max(0, estimate.degrees_of_freedom));
  return message;
}

nav_msgs::Path to_path(const estimate::Estimate& estimate, const MessageContext& context) {
  nav_msgs::Path path;
  path.header.stamp = context.stamp;
  path.header.frame_id = context.frames.base();
  for (const estimate::BackbonePoint& point : estimate.backbone) {
    geometry_msgs::PoseStamped pose;
    pose.header = path.header;
    pose.pose = to_pose(point.p_base, point.q_base);
    path.poses.push_back(pose);
  }
  return path;
}

std::vector<geometry_msgs::TransformStamped> to_transforms(const estimate::Estimate& estimate,
                                                           const MessageContext& context) {
  const FrameNames& frames = context.frames;
  std::vector<geometry_msgs::TransformStamped> transforms;
  const Eigen::Isometry3d& base = estimate.base_in_mocap;
  transforms.push_back(transform(context, frames.mocap, frames.base(), base.translation(),
                                 Eigen::Quaterniond(base.linear()).normalized()));
  if (estimate.backbone.empty()) return transforms;
  for (const arm::MeasuredBody& body : context.arm.bodies) {
    if (body.kind != arm::BodyKind::kRing) continue;
    const estimate::BackbonePoint point = backbone_at(estimate.backbone, body.arclength_m);
    transforms.push_back(transform(context, frames.base(), frames.of(body.name), point.p_base, point.q_base));
  }
  const estimate::BackbonePoint& tip = estimate.backbone.back();
  transforms.push_back(transform(context, frames.base(), frames.of("tip"), tip.p_base, tip.q_base));
  return transforms;
}

}  // namespace softarm
