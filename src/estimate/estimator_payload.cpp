// A payload that changes: a hand is on the arm, and then it swings.
#include <algorithm>
#include <cmath>

#include "estimator_impl.h"
#include "model/inertia.h"

namespace softarm::estimate {

using Eigen::Vector3d;

double Estimator::Impl::own_kg() const {
  double kg = 0.0;
  for (const arm::Segment& segment : arm.segments) kg += segment.mass_per_length_kg_m * segment.length_m;
  return kg;
}

double Estimator::Impl::end_kg() const {
  const double last_kg = have_last ? last_x[problem.payload_column()] * Problem::kPayloadUnit : 0.0;
  return arm.tip_mass_kg + std::max(0.0, payload_known.value_or(last_kg));
}

bool Estimator::Impl::allow_for_payload_change() {
  const double sd_kg = std::sqrt(payload_changes.variance_kg2());
  if (window || is_constant_curvature(options.method) || sd_kg == 0.0) return false;
  motion_errors = swing_errors;
  if (motion_errors.p.empty()) motion_errors.p.assign(arm.bodies.size(), Eigen::Matrix3Xd(3, 0));
  if (motion_errors.tangent.empty()) motion_errors.tangent = motion_errors.p;
  for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
    Observation body;
    body.body = static_cast<int>(b);
    const auto add = [&](Eigen::Matrix3Xd& to, const Vector3d& by_kg) {
      to.conservativeResize(Eigen::NoChange, to.cols() + 1);
      to.rightCols<1>() = sd_kg * by_kg;
    };
    add(motion_errors.p[b], problem.position_by_payload(body));
    add(motion_errors.tangent[b], problem.tangent_by_payload(body));
  }
  problem.set_motion(&motion_errors);
  return true;
}

Vector3d Estimator::Impl::gravity_variance_by_payload() const {
  if (payload_changes.variance_kg2() == 0.0) return Vector3d::Zero();
  const double bends_kg = std::max(1e-12, model::bending_load(own_kg(), end_kg()));
  const Vector3d gravity = base.linear().transpose() * arm.gravity_m_s2;
  return payload_changes.variance_kg2() / (bends_kg * bends_kg) * gravity.cwiseAbs2();
}

bool Estimator::Impl::told_but_for_change(int column) const {
  if (payload_changes.variance_kg2() == 0.0 || !covariance.determined[static_cast<std::size_t>(column)])
    return false;
  return std::sqrt(scatter(column, column)) <= options.identifiable_relative_sd * x[column];
}

void Estimator::Impl::look_at_payload() {
  if (estimate.status != Status::kOk) return;
  if (estimate.sd_payload_kg) {
    const double added = payload_changes.variance_kg2(), all = std::pow(*estimate.sd_payload_kg, 2);
    payload_changes.see(*estimate.payload_kg, std::max(all - added, kPolicy.payload.least_share * all),
                        !window);
  }
  estimate.settling = payload_changes.settling();
  if (!estimate.settling) return;
  estimate.identifiable_payload = false;
  for (SegmentEstimate& segment : estimate.segments) {
    segment.identifiable_stiffness = segment.identifiable_moment = false;
    segment.stiffness_why_not = WhyNot::kSettling;
  }
}

}  // namespace softarm::estimate
