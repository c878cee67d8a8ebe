// What is done to the arm: pressures, vacuum and payload as smooth functions of time, and what the
// semi-physical laws make of them.
#pragma once

#include <vector>

#include "softarm/rig/ritz_rod.h"
#include "softarm/rig/scenario.h"

namespace softarm::rig {

/// Everything commanded at one time.
struct Commands {
  std::vector<double> pressures_pa;  ///< gauge, one per chamber
  double vacuum_pa = 0.0;            ///< below ambient
  double payload_kg = 0.0;
  double hand_damping_n_s_m = 0.0;  ///< > 0 while the payload is being changed
};

/// What the arm is under these commands.
struct Actuation {
  Eigen::Vector2d moment_nm =
      Eigen::Vector2d::Zero();  ///< (M0 cos phi, M0 sin phi), phi the bending direction
  double bending_stiffness_nm2 = 0.0;
  double length_m = 0.0;
};

/// The payload was changed at t_s and is kg from then on.
struct PayloadChange {
  double t_s = 0.0;
  double kg = 0.0;
};

/// The scenario's protocol, a pure function of time.
class Protocol {
 public:
  explicit Protocol(const Scenario& scenario);

  Commands at(double t_s) const;
  /// The last change of the payload that is known by t_s: the middle of the smooth change is its time.
  PayloadChange payload_known_at(double t_s) const;

 private:
  struct Sinusoid {
    double hz, phase;
  };
  double pressure(std::size_t chamber, double t_s) const;

  Scenario scenario_;
  std::vector<std::vector<Sinusoid>> sinusoids_;  ///< per chamber
};

/// The semi-physical laws (semi-physical paper: (3)-(6) for the length on the bending axis, (9) for the
/// stiffness, (10)-(13) for the moment with the signs that the geometry of the chambers has).
Actuation apply_laws(const ArmSpec& arm, const Commands& commands);

/// 0 before 0, 1 after 1, with continuous velocity and acceleration.
double smooth_ramp(double x);

}  // namespace softarm::rig
