// What is hidden in the sensors: motion capture, sensors of the inputs, clocks, transport. All lists empty:
// mocap has its white noise and independent dropouts (MocapSpec), the inputs' messages carry what is
// commanded, and everything is received at its stamp.
//
// Bodies are numbered 0: `base`, 1: `ring_1` ...; inputs from 0, each of its kind. kAll: all of them, each
// with random numbers of its own.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace softarm::rig {

constexpr int kAll = -1;

enum class InputKind { kChamber, kVacuum, kTendon, kServo };

/// Gaussian noise of one body's measured pose.
struct PoseNoise {
  double position_sd_m = 0.0;       ///< per coordinate
  double orientation_sd_rad = 0.0;  ///< per axis of a small rotation
};

/// When a fault is there: for so long from a time on, and again every so often.
struct FaultTimes {
  double from_s = 0.0;
  double for_s = 0.0;
  double repeat_s = 0.0;  ///< 0: once

  bool has(double t_s) const {
    const double since_s = t_s - from_s;
    return since_s >= 0.0 && (repeat_s > 0.0 ? std::fmod(since_s, repeat_s) : since_s) < for_s;
  }
};

/// First-order Gauss-Markov: each number forgets itself as exp(-t / correlation_s).
struct CorrelatedNoise {
  int body = kAll;
  PoseNoise sd;
  double correlation_s = 1.0;
};

/// A constant error of a body's pose, in the body's own frame: its markers are not where the software has
/// them.
struct MarkerBias {
  int body = kAll;
  PoseNoise drawn;  ///< one draw per body
  Eigen::Vector3d given_m = Eigen::Vector3d::Zero();
};

/// A ring slid along the arm, or was pushed to its side; the base's cluster of markers likewise.
struct MarkerSlip {
  int body = 1;
  double along_m = 0.0;  ///< of the backbone at rest, towards the tip; beyond an end along the tangent there
  double sideways_m = 0.0, direction_rad = 0.0;  ///< in the body's xy plane, from its x axis
  double from_s = 0.0;
};

/// A ring on a soft or loose mount: gives way across the arm to the apparent weight (gravity less
/// acceleration), the more the more of it is across.
struct WobblingRing {
  int body = kAll;
  double tilt_rad_per_g = 0.0;  ///< of its z axis towards the apparent weight
  double shift_m_per_g = 0.0;
  double lag_s = 0.0;  ///< first order
};

/// The cameras were bumped: all poses shift and turn, about the origin of the mocap frame.
struct BumpedCameras {
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();  ///< rotation vector
  double from_s = 0.0;
};

/// The mocap's lengths are too long by a share, about its origin.
struct CameraScale {
  double share = 0.0;
  double height_ratio = 1.0;  ///< of heights, over that of ways along the floor
  /// The cameras warm up: nothing at first, and the share with this time constant, of the session; 0: always.
  double warms_s = 0.0;
};

/// The mocap's lenses are not quite as calibrated.
struct CameraBow {
  enum class Form {
    /// Cameras stand in a ring about the mocap origin and look at its middle. Each sees a direction off by a
    /// cubic of its angle from where it looks, and what is measured is the point nearest to what all see.
    kLenses,
    /// Distances r from the mocap origin are too long by a share of r^2 / (1 + r^2 / R^2), which fades
    /// outwards, where the calibration had more views.
    kFading
  };
  Form form = Form::kLenses;
  double off = 0.0;  ///< of the tangent of the angle, at 45 degrees; fading: share at 1 m if R were large
  double ring_m = 3.0, height_m = 2.5;  ///< of the cameras: from the upright axis, above the origin
  int cameras = 8;
  double fades_m = 1.5;  ///< R
};

/// A body that sits on the skin, which slides as the arm bends.
struct SkinMarker {
  enum class Form {
    /// A sleeve around the arm: shifts across, to the inside of the bend, in proportion to the curvature up
    /// to one, and tilts with it.
    kSleeve,
    /// A patch glued to one side: slides along the arm with the strain of that side, a mean over its length.
    kPatch
  };
  Form form = Form::kSleeve;
  int body = kAll;
  double way_m2 = 0.0;           ///< over the curvature
  double saturates_per_m = 1e6;  ///< curvature of a sleeve, at which it shifts half of that
  double tilt_rad_m = 0.0;       ///< over the curvature, of a sleeve
  double side_rad = 0.0;         ///< of a patch, from the section's x
  double patch_m = 0.02;         ///< length of a patch
};

