// An arm of one segment with something hidden in its body, for the tests of the virtual rig.
#pragma once

#include "../../src/rig/arm_cut.h"

namespace softarm::rig {

/// 0.2 m, 0.2 kg, EI 0.03 N m^2, no gravity, hanging on nothing: to be changed before it is built.
struct HiddenArm {
  Scenario scenario;
  Actuation actuation;
  RitzRodInputs inputs;

  HiddenArm() {
    scenario.gravity_m_s2 = 0.0;
    scenario.arm.segments.resize(1);
    scenario.arm.segments[0].retardation_s = 0.0;
    scenario.arm.air_damping_n_s_m2 = 0.0;
    scenario.payload.schedule = {{0.0, {0.0}}};
    actuation.length_m = 0.2;
    actuation.bending_stiffness_nm2 = 0.03;
    actuation.torsional_stiffness_nm2 = 0.03;
  }

  /// The base's z axis along x of the mocap frame, its x axis down.
  void mount_horizontally() {
    scenario.gravity_m_s2 = 9.81;
    scenario.mount.q_mocap_base = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY());
  }

  Cut cut() const { return cut_arm(scenario); }
  RitzRod rod() const { return RitzRod(rod_params(scenario, cut())); }
  RitzRodInputs now() const {
    RitzRodInputs result = inputs;
    result.pieces = piece_inputs(cut(), {actuation});
    return result;
  }
  RitzRod settled() const {
    RitzRod result = rod();
    if (!result.settle(now())) throw std::runtime_error("no equilibrium");
    return result;
  }
};

/// Angle of the tip's tangent in the x-z plane.
inline double tip_angle(const RitzRod& rod) {
  const Eigen::Vector3d tangent = rod.pose(1.0).linear().col(2);
  return std::atan2(tangent.x(), tangent.z());
}

}  // namespace softarm::rig
