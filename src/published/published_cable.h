// The cable-driven arm of "Model Analysis of Robotic Soft Arms including External Force Effects": servo to
// curvature, (4)-(5) and (14)-(15), and the shape under one point load, (7)-(13), as printed and as statics
// has it.
//
// Plane of the arm: x along the clamped tangent, horizontal; y downwards, as the load pulls. theta is the
// tangent's angle from x towards y, p = 0 at s = 0. With that y, (7) with its printed sign is the statics of
// a hanging load; a cable on the upper side bends the arm against it: k < 0. The arm itself has no weight.
//
// What the print has:
// - (4) Delta L = r theta, so k = Delta L / (L r); (5) has r + r_t for r: a third less bending for the
// paper's
//   7.5 and 2.5 mm. (5) is what the paper computes with.
// - (15) takes the servo's angle from its end stop (PWM 500), though the cable is taut and the arm straight
// at
//   some other one (1365 in 4.1). Here the angle is counted from there.
// - (9) integrates from s to L: the distance to the tip. (13) integrates from the base, as done here.
// - (10) rotates the load by theta_0(s) along the arm, as if its direction differed from section to section.
//   With alpha the angle between load and unbent arm at M, a dead load needs theta_0(M), constant.
// - (11) has theta'(M) = -k where (12) has +k, though no moment acts at M. With (11) an arm without load
// bends
//   the wrong way up to M.
// - A curvature imposed as a rest curvature is a cable of constant tension (EI k / r). A servo that holds its
//   angle holds the cable's length: kConstantLength.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "softarm/rod/solver.h"

namespace softarm::published {

/// The paper's drive (section 3.1). Lengths in m.
struct CableDrive {
  double spool_radius_m = 0.020;     ///< r_s
  double arm_radius_m = 0.0075;      ///< r
  double wall_thickness_m = 0.0025;  ///< r_t
  double length_m = 0.235;           ///< L_0
  double straight_pwm = 1365.0;      ///< at which the arm is straight (4.1)
};

/// (14): 0 at PWM 500, 270 degrees at 2500.
/// @return rad; nothing outside 500 ... 2500
std::optional<double> steering_angle_rad(double pwm);
/// (15) with the angle from straight_pwm: the length by which the cable is wound up, m; < 0 if it is let out.
std::optional<double> cable_change_m(const CableDrive& drive, double pwm);
/// (5): Delta L / (L_0 (r + r_t)).
double curvature_per_m(const CableDrive& drive, double cable_change_m);
/// (4): Delta L / (L_0 r).
double curvature_at_arm_radius_per_m(const CableDrive& drive, double cable_change_m);

enum class CableLaw {
  kPrinted,         ///< (10)-(12) to the letter for a load off the tip; at the tip (7)-(8), which are right
  kPrintedForce,    ///< (10) with its turning load, but +k in (11)
  kStatics,         ///< dead load, rest curvature k: a cable of constant tension
  kConstantLength,  ///< dead load, cable of the length that bends the unloaded arm to k; slack rather than
                    ///< pushing
};

struct CableArm {
  double bending_stiffness_nm2 = 0.0;  ///< EI > 0
  double length_m = 0.0;               ///< L > 0
  double curvature_per_m = 0.0;        ///< k of the arm without load
  double load_n = 0.0;                 ///< F >= 0, vertical
  double load_arclength_m = 0.0;       ///< M, 0 < M <= L
  /// Of the cable from the middle line, > 0; for the tension alone.
  double cable_offset_m = 0.01;
};

struct CableOptions {
  int steps = 200;  ///< Runge-Kutta steps of the part up to the load, and nodes beyond it; 4 ... 100000
};

struct CableShape {
  rod::SolveStatus status = rod::SolveStatus::kInvalidInput;  ///< the rest is empty unless kConverged
  Eigen::VectorXd s_m;                                        ///< 0 ... M ... L, nodes
  Eigen::VectorXd theta_rad;
  Eigen::Matrix2Xd p_m;             ///< (x, y), one column per node; (13)
  Eigen::VectorXd curvature_per_m;  ///< theta'; at M that of the side towards the base
  /// Of the cable, N: EI |k| / r at constant tension. 0: slack.
  double tension_n = 0.0;
};

/// Shooting for the angle at the load with MINPACK, from the unloaded arm to the loaded one; Runge-Kutta of
/// 4th order.
CableShape solve_cable(const CableArm& arm, CableLaw law, const CableOptions& options = {});

}  // namespace softarm::published
