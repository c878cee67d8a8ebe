// What is done to the arm: inputs, vacuum and payload as smooth functions of time.
#pragma once

#include <memory>
#include <vector>

#include "scenario.h"

namespace softarm::rig {

/// Everything commanded at one time.
struct Commands {
  std::vector<double> pressures_pa;  ///< gauge, one per pressure input
  std::vector<double> tensions_n;    ///< one per tendon
  std::vector<double> angles_rad;    ///< one per servo
  double vacuum_pa = 0.0;            ///< below ambient
  double payload_kg = 0.0;
  double hand_damping_n_s_m = 0.0;  ///< > 0 while the payload is being changed
};

/// The payload was changed at t_s and is, as far as anybody knows, kg from then on.
struct PayloadChange {
  double t_s = 0.0;
  double kg = 0.0;
};

/// How long the programmes take until everything is at rest again; 0: there is none.
struct ProgrammeTimes {
  double pressures_s = 0.0, tensions_s = 0.0, angles_s = 0.0;
};

class Moves;

/// The scenario's protocol, a pure function of time.
class Protocol {
 public:
  explicit Protocol(const Scenario& scenario);

  Commands at(double t_s) const;
  /// The last change of the payload that is known by t_s: the middle of the smooth change is its time.
  PayloadChange payload_known_at(double t_s) const;
  ProgrammeTimes programme_times() const;

 private:
  struct Sinusoid {
    double hz, phase;
  };
  struct Drive {
    DriveSpec spec;
    std::vector<std::vector<Sinusoid>> sinusoids;  ///< per input
    std::shared_ptr<const Moves> programme;        ///< null: none
  };
  Drive drive(const DriveSpec& spec, int inputs, std::uint64_t purpose) const;
  std::vector<double> values(const Drive& drive, double t_s) const;

  Scenario scenario_;
  Drive pressures_, tensions_, angles_;
};

/// 0 before 0, 1 after 1, with continuous velocity and acceleration.
double smooth_ramp(double x);

}  // namespace softarm::rig
