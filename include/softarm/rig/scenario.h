// What the virtual rig is to do: the arm's true constants, its mounting, the protocol, the sensors, the seed.
//
// The rig has its own description of an arm: it shares nothing with the model that is tested on its data.
// SI units throughout; pressures are gauge (Pa above ambient), vacuum is Pa below ambient.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace softarm::rig {

/// A scenario that cannot be used. what() is one line: source, key, value, allowed range.
class ScenarioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One pneumatic chamber along the whole arm.
struct ChamberSpec {
  double direction_rad = 0.0;             ///< azimuth towards which the arm bends when it is inflated
  double moment_gain_nm_per_pa = 0.0;     ///< c_i of the semi-physical paper
  double near_elongation_m_per_pa = 0.0;  ///< a_1, a_3, a_5
  double far_elongation_m_per_pa = 0.0;   ///< a_2, a_4, a_6
};

/// The true arm.
struct ArmSpec {
  double length_m = 0.2;  ///< backbone at zero pressure
  double mass_kg = 0.2;   ///< evenly distributed, conserved when the length changes
  double tip_mass_kg = 0.0;
  double diameter_m = 0.04;                       ///< of the disc-like sections: gives their rotary inertia
  double stiffness_base_nm2 = 0.03;               ///< b1
  double stiffness_per_min_nm2_per_pa = 0.0;      ///< b2
  double stiffness_per_jamming_nm2_per_pa = 0.0;  ///< b3
  double torsional_stiffness_nm2 = 0.03;
  double retardation_s = 0.02;  ///< Kelvin-Voigt: moment = stiffness * (curvature + retardation * its rate)
  double air_damping_n_s_m2 = 0.05;  ///< drag per length and velocity
  std::vector<ChamberSpec> chambers;
};

/// The clamp, fixed in the mocap frame. The rod's z axis is its tangent at the base, x the direction phi = 0.
struct MountSpec {
  Eigen::Vector3d p_mocap_base{0.0, 0.0, 1.0};
  Eigen::Quaterniond q_mocap_base = Eigen::Quaterniond::Identity();
};

/// Smooth random pressures: sums of sinusoids of random frequency and phase, squashed between two limits.
struct RandomPressures {
  double min_pa = 0.0;
  double max_pa = 50e3;
  double lowest_hz = 0.02;
  double highest_hz = 0.12;
  int sinusoids = 6;
};

/// A value that holds from a time on; changes take the schedule's ramp, smoothly.
struct Setpoint {
  double t_s = 0.0;
  std::vector<double> values;  ///< one per chamber; one alone for payload (kg) and vacuum (Pa)
};

struct PressureSpec {
  double rate_hz = 50.0;  ///< of the messages
  double ambient_pa = 101325.0;
  double rest_pa = 0.0;   ///< at the start and, in a trial that ends, at the end
  double settle_s = 1.0;  ///< at rest before the first and after the last ramp
  double ramp_s = 2.0;    ///< from rest to the protocol and back, and between setpoints
  std::optional<RandomPressures> random;
  std::vector<Setpoint> schedule;  ///< used where random is absent
};

/// Vacuum of the jamming chamber; empty schedule: the arm has none and nothing is published.
struct VacuumSpec {
  double ramp_s = 0.5;
  std::vector<Setpoint> schedule;
};

struct PayloadSpec {
  double ramp_s = 0.2;    ///< the weight is taken over smoothly
  double steady_s = 0.8;  ///< for this long after a change began a hand damps the tip, then it lets go
  double hand_damping_n_s_m = 4.0;
  double repeat_s = 0.0;  ///< period of the schedule; 0: it runs once
  bool publish = true;    ///< whether the payload is made known
  std::vector<Setpoint> schedule;
};

/// Gaussian noise of one body's measured pose.
struct PoseNoise {
  double position_sd_m = 0.0;       ///< per coordinate
  double orientation_sd_rad = 0.0;  ///< per axis of a small rotation
};

struct MocapSpec {
  double rate_hz = 120.0;
  std::vector<double> ring_fractions{0.25, 0.5, 0.75, 1.0};  ///< of the length, from base to tip
  PoseNoise ring_noise{0.5e-3, 0.01};
  bool base_measured = true;
  PoseNoise base_noise{0.05e-3, 0.0005};
  double dropout_probability = 0.0;  ///< that a body is lost in a frame
};

/// Numerics: see ritz_rod.h.
struct NumericsSpec {
  int elements = 6;                 ///< cubic spline elements along the arm
  double max_step_s = 1.0 / 480.0;  ///< of the time integration
};

struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  double duration_s = 0.0;        ///< 0: endless (only live)
  double gravity_m_s2 = 9.80665;  ///< along -z of the mocap frame
  ArmSpec arm;
  MountSpec mount;
  PressureSpec pressures;
  VacuumSpec vacuum;
  PayloadSpec payload;
  MocapSpec mocap;
  NumericsSpec numerics;
};

/// Parses a scenario's YAML. Keys carry their units (`rest_pa`); unknown keys are refused, missing ones get
/// the defaults above except format, name, arm.length_m, arm.mass_kg, arm.bending_stiffness.base_nm2 and
/// arm.chambers; arm.torsional_stiffness_nm2 defaults to b1.
/// @param source name of the document for messages
/// @throws ScenarioError
Scenario parse_scenario(const std::string& text, const std::string& source);

}  // namespace softarm::rig
