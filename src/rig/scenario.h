// What the virtual rig is to do: the arm's true constants, its mounting, the protocol, the sensors, the seed.
//
// The rig has its own description of an arm: it shares nothing with the model that is tested on its data.
// SI units throughout; pressures are gauge (Pa above ambient), vacuum is Pa below ambient.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "body_spec.h"
#include "hidden.h"
#include "input_path_spec.h"
#include "programme_spec.h"
#include "sensor_spec.h"

namespace softarm::rig {

/// A scenario that cannot be used. what() is one line: source, key, value, allowed range.
class ScenarioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One pneumatic chamber along its segment.
struct ChamberSpec {
  int input = 0;                             ///< number of the pressure, from 0 (chamber_1)
  double direction_rad = 0.0;                ///< azimuth towards which the arm bends when it is inflated
  double moment_gain_nm_per_pa = 0.0;        ///< c_i of the semi-physical paper
  double near_elongation_m_per_pa = 0.0;     ///< a_1, a_3, a_5
  double far_elongation_m_per_pa = 0.0;      ///< a_2, a_4, a_6
  std::optional<double> saturation_pa = {};  ///< see SaturationSpec
};

/// A chamber on the axis: pulls the wall with pressure times area and does not bend it.
struct CentralChamberSpec {
  int input = 0;  ///< number of the pressure, from 0
  double area_m2 = 0.0;
};

/// A straight tendon through the whole segment at an offset from the axis: ends at the segment's end or,
/// where the next segment has it too, passes on.
struct TendonSpec {
  int input = 0;  ///< number of the tension, from 0 (tendon_1)
  double azimuth_rad = 0.0;
  double offset_m = 0.0;
  std::optional<double> saturation_n = {};  ///< see SaturationSpec
};

/// A cable from the segment's end to a servo's spool. Unloaded, the segment's curvature is that which takes
/// up the cable wound: spool radius * angle / (length * lever) (cable paper, (4), (5) and (15)).
struct CableSpec {
  int input = 0;  ///< number of the angle, from 0 (servo_1)
  double azimuth_rad = 0.0;
  double lever_m = 0.0;
  double spool_radius_m = 0.0;
  std::optional<double> saturation_rad = {};  ///< see SaturationSpec
};

/// Actuators that do less the more they do already. With x the input of one and z = x / its own saturation +
/// sum of all of its kind in the segment / the common one, it acts as by x (1 - e^-z) / z (exponential) or x
/// / (1 + z) (hyperbolic). Both grow with x, the former to a limit sooner.
struct SaturationSpec {
  bool exponential = true;
  std::optional<double> chambers_pa, tendons_n, cables_rad;  ///< the common ones; absent: none
};

/// EI grows by `added_nm2` (x / at)^exponent.
struct StiffnessGrowth {
  enum class Of { kPressures, kTensions, kAngles };
  /// x: the mean of the segment's pressures, the sum of its tensions or of its angles' sizes; the lowest of
  /// them; or that of one input alone.
  enum class By { kTogether, kLowest, kOne };
  Of of = Of::kPressures;
  By by = By::kTogether;
  int input = 0;  ///< of the one, from 0
  double added_nm2 = 0.0, at = 1.0, exponent = 1.0;
};

/// A wall that creeps: shares of the moment and of the length that drive a segment come late. A share has a
/// whole spectrum of times, log-normal about `time_s`, as fabrics and rubbers have.
struct CreepSpec {
  struct Part {
    double time_s = 1.0, share = 0.0;
    double decades = 0.3;  ///< standard deviation of the decimal logarithm of the times
  };
  std::vector<Part> moment, length;
  /// Mean gauge pressures at which the times are e times as long, and at which what would come at once is
  /// down to its power of two; absent: pressure changes nothing.
  std::optional<double> slows_pa, grows_pa;
  /// At the beginning of the recording, beyond what drives it then.
  Eigen::Vector2d before_moment_nm = Eigen::Vector2d::Zero();
  double before_length_m = 0.0;
};

/// A joint where a segment begins, which gives way: its first stretch, that short, bends under loads by their
/// moment over this more. What drives the segment bends it there as everywhere.
struct JointSpec {
  double stiffness_nm_per_rad = 1.0;  ///< where EI is stiffness_base_nm2; in proportion where it is not
  double length_m = 0.004;
};

/// Two-term Mooney-Rivlin rubber. Only the ratio of its constants matters: the stiffnesses are given.
struct MaterialSpec {
  double c10_pa = 0.0;
  double c01_pa = 0.0;
};

/// A bending stiffness measured at a pressure of the central chamber.
struct StiffnessAtPressure {
  double pressure_pa = 0.0;
  double bending_stiffness_nm2 = 0.0;
};

/// One segment of the true arm.
struct SegmentSpec {
  double length_m = 0.2;                          ///< of the backbone at zero input
  double mass_kg = 0.2;                           ///< evenly distributed, conserved when the length changes
  double diameter_m = 0.04;                       ///< of the disc-like sections: gives their rotary inertia
  double stiffness_base_nm2 = 0.03;               ///< b1
  double stiffness_per_min_nm2_per_pa = 0.0;      ///< b2
  double stiffness_per_jamming_nm2_per_pa = 0.0;  ///< b3
  std::vector<StiffnessGrowth> stiffness_growth;
  SaturationSpec saturation;
  CreepSpec creep;
  std::optional<JointSpec> joint;
  std::vector<StiffnessAtPressure> stiffness_by_pressure;  ///< replaces b1 and the material's stiffening
  double torsional_stiffness_nm2 = 0.03;
  std::optional<double> axial_stiffness_n;  ///< EA of the unstretched wall; absent: rigid
  std::optional<double> shear_stiffness_n;  ///< GA; absent: rigid
  std::optional<MaterialSpec> material;     ///< absent: linear
  double retardation_s = 0.02;  ///< Kelvin-Voigt: moment = stiffness * (curvature + retardation * its rate)
  std::vector<ChamberSpec> chambers;
  std::optional<CentralChamberSpec> central_chamber;
  std::vector<TendonSpec> tendons;
  std::vector<CableSpec> cables;
};

/// The true arm.
struct ArmSpec {
  std::vector<SegmentSpec> segments;  ///< from base to tip
  double tip_mass_kg = 0.0;
  double air_damping_n_s_m2 = 0.05;  ///< drag per length and velocity
  /// Numbers of pressures, tensions and servo angles that the segments take.
  int chambers = 0, tendons = 0, servos = 0;

