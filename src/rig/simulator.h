// The virtual rig: a moving arm and what its sensors see, one mocap frame at a time.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenario.h"

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

/// One message of an input.
struct InputSample {
  double stamp_s = 0.0;
  InputKind kind = InputKind::kChamber;
  int number = 0;          ///< from 0, of its kind; 0 for the vacuum
  double value = 0.0;      ///< commanded, with the errors of its sensor if it has any: absolute Pa, N, rad
  double receipt_s = 0.0;  ///< when it arrives; a message without a header has only this time
};

/// Topic on which an input is published: /pressure/chamber_1 ..., /pressure/vacuum, /tendon/1/tension ...,
/// /servo/1/angle ...
std::string topic_of(InputKind kind, int number);

/// The payload became known, and its message arrived.
struct PayloadSample {
  double stamp_s = 0.0;
  double kg = 0.0;
};

/// What a segment of the arm was.
struct SegmentTruth {
  /// (M0 cos phi, M0 sin phi) of all its actuation, phi the bending direction; cables by EI * curvature.
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  double bending_stiffness_nm2 = 0.0;
  double length_m = 0.0;  ///< without load
};

/// What really happened at a frame's stamp. Not for the estimator: goes to a separate file.
struct Truth {
  double stamp_s = 0.0;
  std::vector<SegmentTruth> segments;
  double payload_kg = 0.0;                     ///< what hangs on the arm, in the middle of a change too
  bool payload_steadied = false;               ///< a hand is at the payload: no free arm
  std::vector<double> pressures_pa;            ///< commanded, gauge
  std::vector<double> tensions_n, angles_rad;  ///< commanded
  double vacuum_pa = 0.0;
  std::vector<Pose> rings_base;                ///< in the rod's base frame; z axis along the tangent
  std::vector<Eigen::Vector3d> backbone_base;  ///< at equal arclengths, base and tip included
  Pose tip_base;
  double tip_angle_rad = 0.0;  ///< between the tangents at base and tip
  double energy_j = 0.0;       ///< kinetic + elastic + gravity - work of the actuation moment
};

/// Everything that was measured up to and at one mocap frame, and the truth at its time. To have the messages
/// in the order in which they arrive: ReceiptQueue.
struct Sample {
  double stamp_s = 0.0;  ///< the time of the frame: what an ideal clock would stamp
  /// Poses in the mocap frame in the order of Simulator::body_names(); absent: the body was lost.
  std::vector<std::optional<Pose>> bodies;
  double mocap_stamp_s = 0.0;    ///< what the messages of the bodies say
  double mocap_receipt_s = 0.0;  ///< when they arrive
  int mocap_copies = 1;          ///< how often
  /// Messages sent since the last frame (after it, up to this one), in the order of receipt.
  std::vector<InputSample> inputs;
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

  /// "base" (if measured), "ring_1" ... "ring_N", or as the scenario calls them.
  const std::vector<std::string>& body_names() const;
  const Scenario& scenario() const;

  /// Bodies lost so far.
  std::size_t dropouts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::rig
