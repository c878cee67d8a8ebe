// The constants of an arm's laws, each by a name: what identification may change.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"

namespace softarm::arm {

/// In the order in which the constants of a segment are listed.
enum class ConstantKind {
  kMomentGain,          ///< c_i of a chamber, N m / Pa
  kChamberSaturation,   ///< a_i of Saturation, 1 / Pa
  kChambersSaturation,  ///< b, 1 / Pa
  kElongation,          ///< a_near + a_far of a chamber, m / Pa: only the sum enters a backbone's length, (6)
  kTendonOffset,        ///< m
  kTendonSaturation,    ///< 1 / N
  kTendonsSaturation,
  kCableGain,        ///< 1 / (m rad)
  kCableSaturation,  ///< 1 / rad
  kCablesSaturation,
  kBendingStiffness,  ///< b1, EI without input, N m^2
  kByPressure,        ///< EI at one knot of StiffnessLaw::by_pressure, N m^2
  kPerMinPressure,    ///< b2, N m^2 / Pa
  kPerMeanPressure,   ///< N m^2 / Pa
  kPerChamber,        ///< EI by one chamber's pressure, N m^2 / Pa
  kPerTension,        ///< N m^2 / N
  kPerMinTension,
  kPerTendon,  ///< EI by one tendon's tension, N m^2 / N
  kPerAngle,   ///< N m^2 / rad
  kPerMinAngle,
  kPerCable,            ///< EI by one cable's angle, N m^2 / rad
  kPerJammingPressure,  ///< b3, N m^2 / Pa
  kJointCompliance,     ///< of the joint at a segment's start, rad / (N m)
  kWallBendingTime,     ///< of an element of Wall, s
  kWallBendingShare,
  kWallAxialTime,
  kWallAxialShare,
  kWallSlowing,      ///< Wall::slows_per_pa, 1 / Pa
  kWallShareGrowth,  ///< Wall::shares_grow_per_pa, 1 / Pa
  kAxialStiffness,   ///< EA, N
  kLength,           ///< backbone length at zero input, m
  kRestCurvatureX,   ///< u*_x, a turn about the section's x axis, 1 / m
  kRestCurvatureY,
};

/// What a constant is to the statics, for those who treat alike what acts alike.
enum class ConstantRole {
  kMoment,                 ///< moment per input: without load only its ratio to the stiffness shows
  kSaturation,             ///< how a moment falls behind its input; that it does not is common
  kBendingStiffness,       ///< an EI
  kBendingStiffnessSlope,  ///< EI per input; that there is none is common
  kJoint,                  ///< compliance of a joint; that there is none is common
  kWall,                   ///< of a wall's element; that there is none is common
  kAxialStiffness,         ///< EA
  kOther,
};

/// One constant of one segment.
struct ConstantRef {
  ConstantKind kind = ConstantKind::kMomentGain;
  int segment = 0;  ///< index into Arm::segments
  int index = 0;    ///< of the chamber, tendon, cable or knot
  /// Other segments whose constant of this kind and index has the same value: a stiffness that all share,
  /// say.
  std::vector<int> tied = {};
};

/// The constant's segment and those that are tied to it.
SOFTARM_EXPORT std::vector<int> segments_of(const ConstantRef& constant);

/// "<segment>.<what>", counted from 1: "segment_1.chamber_2.moment_gain", "segment_1.chamber_2.elongation",
/// "segment_1.bending_stiffness.base", ".per_min_pressure", ".per_jamming_pressure", ".by_pressure.3",
/// ".per_mean_pressure", ".per_chamber_2", ".per_tension", ".per_min_tension", ".per_tendon_1", ".per_angle",
/// ".per_min_angle", ".per_cable_1", "segment_1.chamber_2.saturation",
/// "segment_1.chambers.saturation" (of all together; tendons and cables alike), "segment_1.tendon_1.offset",
/// "segment_1.cable_1.curvature_gain", "segment_1.joint_compliance", "segment_1.wall.bending_1.time",
/// ".wall.bending_1.share", ".wall.axial_1.time", ".wall.axial_1.share", ".wall.slowing",
/// ".wall.share_growth",
/// "segment_1.axial_stiffness",
/// "segment_1.length", "segment_1.rest_curvature.x". Tied ones: "segment_1=segment_2.bending_stiffness.base".
SOFTARM_EXPORT std::string name_of(const Arm& arm, const ConstantRef& constant);
/// SI, as a person writes it: "N m/Pa".
SOFTARM_EXPORT std::string unit_of(ConstantKind kind);
SOFTARM_EXPORT ConstantRole role_of(ConstantKind kind);

SOFTARM_EXPORT double value_of(const Arm& arm, const ConstantRef& constant);

/// Sets one constant, in all of its segments.
/// - kElongation changes near_elongation and leaves far_elongation.
/// - kLength carries along what sits on the segment: bodies and payload keep their fraction of it, and its
///   mass stays what it weighs (mass_per_length changes).
SOFTARM_EXPORT void set_value(Arm& arm, const ConstantRef& constant, double value);

/// What the description of an arm allows.
SOFTARM_EXPORT Range allowed_range(const Arm& arm, const ConstantRef& constant);

/// Whether an input pulls along the segment: a central chamber or a tendon. Else EA is identifiable by
/// weights alone.
SOFTARM_EXPORT bool strained_by_inputs(const Segment& segment);

/// Every constant that the arm may have, base to tip: those of its actuation and stiffness laws, then those
/// that it does not state (saturation, growth of EI), EA where it is given, lengths and rest curvatures. A
/// knot of by_pressure replaces base.
SOFTARM_EXPORT std::vector<ConstantRef> constants_of(const Arm& arm);

/// Whether the arm has a value for it, be it 0. What is not stated acts as 0.
SOFTARM_EXPORT bool is_stated(const Arm& arm, const ConstantRef& constant);

/// Those that identification frees unless told otherwise: all that are stated but lengths and rest
/// curvatures, and EA only where an input strains the arm (what a payload stretches it by is often less than
/// what the laws leave).
SOFTARM_EXPORT std::vector<ConstantRef> default_free(const Arm& arm);

}  // namespace softarm::arm
