#include "softarm/rod/rod.h"

#include "actuation.h"

namespace softarm::rod {

double Rod::rest_length_m() const {
  double sum = 0.0;
  for (const Segment& segment : segments) sum += segment.rest_length_m;
  return sum;
}

Rod make_rod(const arm::Arm& arm) {
  Rod rod;
  rod.gravity_m_s2 = arm.gravity_m_s2;
  for (const softarm::arm::Segment& from : arm.segments) {
    const auto compliance = [](const std::optional<double>& stiffness) {
      return stiffness ? 1.0 / *stiffness : 0.0;
    };
    Segment to;
    to.rest_length_m = from.length_m;
    to.length_m = from.length_m;
    to.mass_kg = from.mass_per_length_kg_m * from.length_m;
    to.bending_compliance = 1.0 / from.bending_stiffness.base_nm2;
    to.torsional_compliance = compliance(from.torsional_stiffness_nm2);
    to.axial_compliance = compliance(from.axial_stiffness_n);
    to.shear_compliance = compliance(from.shear_stiffness_n);
    to.rest_curvature_per_m = from.rest_curvature_per_m;
    to.joint_compliance = from.joint_compliance_rad_per_nm.value_or(0.0);
    to.stiffness_profile = from.stiffness_profile;
    rod.segments.push_back(to);
  }
  rod.loads.resize(2);
  rod.loads[kTipMassLoad].s_m = rod.rest_length_m();
  rod.loads[kTipMassLoad].mass_kg = arm.tip_mass_kg;
  rod.loads[kPayloadLoad].s_m = arm.payload.arclength_m;
  rod.loads[kPayloadLoad].offset_m = arm.payload.offset_m;
  return rod;
}

void actuate(const arm::Segment& from, const arm::SegmentPrediction& now, const Eigen::Vector2d& actuation_nm,
             double share, Segment& to) {
  const auto compliance = [&](const std::optional<double>& stiffness, double added) {
    return stiffness ? 1.0 / (*stiffness * now.modulus_ratio + added) : 0.0;
  };
  to.length_m = share * now.length_m;
  to.bending_compliance = 1.0 / now.bending_stiffness_nm2;
  to.torsional_compliance = compliance(from.torsional_stiffness_nm2, now.tendon_torsional_stiffness_nm2);
  to.axial_compliance = compliance(from.axial_stiffness_n, 0.0);
  to.shear_compliance = compliance(from.shear_stiffness_n, now.tendon_shear_stiffness_n);
  // Bending towards phi is a turn about the axis at phi + 90 degrees.
  to.moment_nm = {-actuation_nm.y(), actuation_nm.x(), 0.0};
}

void actuate(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions, Rod& rod) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i)
    actuate(arm.segments[i], predictions[i], predictions[i].actuation_nm(), 1.0, rod.segments[i]);
}

void interpolate(const Rod& a, const Rod& b, double weight, Rod& r) {
  r = b;
  const double v = 1.0 - weight;
  const auto mix = [&](auto& to, const auto& from) { to = v * from + weight * to; };
  mix(r.p_base, a.p_base);
  r.q_base = a.q_base.slerp(weight, b.q_base);
  mix(r.gravity_m_s2, a.gravity_m_s2);
  for (std::size_t i = 0; i < r.segments.size(); ++i) {
    Segment& to = r.segments[i];
    const Segment& from = a.segments[i];
    mix(to.length_m, from.length_m);
    mix(to.mass_kg, from.mass_kg);
    mix(to.bending_compliance, from.bending_compliance);
    mix(to.torsional_compliance, from.torsional_compliance);
    mix(to.axial_compliance, from.axial_compliance);
    mix(to.shear_compliance, from.shear_compliance);
    mix(to.rest_curvature_per_m, from.rest_curvature_per_m);
    mix(to.moment_nm, from.moment_nm);
    mix(to.joint_compliance, from.joint_compliance);
    mix(to.anisotropy, from.anisotropy);
  }
  for (std::size_t i = 0; i < r.loads.size(); ++i) {
    PointLoad& to = r.loads[i];
    const PointLoad& from = a.loads[i];
    mix(to.force_n, from.force_n);
    mix(to.moment_nm, from.moment_nm);
    mix(to.mass_kg, from.mass_kg);
    mix(to.offset_m, from.offset_m);
  }
}

}  // namespace softarm::rod
