// A rod and its loads: everything the forward model needs to know, and nothing else.
//
// s is the arclength at rest (of the undeformed, unpressurised rod), measured over all segments from the
// base. World frame: any inertial frame; the rod's base is placed in it by p_base and q_base.
//
//   p' = k R v      R' = k R [u]x      n' = -f      m' = -p' x n - l      (' = d/ds, k = length /
//   rest_length) R^T m = K_bt (u - u*) - M_act,     R^T n = K_se (v - v*)
//
// n and m are what the distal part exerts on the proximal part, expressed in the world frame.
// (Antman, Nonlinear Problems of Elasticity, ch. 8; Rucker and Webster 2011, with the actuation as a given
// moment.)
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/export.h"

namespace softarm::rod {

/// One segment: constant parameters, except for a stiffness factor along s. Stiffness enters as compliance so
/// that a rigid direction is simply 0.
struct Segment {
  double rest_length_m = 0.0;                                      ///< extent in s; fixed for a Solver
  double length_m = 0.0;                                           ///< actual length at zero axial force
  double mass_kg = 0.0;                                            ///< spread evenly over the segment
  double bending_compliance = 0.0;                                 ///< 1 / EI, 1 / (N m^2)
  double torsional_compliance = 0.0;                               ///< 1 / GJ, 1 / (N m^2)
  double axial_compliance = 0.0;                                   ///< 1 / EA, 1 / N
  double shear_compliance = 0.0;                                   ///< 1 / GA, 1 / N
  Eigen::Vector3d rest_curvature_per_m = Eigen::Vector3d::Zero();  ///< u*, section frame
  Eigen::Vector3d moment_nm = Eigen::Vector3d::Zero();             ///< M_act, section frame, uniform
  /// Of a joint at the segment's start that turns, about the axes across it, by this times the moment m that
  /// it bears, rad / (N m). Actuation is inside the segment and does not reach it.
  double joint_compliance = 0.0;
  /// Of a section that is not round: bending moments are EI (I + [[a, b], [b, -a]]) times curvature (about x
  /// and y, section frame), a and b these two; |(a, b)| < 1.
  Eigen::Vector2d anisotropy = Eigen::Vector2d::Zero();
  std::vector<arm::StiffnessKnot> stiffness_profile;  ///< factor on EI and GJ; fixed for a Solver
  /// Where a model has laws by which it is not linear, so that it is their tangent at the moment that acts:
  /// rest curvature about x and y, and bending compliance, before any of them. No solver looks at these.
  Eigen::Vector2d unloaded_curvature_per_m = Eigen::Vector2d::Zero();
  double unloaded_bending_compliance = 0.0;

  /// Curvature beyond rest, about x and y, that a moment about them (N m) makes (without the profile).
  Eigen::Vector2d curvature_of(const Eigen::Vector2d& moment) const {
    const double a = anisotropy.x(), b = anisotropy.y();
    return bending_compliance / (1.0 - a * a - b * b) *
           Eigen::Vector2d((1.0 - a) * moment.x() - b * moment.y(), (1.0 + a) * moment.y() - b * moment.x());
  }
};

/// A load at one point. Force and moment are dead (fixed in the world) or follow the section.
struct PointLoad {
  double s_m = 0.0;  ///< fixed for a Solver
  bool follower = false;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_nm = Eigen::Vector3d::Zero();
  double mass_kg = 0.0;                                ///< adds the dead force mass * gravity
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< point of application in the section frame
};

struct SOFTARM_EXPORT Rod {
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base =
      Eigen::Quaterniond::Identity();  ///< section frame at s = 0; z along the tangent
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.80665};
  std::vector<Segment> segments;
  std::vector<PointLoad> loads;

  double rest_length_m() const;
};

/// A rod for an arm with laws applied to no input: stiffness base value, straight up along z at the origin;
/// gravity is rotated into the rod's base frame by the caller where needed. Loads: [0] tip mass (also when
/// 0), [1] payload of 0 kg.
SOFTARM_EXPORT Rod make_rod(const arm::Arm& arm);
/// Puts what the inputs make of the arm's segments into a rod of make_rod's layout: lengths, stiffnesses,
/// actuation. Nothing else is touched; allocates nothing.
/// @param predictions one per segment
SOFTARM_EXPORT void actuate(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& predictions,
                            Rod& rod);
constexpr int kTipMassLoad = 0;
constexpr int kPayloadLoad = 1;

/// Sets `out` to `weight` of b's values and 1 - weight of a's; all have the same layout. Allocates nothing if
/// `out` had that layout before.
SOFTARM_EXPORT void interpolate(const Rod& a, const Rod& b, double weight, Rod& out);

/// What may be free in a fit; index is that of the segment or load, component the axis (0, 1, 2).
enum class ParameterKind {
  kRestCurvature,        ///< u* component, 1/m; also the curvature by which an actuation acts
  kMoment,               ///< M_act component, N m
  kBendingCompliance,    ///< 1 / EI (kMoment held)
  kTorsionalCompliance,  ///< 1 / GJ
  kAxialCompliance,      ///< 1 / EA
  kShearCompliance,      ///< 1 / GA
  kBendingAnisotropy,    ///< of bending, component 0 or 1
  kJointCompliance,      ///< of the joint at a segment's start, rad / (N m)
  kLength,               ///< length of a segment, m
  kSegmentMass,          ///< mass of a segment, kg
  kLoadForce,            ///< force component of a load, N
  kLoadMoment,           ///< moment component of a load, N m
  kLoadMass,             ///< mass of a load, kg
  kLoadOffset,           ///< offset component of a load, m
  kGravity,              ///< gravity component, m/s^2
  kBaseRotation,         ///< rotation of the base about a world axis, rad
  kLoadScale,            ///< common factor on gravity and all point loads (at its value 1)
};

struct Parameter {
  ParameterKind kind = ParameterKind::kMoment;
  int index = 0;
  int component = 0;
};

}  // namespace softarm::rod
