// Where an arm's measurements come from: topics, types, units, axes and stamps.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace softarm::arm {

/// A marker that the driver reports under a label.
struct LabelledMarker {
  std::string label;
  std::optional<Eigen::Vector3d> p_body;  ///< where it sits in its body's frame, m
};

enum class PressureReference { kAbsolute, kGauge };

/// Whose stamp says when a sample was taken.
enum class StampSource {
  kHeader,   ///< the header; of pressures and markers without one, or with zero: receipt
  kReceipt,  ///< the receipt of the message (of bags: the time of the record)
  kServer,   ///< bodies only: the motion capture's own time, which each marker carries
};

enum class InputKind {
  kPressure,  ///< of a chamber; used as gauge Pa
  kVacuum,    ///< of a jamming core; used as Pa below ambient (>= 0 when jammed)
  kTension,   ///< of a tendon, N
  kAngle,     ///< of a servo, rad
};

/// What an input was between two of its samples.
enum class Between {
  kSampled,  ///< a sensor: straight lines between samples that follow one another
  kHeld,     ///< a command that is latched: the last value
};

/// One scalar input and where it comes from.
struct ScalarInput {
  std::string name;  ///< referred to by chambers, jamming, tendons and cables
  InputKind kind = InputKind::kPressure;
  std::string topic;  ///< ROS topic
  /// sensor_msgs/FluidPressure | std_msgs/Float64 | ...Float32MultiArray | ...Float64MultiArray, or any other
  /// with a field
  std::string type;
  int element = 0;    ///< index in an array message
  std::string field;  ///< of a message of any other type: "chambers[2].pressure"; empty for the types above
  StampSource stamp = StampSource::kHeader;
  double scale_to_si = 1.0;  ///< from the configured unit
  double zero_si = 0.0;  ///< subtracted from tensions and angles: the reading at which the arm is not driven
  PressureReference reference = PressureReference::kAbsolute;  ///< of pressures
  double latency_s = 0.0;  ///< stamp minus the instant that it means: delay and what its clock is ahead
  std::optional<Between> between;  ///< absent: what the rhythm of its samples says
};

/// Where poses or points of bodies come from, and what turns them into metres in the mocap frame.
struct BodySource {
  std::string topic = "/mocap/<body>/pose";  ///< `<body>` is replaced by the body's name
  std::string type = "geometry_msgs/PoseStamped";
  double scale_to_m = 1.0;
  /// The driver's axes to the mocap frame's: a permutation with signs; a determinant of -1 undoes a
  /// mirroring.
  Eigen::Matrix3d mocap_from_driver = Eigen::Matrix3d::Identity();
  std::string frame;                   ///< frame_id that is read, others are rejected; empty: any
  std::string child_frame = "<body>";  ///< tf: the body's frame, without a leading slash
  StampSource stamp = StampSource::kHeader;
  bool labelled = true;               ///< false: points without identity, associated by PointAssociator
  double marker_tolerance_m = 0.005;  ///< rms misfit of labelled markers to where they sit on their body
};

/// Topic, type and unit of everything the node listens to.
struct Inputs {
  BodySource bodies;
  std::optional<BodySource> base;    ///< of the base's body, where it comes another way
  std::vector<ScalarInput> scalars;  ///< pressures, then tensions, then angles
  double ambient_pressure_pa = 101325.0;
  std::string payload_topic = "/payload";
  double body_sync_tolerance_s = 0.002;  ///< stamps closer than this belong to one frame
  double body_latency_s = 0.0;           ///< of all bodies: stamp minus the instant of exposure
  double input_max_age_s = 0.5;          ///< an older pressure, tension or angle is missing
};

}  // namespace softarm::arm
