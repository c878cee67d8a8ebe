// What the inputs make of a segment: the laws of the papers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"

namespace softarm::arm {

/// Values of all inputs in the order of Arm::inputs.scalars, as InputKind says: chambers as gauge Pa, vacuum
/// as Pa below ambient, tensions in N, angles in rad. An input that is not known is absent.
using InputValues = std::vector<std::optional<double>>;

/// What a segment's inputs make of it.
struct SegmentPrediction {
  /// Actuation by chambers and tendons: (M cos phi, M sin phi), phi the bending direction.
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  /// Actuation by cables: curvature at which the segment is free of bending moment, towards (cos phi, sin
  /// phi).
  Eigen::Vector2d curvature_per_m = Eigen::Vector2d::Zero();
  double bending_stiffness_nm2 = 0.0;  ///< EI, with curvature per actual length
  double length_m = 0.0;               ///< without external load
  double modulus_ratio = 1.0;          ///< tangent modulus over the unstretched one; applies to EA, GA, GJ
  /// What taut tendons add to the stiffness in shear (the sum of their tensions) and in twist (the sum of
  /// tension times offset squared): a tendon turns with the section it passes through (Rucker and Webster
  /// 2011, to first order in shear and twist).
  double tendon_shear_stiffness_n = 0.0;
  double tendon_torsional_stiffness_nm2 = 0.0;

  /// All actuation as a moment, N m: moment + EI * curvature.
  Eigen::Vector2d actuation_nm() const { return moment_nm + bending_stiffness_nm2 * curvature_per_m; }
};

/// Applies the laws to one segment.
///
/// - Chambers: length law (3)-(6), stiffness law (7)-(9), moment law (10)-(13) of the semi-physical paper.
/// The sign of
///   the third chamber's M_y is that of the geometry (chambers 120 degrees apart), not the printed one. A
///   minimum or a sum of pressures below zero (a sensor's zero error) adds no negative stiffness.
/// - Central chamber and tendons: axial force of the wall N = P A - sum of tensions, from the balance of a
/// section of
///   wall, gas and tendons together (hybrid paper (5), (15)); its stretch follows from EA (rigid: none) and,
///   if given, the Mooney-Rivlin law, whose tangent modulus scales the stiffnesses. Incompressible rubber
///   free to contract sideways: EI per actual length is E_t I of the undeformed section. A tendon's moment is
///   its tension times its offset. Negative tensions and absolute pressures are slack: 0.
/// - Cables: curvature, see Cable.
/// - Moments and cables' curvatures may fall behind their inputs, see Saturation; EI may grow with them, see
///   StiffnessLaw. Pressures and tensions below zero count as 0 there.
/// @param inputs in the order of Arm::inputs.scalars; a shorter list lacks its last inputs
/// @return nothing where an input that the segment needs is absent or not finite, or where the inputs lie so
/// far outside the laws' validity that no positive length or stiffness, or no stable stretch of the material,
/// remains. The vacuum is needed only by a segment whose stiffness depends on it.
SOFTARM_EXPORT std::optional<SegmentPrediction> predict_segment(const Arm& arm, const Segment& segment,
                                                                const InputValues& inputs);

/// All segments, base to tip; nothing where one has nothing.
SOFTARM_EXPORT std::optional<std::vector<SegmentPrediction>> predict(const Arm& arm,
                                                                     const InputValues& inputs);

/// Whether EI of the segment depends on inputs.
SOFTARM_EXPORT bool stiffness_depends_on_inputs(const Segment& segment);

/// Indices into Arm::inputs.scalars of what the segment's laws need, increasing. The vacuum is among them
/// only where the stiffness depends on it.
SOFTARM_EXPORT std::vector<int> inputs_of(const Arm& arm, const Segment& segment);

/// Names of the inputs that the segment's laws need and that are absent or not finite: "chamber_1, tendon_2";
/// empty if there is none.
SOFTARM_EXPORT std::string missing_inputs(const Arm& arm, const Segment& segment, const InputValues& inputs);

}  // namespace softarm::arm
