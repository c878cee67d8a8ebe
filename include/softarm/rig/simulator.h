// The virtual rig: a moving arm and what its sensors see, one mocap frame at a time.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "softarm/rig/scenario.h"

namespace softarm::rig {

/// The equations of motion could not be solved; what() says when.
class SimulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

/// One pressure message.
struct PressureSample {
  double stamp_s = 0.0;
  int chamber = 0;  ///< from 0 in the order of ArmSpec::chambers; kVacuum for the jamming chamber
  double absolute_pa = 0.0;
  static constexpr int kVacuum = -1;
};

/// The payload became known.
struct PayloadSample {
  double stamp_s = 0.0;
  double kg = 0.0;
};

/// What really happened at a frame's stamp. Not for the estimator: goes to a separate file.
struct Truth {
  double stamp_s = 0.0;
  Eigen::Vector2d moment_nm =
      Eigen::Vector2d::Zero();  ///< (M0 cos phi, M0 sin phi), phi the bending direction
  double bending_stiffness_nm2 = 0.0;
  double length_m = 0.0;
  double payload_kg = 0.0;           ///< what hangs at the tip, in the middle of a change too
  bool payload_steadied = false;     ///< a hand is at the tip: no free arm
  std::vector<double> pressures_pa;  ///< gauge
  double vacuum_pa = 0.0;
  std::vector<Pose> rings_base;                ///< in the rod's base frame; z axis along the tangent
  std::vector<Eigen::Vector3d> backbone_base;  ///< at equal fractions of the length, base and tip included
  Pose tip_base;
  double tip_angle_rad = 0.0;  ///< between the tangents at base and tip
  double energy_j = 0.0;       ///< kinetic + elastic + gravity - work of the actuation moment
};

/// Everything that was measured up to and at one mocap frame, and the truth at its stamp.
struct Sample {
  double stamp_s = 0.0;
  /// Poses in the mocap frame in the order of Simulator::body_names(); absent: the body was lost.
  std::vector<std::optional<Pose>> bodies;
  /// Messages since the last frame, ordered by stamp (> last frame's, <= this one's).
  std::vector<PressureSample> pressures;
  std::optional<PayloadSample>
      payload;  ///< present in the first frame and when it changed, if published at all
  Truth truth;
};

/// Runs a scenario. Deterministic: the same scenario gives the same samples; no clock, no files.
///
/// Stamps start at 0; whoever publishes or records adds their epoch.
class Simulator {
 public:
  /// Starts at rest, in static equilibrium with the inputs of t = 0.
  /// @throws SimulationError if there is no such equilibrium to be found
  explicit Simulator(const Scenario& scenario);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  /// The next mocap frame: k / rate_hz for k = 0, 1, ...; nothing once duration_s is passed.
  /// @throws SimulationError
  std::optional<Sample> next();

  /// Frames that next() will give in all; absent for an endless scenario.
  std::optional<std::size_t> frame_count() const;

  /// "base" (if measured), "ring_1" ... "ring_N".
  const std::vector<std::string>& body_names() const;
  const Scenario& scenario() const;

  /// Bodies lost so far.
  std::size_t dropouts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::rig