/// A body is wrong in single frames.
struct Jumps {
  int body = kAll;
  double probability = 0.0;             ///< in a frame
  double size_m = 0.0, turn_rad = 0.0;  ///< exactly so far, each in a random direction
};

/// A body is lost for stretches of random length: a Markov chain of two states.
struct DropoutBursts {
  int body = kAll;
  double share = 0.0;          ///< of all frames, up to 0.5
  double mean_length_s = 0.1;  ///< at least a frame
};

/// A ring is lost while its tangent is bent too far from the base's.
struct Occlusion {
  int body = kAll;
  double beyond_rad = 0.0;
  double towards_rad = 0.0, within_rad = 0.0;  ///< bent in this direction of the base frame, give or take
};

struct FrozenBody {
  int body = kAll;
  FaultTimes times;
};

struct FlippedBody {
  int body = kAll;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of the body; zero: q becomes -q, the same orientation
  FaultTimes times;
};

struct SwappedBodies {
  int first = 1, second = 2;
  FaultTimes times;
};

enum class MessageStream { kMocap, kInputs };

/// Messages are received later than they are stamped, in their order.
struct Latency {
  MessageStream stream = MessageStream::kMocap;
  double delay_s = 0.0;
  double jitter_s = 0.0;  ///< mean of an exponentially distributed delay on top
};

/// Stamps wander about the time they mean, no further than three standard deviations, and never go back.
struct StampJitter {
  MessageStream stream = MessageStream::kMocap;
  double sd_s = 0.0;
};

/// The clock that stamps the mocap frames less that of the inputs and of receipt.
struct ClockOffset {
  double offset_s = 0.0;       ///< at the start
  double drift = 0.0;          ///< s per s of the scenario
  double session_drift = 0.0;  ///< s per s of the session, at whose start it is nothing
};

/// Nothing of a stream is sent.
struct Gap {
  MessageStream stream = MessageStream::kMocap;
  FaultTimes times;
};

/// A number of the sensors of some inputs, in the input's unit.
struct InputError {
  InputKind kind = InputKind::kChamber;
  int number = kAll;
  double size = 0.0;
};

/// A time for the sensors of some inputs.
struct InputFault {
  InputKind kind = InputKind::kChamber;
  int number = kAll;
  FaultTimes times;
};

struct SensorSpec {
  std::vector<CorrelatedNoise> correlated_noise;
  std::vector<MarkerBias> biases;
  std::vector<MarkerSlip> slips;
  std::vector<WobblingRing> wobbling;
  std::vector<BumpedCameras> bumps;
  std::vector<CameraScale> camera_scales;
  std::vector<CameraBow> camera_bows;
  std::vector<SkinMarker> skin_markers;
  std::vector<Jumps> jumps;
  std::vector<DropoutBursts> bursts;
  std::vector<Occlusion> occlusions;
  std::vector<FrozenBody> frozen;
  std::vector<FlippedBody> flipped;
  std::vector<SwappedBodies> swapped;

  std::vector<Latency> latencies;
  std::vector<StampJitter> stamp_jitters;
  ClockOffset mocap_clock;
  std::vector<InputError> input_clocks;  ///< s by which the clock that stamps an input is ahead of receipt's
  double duplicate_probability = 0.0;    ///< that a mocap frame is sent twice
  std::vector<Gap> gaps;

  /// What a sensor publishes: gauge value * (1 + gain) + offset + noise, rounded to the step; pressures below
  /// ambient (vacuum) are negative.
  std::vector<InputError> input_gains, input_offsets, input_noises, input_steps;
  std::vector<InputFault> input_stuck;  ///< repeats the value before
  std::vector<InputFault> input_dead;   ///< publishes nothing
};

}  // namespace softarm::rig
