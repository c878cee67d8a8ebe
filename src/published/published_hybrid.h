// The tendon-driven arm with a central chamber of "Hyperelastic Modeling and Validation of Hybrid-Actuated
// Soft Robot with Pressure-Stiffening": equations (3)-(12) and (15)-(18), tendons after Rucker and Webster
// (2011), as printed and as statics has it.
//
// Arm frame: p = 0 at s = 0, z along the tangent there: the paper's e_1. s is the arclength of the unloaded
// arm.
//
// Which signs are right. Let N, M be force and moment of a whole section: N' = -rho A g, M' = -p' x N. Wall
// (n, m), tendons and gas share them; gas presses on both sides of a cut:
//   N = n + sum tau_i t_i - P A e,   M = m + sum R r_i x tau_i t_i,   e = R e_1, t_i the tendon's tangent.
// Differentiated, with (p + R r_i)' parallel to t_i:
//   n' = -rho A g - T^t + P A e',    m' = -p' x n + P A p' x e - l^t,   p' x e = R (v x e_1),
// and at a tip that carries a force F: n = F - sum tau_i t_i + P A e, m = -sum R r_i x tau_i t_i.
// - (15) agrees. (5) and (6) have both pressure terms with the other sign: the wall would lose along the arm
// the
//   tension that (15) gives it at the tip, as soon as the arm bends. That acts as a pull of 2 P A^ch along
//   the tip's tangent, which bends the arm further: identified with it, an EI that does not depend on the
//   pressure seems to grow by 90 % up to 40 kPa (arm of Table 2, 3 N, 90 degrees).
// - (16) adds P A R (v x e_1), a force among moments; gas on the axis has no moment about it.
// - (15) and (16) are for one tendon i; the sum over all is meant.
// (7) and (8) are right; T^t contains the derivatives of u and v, hence the states p, R, u, v here.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "softarm/rod/solver.h"

namespace softarm::published {

/// Straight along the arm.
struct HybridTendon {
  double azimuth_rad = 0.0;  ///< of its place in the section, from x; the arm bends towards it
  double offset_m = 0.0;     ///< r
};

struct HybridArm {
  double length_m = 0.0;
  double bending_stiffness_nm2 = 0.0;    ///< E(P) I_22, moment per change of angle over s
  double torsional_stiffness_nm2 = 0.0;  ///< G(P) I_11
  double axial_stiffness_n = 0.0;        ///< E(P) A_o
  double shear_stiffness_n = 0.0;        ///< G(P) A_o
  double chamber_area_m2 = 0.0;          ///< A^ch
  std::vector<HybridTendon> tendons;
  Eigen::Vector3d weight_n = Eigen::Vector3d::Zero();  ///< rho A g L, arm frame
};

/// The arm of Table 2, its three tendons 120 degrees apart from azimuth 0, without weight.
/// @param modulus_pa E; the printed constants make it 28.8 kPa, with which 3 N would wind the arm up 5.6
/// times
HybridArm hybrid_paper_arm(double modulus_pa);

struct HybridLoad {
  std::vector<double> tension_n;                          ///< tau_i >= 0, one per tendon
  double pressure_pa = 0.0;                               ///< gauge
  Eigen::Vector3d tip_force_n = Eigen::Vector3d::Zero();  ///< dead, arm frame; 0 in (15)
};

enum class HybridLaw {
  kPrinted,  ///< the signs of (5), (6) and the last term of (16) as printed
  kStatics,
};

struct HybridOptions {
  int steps = 100;  ///< of Runge-Kutta (4th order); 4 ... 100000
};

struct HybridShape {
  rod::SolveStatus status = rod::SolveStatus::kInvalidInput;  ///< the rest is empty unless kConverged
  Eigen::VectorXd s_m;                                        ///< steps + 1 nodes
  Eigen::Matrix3Xd p_m;                                       ///< one column per node, arm frame
  Eigen::Matrix3Xd u_per_m;                                   ///< section frame
  Eigen::Matrix3Xd v;                                         ///< section frame, (0 0 1) at rest
};

/// Shooting on u(0), v(0) with MINPACK, from the unloaded arm to the loaded one.
HybridShape solve_hybrid(const HybridArm& arm, const HybridLoad& load, HybridLaw law,
                         const HybridOptions& options = {});

/// The production model's rod for the same arm: straight tendons as an actuation moment, a length, and
/// stiffness against shear and twist (laws.h). The paper's stiffnesses are per s, the rod's per actual
/// length. Weight as gravity on a mass of 1 kg; load 0 is the force at the tip.
/// @pre as for solve_hybrid, and sum of tensions - P A < EA
rod::Rod linear_rod(const HybridArm& arm, const HybridLoad& load);

}  // namespace softarm::published
