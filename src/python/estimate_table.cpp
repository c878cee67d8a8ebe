#include "estimate_table.h"

#include "arrays.h"
#include "estimate/estimates_csv.h"

namespace softarm::python {

EstimateTable::EstimateTable(const arm::Arm& arm, int backbone_points)
    : segments_(arm.segments.size()),
      bodies_(arm.bodies.size()),
      points_(static_cast<std::size_t>(backbone_points)) {}

void EstimateTable::add_segment(const estimate::SegmentEstimate& segment) {
  append(moment_, segment.moment_nm);
  append(direction_, segment.direction_rad);
  append(stiffness_, segment.bending_stiffness_nm2);
  append(length_, segment.length_m);
  append(sd_moment_, segment.sd_moment_nm);
  append(sd_direction_, segment.sd_direction_rad);
  append(sd_stiffness_, segment.sd_bending_stiffness_nm2);
  append(sd_length_, segment.sd_length_m);
  identifiable_stiffness_.push_back(segment.identifiable_stiffness ? 1 : 0);
}

void EstimateTable::add_shape(const estimate::Estimate& estimate) {
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(kAbsent);
  const bool has_shape = estimate.backbone.size() == points_;
  for (std::size_t i = 0; i < points_; ++i) {
    append(backbone_, has_shape ? estimate.backbone[i].p_base : none);
    append(curvature_, has_shape ? estimate.backbone[i].curvature_per_m : none);
  }
  const std::size_t from = measured_.size();
  measured_.resize(from + 3 * bodies_, kAbsent);
  estimated_.resize(from + 3 * bodies_, kAbsent);
  for (const estimate::BodyResidual& body : estimate.residuals) {
    const std::size_t at = from + 3 * static_cast<std::size_t>(body.body);
    put(&measured_[at], body.measured_base);
    put(&estimated_[at], body.estimated_base);
  }
}

void EstimateTable::add(const estimate::Estimate& estimate) {
  static const estimate::SegmentEstimate kNone;
  stamp_.push_back(estimate.stamp_s);
  status_.push_back(static_cast<std::int8_t>(estimate.status));
  append(payload_, estimate.payload_kg);
  append(sd_payload_, estimate.sd_payload_kg);
  identifiable_payload_.push_back(estimate.identifiable_payload ? 1 : 0);
  settling_.push_back(estimate.settling ? 1 : 0);
  append(theta_, estimate::tip_angle_rad(estimate));
  append(tip_, estimate.backbone.empty() ? Eigen::Vector3d(Eigen::Vector3d::Constant(kAbsent))
                                         : estimate.backbone.back().p_base);
  const bool fitted = !estimate.residuals.empty();
  residual_.push_back(fitted ? estimate.rms_residual_m : kAbsent);
  chi_.push_back(fitted ? estimate.reduced_chi_square : kAbsent);
  for (std::size_t i = 0; i < segments_; ++i)
    add_segment(i < estimate.segments.size() ? estimate.segments[i] : kNone);
  add_shape(estimate);
}

pybind11::dict EstimateTable::take() {
  const auto n = static_cast<Py_ssize_t>(frames()), s = static_cast<Py_ssize_t>(segments_),
             b = static_cast<Py_ssize_t>(bodies_), p = static_cast<Py_ssize_t>(points_);
  py::dict d;
  d["stamp_s"] = array_of(std::move(stamp_), {n});
  d["status_code"] = array_of(std::move(status_), {n});
  d["M0_nm"] = array_of(std::move(moment_), {n, s});
  d["phi_rad"] = array_of(std::move(direction_), {n, s});
  d["EI_nm2"] = array_of(std::move(stiffness_), {n, s});
  d["L_m"] = array_of(std::move(length_), {n, s});
  d["payload_kg"] = array_of(std::move(payload_), {n});
  d["sd_M0_nm"] = array_of(std::move(sd_moment_), {n, s});
  d["sd_phi_rad"] = array_of(std::move(sd_direction_), {n, s});
  d["sd_EI_nm2"] = array_of(std::move(sd_stiffness_), {n, s});
  d["sd_L_m"] = array_of(std::move(sd_length_), {n, s});
  d["sd_payload_kg"] = array_of(std::move(sd_payload_), {n});
  d["identifiable_EI"] = array_of(std::move(identifiable_stiffness_), {n, s});
  d["identifiable_payload"] = array_of(std::move(identifiable_payload_), {n});
  d["settling"] = array_of(std::move(settling_), {n});
  d["theta_tip_rad"] = array_of(std::move(theta_), {n});
  d["tip_p_base_m"] = array_of(std::move(tip_), {n, 3});
  d["rms_residual_m"] = array_of(std::move(residual_), {n});
  d["reduced_chi_square"] = array_of(std::move(chi_), {n});
  d["backbone_p_base_m"] = array_of(std::move(backbone_), {n, p, 3});
  d["backbone_curvature_per_m"] = array_of(std::move(curvature_), {n, p, 3});
  d["bodies_measured_base_m"] = array_of(std::move(measured_), {n, b, 3});
  d["bodies_estimated_base_m"] = array_of(std::move(estimated_), {n, b, 3});
  return d;
}

}  // namespace softarm::python
