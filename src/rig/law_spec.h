// What is hidden in the laws from inputs to moment, stiffness and length: what no arm file says. Absent:
// ideal.
#pragma once

#include <map>
#include <optional>
#include <vector>

namespace softarm::rig {

/// Departures of a segment's laws. Pressures are gauge; "the mean pressure" is that of all pneumatic chambers
/// of the segment, a central one included. A share is relative to the ideal law's value.
struct LawSpec {
  /// A share that is reached at a pressure (or vacuum).
  struct ShareAt {
    double share = 0.0, reference_pa = 1.0;
  };

  /// Moment of a chamber = gain p (1 + share p / reference); saturating: share (1 - exp(-p / reference)) /
  /// (1 - 1 / e) instead of share p / reference, the same at the reference.
  struct GainNonlinearity : ShareAt {
    bool saturating = false;
  };
  std::optional<GainNonlinearity> gain_nonlinearity;

  /// No moment below a pressure. Smooth: p is replaced by w ln(1 + e^((p - p0) / w)), less its value at p =
  /// 0, with w = p0 / 4; sharp: by max(0, p - p0). Odd in p. Of all chambers it is the walls', which give no
  /// moment; of one (from 0) it is its supply's, and whatever its pressure does is less.
  struct DeadZone {
    double pressure_pa = 0.0;
    bool smooth = false;
    int chamber = -1;
  };
  std::optional<DeadZone> dead_zone;

  /// EI times 1 + share p / reference of the mean pressure; quadratic: (p / reference)^2.
  struct Stiffening : ShareAt {
    bool quadratic = false;
  };
  std::optional<Stiffening> pressure_stiffening;

  /// The radius times 1 + share p / reference of the mean pressure; EI and GJ go with its power.
  struct RadialExpansion : ShareAt {
    int power = 2;
  };
  std::optional<RadialExpansion> radial_expansion;

  std::optional<ShareAt> pressure_elongation;  ///< length times 1 + share p / reference of the mean pressure
  std::optional<ShareAt> vacuum_shortening;    ///< length times 1 - share V / reference
  std::optional<ShareAt> vacuum_gain;          ///< moments of all actuators times 1 - share V / reference

  /// Cables are slack: an angle of the servo takes that up before they pull. Sagging, a slack cable pulls
  /// before it is taut: s (1 - e^(-angle / s)) of the angle is lost.
  struct Slack {
    double angle_rad = 0.0;
    bool sags = false;
  };
  std::optional<Slack> cable_slack;

  /// Cables of a segment pass through those before it, as far from the axis as in their own, and are held: of
  /// what is wound up of a cable, what those are bent towards it has taken lever * angle, times share.
  /// Slackens: a cable only pulls, and what one that is slack already loses more is nothing.
  struct CablesThrough {
    double share = 0.0;
    bool slackens = false;
  };
  std::optional<CablesThrough> cables_through;

  std::map<int, double> chamber_gain_share;  ///< of the gain, by number of the pressure from 0
  double actuators_turned_rad = 0.0;         ///< all azimuths of actuators, about the tangent

  /// Curvature without any input or load, fixed in the body.
  struct RestCurvature {
    int segment = 0;  ///< from 0; -1: all
    double curvature_per_m = 0.0, azimuth_rad = 0.0;
  };
  std::vector<RestCurvature> rest_curvature;

  /// Each segment twists by so much at the reference of the mean pressure (or tension, where it has no
  /// chamber).
  struct Twist {
    double angle_rad = 0.0, reference = 1.0;
  };
  std::optional<Twist> twist_with_pressure, twist_with_tension;

  /// The share of EI that jamming adds, b3 V, goes with another function of the vacuum, the same at the
  /// reference: power: (V / reference)^exponent; otherwise (1 - e^(-V / scale)) / (1 - e^(-reference /
  /// scale)).
  struct JammingLaw {
    bool power = false;
    double reference_pa = 60e3, exponent = 1.0, scale_pa = 20e3;
  };
  std::optional<JammingLaw> jamming_law;

  /// Moments of all actuators times 1 + share * (bending angle of the segment / 1 rad).
  double gain_share_per_rad = 0.0;

  /// Chambers of a segment press on each other: gain times 1 + share q, q the sum of the others' p /
  /// reference; saturating: 2 q / (1 + q) instead of q, the same at the reference.
  struct ChamberBulge : ShareAt {
    bool saturating = false;
  };
  std::optional<ChamberBulge> chamber_bulge;
};

}  // namespace softarm::rig
