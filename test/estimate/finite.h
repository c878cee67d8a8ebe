// Walks every number of an estimate.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "softarm/estimate/estimator.h"

namespace softarm::estimate::testing {

inline void expect_finite(const estimate::Estimate& e) {
  const auto number = [](double v, const char* what) {
    EXPECT_TRUE(std::isfinite(v)) << what << " is " << v;
  };
  const auto maybe = [&](const std::optional<double>& v, const char* what) {
    if (v) number(*v, what);
  };
  number(e.stamp_s, "stamp_s");
  for (const estimate::SegmentEstimate& s : e.segments) {
    maybe(s.moment_nm, "moment_nm");
    maybe(s.direction_rad, "direction_rad");
    maybe(s.bending_stiffness_nm2, "bending_stiffness_nm2");
    maybe(s.length_m, "length_m");
    maybe(s.actuation_curvature_per_m, "actuation_curvature_per_m");
    maybe(s.sd_moment_nm, "sd_moment_nm");
    maybe(s.sd_direction_rad, "sd_direction_rad");
    maybe(s.sd_bending_stiffness_nm2, "sd_bending_stiffness_nm2");
    maybe(s.sd_length_m, "sd_length_m");
    maybe(s.sd_actuation_curvature_per_m, "sd_actuation_curvature_per_m");
    number(s.bending_angle_rad, "bending_angle_rad");
    EXPECT_TRUE(s.covariance.allFinite()) << s.covariance;
  }
  maybe(e.payload_kg, "payload_kg");
  maybe(e.sd_payload_kg, "sd_payload_kg");
  EXPECT_TRUE(e.base_in_mocap.matrix().allFinite());
  for (const estimate::BackbonePoint& p : e.backbone) {
    number(p.arclength_m, "backbone.arclength_m");
    EXPECT_TRUE(p.p_base.allFinite() && p.q_base.coeffs().allFinite() && p.curvature_per_m.allFinite());
  }
  for (const estimate::BodyResidual& r : e.residuals) {
    EXPECT_TRUE(r.measured_base.allFinite() && r.estimated_base.allFinite());
  }
  for (const estimate::BodyTooFar& far : e.too_far) number(far.distance_m, "too_far.distance_m");
  number(e.rms_residual_m, "rms_residual_m");
  number(e.reduced_chi_square, "reduced_chi_square");
  number(e.solver.initial_cost, "solver.initial_cost");
  number(e.solver.final_cost, "solver.final_cost");
  // A refusal says why, an estimate does not.
  EXPECT_EQ(e.status == estimate::Status::kOk, e.detail.empty()) << to_string(e.status) << ": " << e.detail;
}

}  // namespace softarm::estimate::testing