  double length_m() const {
    double sum = 0.0;
    for (const SegmentSpec& segment : segments) sum += segment.length_m;
    return sum;
  }
};

/// The clamp, fixed in the mocap frame. The rod's z axis is its tangent at the base, x the direction phi = 0.
struct MountSpec {
  Eigen::Vector3d p_mocap_base{0.0, 0.0, 1.0};
  Eigen::Quaterniond q_mocap_base = Eigen::Quaterniond::Identity();
};

/// Smooth random inputs: sums of sinusoids of random frequency and phase, squashed between two limits.
struct RandomDrive {
  std::vector<double> min, max;  ///< per input
  double lowest_hz = 0.02;
  double highest_hz = 0.12;
  int sinusoids = 6;
};

/// A value that holds from a time on; changes take the schedule's ramp, smoothly.
struct Setpoint {
  double t_s = 0.0;
  std::vector<double> values;         ///< one per input; one alone for payload (kg) and vacuum (Pa)
  std::optional<double> over_s = {};  ///< its own ramp; absent: the schedule's

  double end_s(double ramp_s) const { return t_s + over_s.value_or(ramp_s); }
};

/// What is done to all inputs of a kind, in its unit: gauge Pa, N or rad.
struct DriveSpec {
  double rate_hz = 50.0;  ///< of the messages
  double rest = 0.0;      ///< at the start and, in a trial that ends, at the end
  double settle_s = 1.0;  ///< at rest before the first and after the last ramp
  double ramp_s = 2.0;    ///< from rest to the protocol and back, and between setpoints
  std::optional<RandomDrive> random;
  std::vector<Setpoint> schedule;  ///< used where random is absent
  double repeat_s = 0.0;           ///< period of the schedule; 0: it runs once
  Programme programme;             ///< instead of random, schedule and steps
  double step_ramp_s = 0.05;
  std::vector<Setpoint> steps;                               ///< added to the above, with a ramp of their own
  double lowest = -std::numeric_limits<double>::infinity();  ///< that steps can bring an input to
};

struct PressureSpec : DriveSpec {
  double ambient_pa = 101325.0;
};

/// Vacuum of the jamming chamber; empty schedule: the arm has none and nothing is published.
struct VacuumSpec {
  double ramp_s = 0.5;
  std::vector<Setpoint> schedule;
};

struct PayloadSpec {
  double fraction = 1.0;  ///< where it hangs, of the arm's length at zero input; 1: the tip
  double ramp_s = 0.2;    ///< the weight is taken over smoothly
  double steady_s = 0.8;  ///< for this long after a change began a hand damps its place, then it lets go
  double hand_damping_n_s_m = 4.0;
  double repeat_s = 0.0;  ///< period of the schedule; 0: it runs once
  bool publish = true;    ///< whether the payload is made known
  std::vector<Setpoint> schedule;
};

/// What the cameras know as a body: its name, and its frame in that of the section that carries it (x:
/// azimuth 0, z: tangent), or in the clamp's.
struct TrackedBody {
  std::string name;
  Eigen::Vector3d p_section = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_section = Eigen::Quaterniond::Identity();
};

struct MocapSpec {
  double rate_hz = 120.0;
  std::vector<double> ring_fractions{0.25, 0.5, 0.75, 1.0};  ///< of the length at zero input
  std::vector<TrackedBody> rings;  ///< one for each; empty: ring_1 ..., centred on the backbone
  PoseNoise ring_noise{0.5e-3, 0.01};
  bool base_measured = true;
  TrackedBody base{"base"};
  PoseNoise base_noise{0.05e-3, 0.0005};
  double dropout_probability = 0.0;  ///< that a body is lost in a frame
};

/// Numerics: see ritz_rod.h.
struct NumericsSpec {
  int elements = 3;                 ///< cubic spline elements along each segment
  double max_step_s = 1.0 / 360.0;  ///< of the time integration
};

struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  double duration_s = 0.0;  ///< 0: endless (only live)
  double session_s = 0.0;   ///< time of the session at which it begins: of its stamps, drifts and warmth
  double gravity_m_s2 = 9.80665;  ///< along -z of the mocap frame
  ArmSpec arm;
  MountSpec mount;
  PressureSpec pressures;
  DriveSpec tensions;  ///< N
  DriveSpec angles;    ///< of the servos, rad
  VacuumSpec vacuum;
  PayloadSpec payload;
  MocapSpec mocap;
  NumericsSpec numerics;
  /// What hide() put into the three specs below, in its order.
  std::vector<HiddenChoice> hidden;
  BodySpec body;
  InputPathSpec input_path;
  SensorSpec sensors;
};

/// Parses a scenario's YAML. Keys carry their units (`rest_pa`); unknown keys are refused, missing ones get
/// the defaults above except format, name, length_m, mass_kg and bending_stiffness.base_nm2 of each segment;
/// torsional_stiffness_nm2 defaults to b1. `arm.segments` lists segments; the keys of a single one may stand
/// in `arm` itself. Chambers without `input` are numbered in their order.
/// @param source name of the document for messages
/// @throws ScenarioError
Scenario parse_scenario(const std::string& text, const std::string& source);

}  // namespace softarm::rig
