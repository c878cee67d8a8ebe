// What an arm is: the immutable description that every other room reads.
//
// SI units throughout. The rod's base frame has its origin at s = 0 and its z axis along the backbone's
// tangent there; x is the bending direction phi = 0. Pressures are gauge (Pa above ambient).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace softarm {

/// Bending stiffness of a segment from its pressures, equation (9) of the semi-physical paper:
/// EI = base + per_min_pressure * min(P_i) + per_jamming_pressure * (V + mean(P_i)), with P_i the gauge
/// pressures of the segment's chambers and V >= 0 the vacuum below ambient.
struct StiffnessLaw {
  double base_nm2 = 0.03;                      ///< b1, N m^2
  double per_min_pressure_nm2_per_pa = 0.0;    ///< b2, N m^2 / Pa
  double per_jamming_pressure_nm2_per_pa = 0;  ///< b3, N m^2 / Pa
};

/// One pneumatic chamber running along a segment.
struct Chamber {
  std::string input;                    ///< name of the pressure input that feeds it
  double bending_direction_rad = 0.0;   ///< azimuth towards which the arm bends when it is inflated
  double moment_gain_nm_per_pa = 0.0;   ///< c_i: bending moment per gauge pressure
  double near_elongation_m_per_pa = 0;  ///< a_1, a_3, a_5: elongation at the chamber's own side
  double far_elongation_m_per_pa = 0;   ///< a_2, a_4, a_6: elongation opposite the chamber
};

/// A factor on the segment's stiffness at a fraction of its length (piecewise linear in between).
struct StiffnessKnot {
  double fraction = 0.0;  ///< s / length, 0 ... 1
  double factor = 1.0;    ///< EI(s) / EI, also applied to GJ
};

/// A closed range of values, used for sanity limits of estimated quantities.
struct Range {
  double low = 0.0;
  double high = 0.0;
};

/// One segment of the arm; segments are in series from base to tip.
struct Segment {
  std::string name;
  double length_m = 0.0;  ///< backbone length at zero input
  double mass_per_length_kg_m = 0.0;
  double diameter_m = 0.0;
  StiffnessLaw bending_stiffness;
  std::optional<double> torsional_stiffness_nm2;                   ///< GJ; absent: rigid
  std::optional<double> axial_stiffness_n;                         ///< EA; absent: rigid
  std::optional<double> shear_stiffness_n;                         ///< GA; absent: rigid
  std::vector<StiffnessKnot> stiffness_profile;                    ///< empty: uniform
  Eigen::Vector3d rest_curvature_per_m = Eigen::Vector3d::Zero();  ///< u* in the section frame, 1/m
  std::vector<Chamber> chambers;
  std::optional<std::string> jamming_input;  ///< name of the vacuum input of the jamming core
  Range bending_stiffness_range_nm2{1e-4, 10.0};
  Range length_range_m{0.0, 0.0};
};

/// How a measured body sits on the arm.
enum class BodyKind {
  kRing,        ///< rigid body or ring whose pose is that of the backbone at an arclength
  kSkinMarker,  ///< a single marker on the skin
};

/// A body the motion capture reports. Arclengths are those of the arm at zero input, measured from the base
/// over all segments; they stretch with the segments.
struct MeasuredBody {
  std::string name;
  BodyKind kind = BodyKind::kRing;
  double arclength_m = 0.0;
  bool orientation_usable = false;  ///< rings only: the tangent of the measured frame can be trusted
  double angle_rad = 0.0;           ///< skin markers: azimuth in the section frame
  double radius_m = 0.0;            ///< skin markers: distance from the backbone
  /// Pose of the backbone's section frame in the body's own frame (rings).
  Eigen::Isometry3d section_in_body = Eigen::Isometry3d::Identity();
  double position_sd_m = 0.0;       ///< standard deviation per coordinate
  double orientation_sd_rad = 0.0;  ///< standard deviation of the tangent per axis
};

/// Where the base of the rod is in the mocap frame.
struct Base {
  std::optional<std::string> body;  ///< body whose pose carries the base; absent: fixed
  Eigen::Isometry3d rod_in_body = Eigen::Isometry3d::Identity();  ///< rod base frame in the body's frame
  Eigen::Isometry3d fixed_pose = Eigen::Isometry3d::Identity();   ///< rod base in mocap, if no body
  bool hold_last = true;  ///< while the body is lost, keep its last pose (the mount does not move)
};

enum class PressureReference { kAbsolute, kGauge };

/// One scalar input (a chamber's pressure or the vacuum) and where it comes from.
struct PressureInput {
  std::string name;   ///< referred to by chambers and jamming
  std::string topic;  ///< ROS topic
  std::string
      type;  ///< sensor_msgs/FluidPressure | std_msgs/Float64 | ...Float32MultiArray | ...Float64MultiArray
  int element = 0;           ///< index in an array message
  double scale_to_pa = 1.0;  ///< from the configured unit
  PressureReference reference = PressureReference::kAbsolute;
  bool is_vacuum = false;  ///< value used is ambient - absolute (>= 0 when jammed)
};

/// Topic, type and unit of everything the node listens to.
struct Inputs {
  std::string body_topic = "/mocap/<body>/pose";  ///< <body> is replaced by the body's name
  std::string body_type = "geometry_msgs/PoseStamped";
  double body_scale_to_m = 1.0;
  std::vector<PressureInput> pressures;
  double ambient_pressure_pa = 101325.0;
  std::string payload_topic = "/payload";
  double body_sync_tolerance_s = 0.002;  ///< stamps closer than this belong to one frame
  double pressure_max_age_s = 0.5;       ///< an older pressure is missing
};

enum class Method { kFullPoints, kEndOrientation, kCcPoints, kCcEndpoint };
enum class Unknown { kStiffness, kPayload };
enum class Objective { kLeastSquares, kSumOfDistances };
enum class Weights { kNoise, kPaper };

/// Relative or absolute trust in the arm's pressure laws when they serve as a prior.
struct PressurePrior {
  bool enabled = false;
  double moment_sd_nm = 0.02;  ///< per component of the actuation moment
  double bending_stiffness_sd_rel = 0.2;
  double length_sd_m = 0.003;
};

/// Choices of the estimator; each can be overridden on the command line or by a node parameter.
struct EstimatorOptions {
  Method method = Method::kFullPoints;
  Unknown unknown = Unknown::kStiffness;
  Objective objective = Objective::kLeastSquares;
  std::optional<Weights> weights;   ///< absent: noise for least squares, the paper's for sum of distances
  bool robust = true;               ///< bound the influence of an outlying body and drop it
  double tells_relative_sd = 0.25;  ///< a parameter is told by a frame at this relative sd or better
  PressurePrior prior;
};

/// The point at which the payload hangs.
struct PayloadMount {
  double arclength_m = 0.0;                            ///< at zero input; default: the tip
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< centre of mass in the section frame
  std::optional<double> default_kg;  ///< assumed when no topic says otherwise; absent: unknown
  Range range_kg{0.0, 5.0};
};

/// An arm: geometry, material, actuation, what is measured and how it is estimated.
struct Arm {
  std::string name;
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.80665};  ///< in the mocap frame
  Base base;
  std::vector<Segment> segments;
  double tip_mass_kg = 0.0;
  PayloadMount payload;
  std::vector<MeasuredBody> bodies;  ///< from base to tip
  Inputs inputs;
  EstimatorOptions estimator;

  double total_length_m() const {
    double sum = 0.0;
    for (const Segment& s : segments) sum += s.length_m;
    return sum;
  }
};

}  // namespace softarm
