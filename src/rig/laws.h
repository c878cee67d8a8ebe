// What the inputs make of a segment of the true arm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>

#include "input_path.h"
#include "law_spec.h"
#include "scenario.h"

namespace softarm::rig {

/// A segment under its inputs.
struct Actuation {
  /// (M0 cos phi, M0 sin phi), phi the bending direction: the moment that alone, without any load, would give
  /// the segment its curvature. Cables are in it: bending stiffness times the curvature that they ask for.
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  /// How much it changes from the segment's begin to its end; moment_nm is its mean.
  Eigen::Vector2d moment_change_nm = Eigen::Vector2d::Zero();
  double twist_moment_nm = 0.0;          ///< about the tangent, that gives the segment its twist alone
  double bending_stiffness_nm2 = 0.0;    ///< with curvature per actual length
  double torsional_stiffness_nm2 = 0.0;  ///< taut tendons included
  double length_m = 0.0;                 ///< without load
  double stretch = 1.0;                  ///< of the wall by central chamber and tendons
  double core_stiffness_nm2 = 0.0;       ///< the part of bending_stiffness_nm2 that the vacuum gives
  double mean_pressure_pa = 0.0;         ///< gauge, of its chambers
  /// Against loads, with strains per actual length; absent: rigid.
  std::optional<double> shear_stiffness_n, axial_stiffness_n;
};

/// The inputs drive a segment where its laws do not hold; what() says why.
class LawError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The laws of one segment.
///
/// - Chambers: the semi-physical paper's (3)-(6) for the length on the bending axis, (9) for the stiffness,
///   (10)-(13) for the moment with the signs that the geometry of the chambers has.
/// - Tendons: a constant tension T along a tendon at offset r has the potential T times the tendon's length,
///   T * integral of |t + u x r| ds. Its derivatives: a moment T * r towards the tendon's azimuth, an axial
///   force -T, and, to first order in twist and shear, a torsional stiffness T * r^2 and a shear stiffness T.
/// - Central chamber: an axial force P * A on the wall.
/// - The wall's stretch under the axial force: see wall_stretch(). An incompressible wall that contracts
///   sideways freely has, per actual length, EI = E_t I with the tangent modulus E_t and the undeformed I.
/// - Cables: see CableSpec.
/// - Any of these may saturate and stiffen the segment: see SaturationSpec and StiffnessGrowth.
/// @param acting what acts in the segment, in the scenario's numbering
/// @param hidden departures from the laws above: see LawSpec
/// @throws LawError
Actuation apply_laws(const SegmentSpec& segment, const Acting& acting, const LawSpec& hidden = {});

/// A stretch and the tangent modulus there, relative to the unstretched wall's.
struct WallStretch {
  double stretch = 1.0;
  double modulus_ratio = 1.0;
};

/// Stretch of a wall of axial stiffness EA (unstretched) under an axial force N. Linear: 1 + N / EA. Two-term
/// Mooney-Rivlin in uniaxial tension, force per undeformed area 2 (C10 + C01 / x)(x - x^-2), whose modulus at
/// x = 1 is 6 (C10 + C01): N / EA = 2 (C10 + C01 / x)(x - x^-2) / (6 (C10 + C01)).
/// @return nothing where the material has no stable stretch (its force falls with stretch before N is
/// reached)
std::optional<WallStretch> wall_stretch(double force_n, double axial_stiffness_n,
                                        const std::optional<MaterialSpec>& material);

}  // namespace softarm::rig
