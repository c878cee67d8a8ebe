// How the laws of a segment depart from the ideal: private to the rig.
#pragma once

#include "laws.h"

namespace softarm::rig {

/// What a dead zone leaves of a pressure.
double beyond_dead_zone(const LawSpec::DeadZone& zone, double pressure_pa);

/// What is hidden in the laws of one segment under what acts in it. Where nothing is hidden, every factor is
/// exactly 1 and every pressure as it is.
class LawDepartures {
 public:
  LawDepartures(const SegmentSpec& segment, const Acting& acting, const LawSpec& hidden);

  /// A chamber's pressure as its moment goes by it: dead zone, nonlinearity, neighbours, mismatch.
  double moment_pressure_pa(const ChamberSpec& chamber) const;
  /// A servo's angle that winds up cable which is not slack.
  double pulling_rad(double angle_rad) const;
  /// Of the length of a cable that is wound up, what shortens it in its own segment.
  double shortens_m(const CableSpec& cable, double wound_m) const;
  /// An actuator's azimuth where it really sits.
  double azimuth_rad(double stated_rad) const { return stated_rad + hidden_.actuators_turned_rad; }
  /// Of the moments of all actuators.
  double gain() const;
  /// Of EI beyond all else, of GJ, of shear and axial stiffness.
  double bending() const;
  double torsion() const;
  double material() const { return acting_.stiffness_scale; }
  double length() const;
  /// The vacuum that the granules' share of EI is linear in.
  double jamming_pa() const;
  /// Rest curvature (1/m) and the twist of the whole segment (rad).
  Eigen::Vector2d rest_curvature_per_m() const;
  double twist_rad() const;

 private:
  double pressure(int input) const { return acting_.pressures_pa.at(static_cast<std::size_t>(input)); }

  const SegmentSpec& segment_;
  const Acting& acting_;
  const LawSpec& hidden_;
  double mean_pa_ = 0.0;
};

}  // namespace softarm::rig
