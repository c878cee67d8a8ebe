// What an arm is: the immutable description that every other room reads.
//
// SI units throughout. The rod's base frame has its origin at s = 0 and its z axis along the backbone's
// tangent there; x is the bending direction phi = 0. Pressures are gauge (Pa above ambient).
//
// What drives a segment, in any combination: pneumatic chambers off its axis (a moment each), a central
// chamber (axial tension of the wall), tendons pulled by known tensions (a moment and axial compression),
// cables wound up by servos (a curvature). laws.h says what they make of it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
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
  double zero_si = 0.0;      ///< subtracted from every value: the reading at which it does not drive the arm
  PressureReference reference = PressureReference::kAbsolute;  ///< of pressures
  double latency_s = 0.0;  ///< stamp minus the instant that it means: delay and what its clock is ahead
  std::optional<Between> between;     ///< absent: what the rhythm of its samples says
  std::optional<double> noise_sd_si;  ///< of one value; absent: as measured from the recording
  double zero_sd_si = 0.0;            ///< what zero_si may be off by, another in each trial; 0: it is right
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

/// A measured bending stiffness at a pressure of the central chamber.
struct PressureKnot {
  double pressure_pa = 0.0;  ///< gauge
  double bending_stiffness_nm2 = 0.0;
};

/// Bending stiffness of a segment from its pressures, equation (9) of the semi-physical paper:
/// EI = base + per_min_pressure * min(P_i) + per_jamming_pressure * (V + mean(P_i)), with P_i the gauge
/// pressures of the segment's chambers and V >= 0 the vacuum below ambient. Beyond the paper it may grow with
/// the mean pressure, with the sum or the lowest of the tensions or of the angles' sizes, and with each
/// actuator's own (stiffness_gain_... of Chamber, Tendon and Cable). Absent: as 0, and not to be identified
/// unless asked for.
struct StiffnessLaw {
  double base_nm2 = 0.03;                      ///< b1, N m^2
  double per_min_pressure_nm2_per_pa = 0.0;    ///< b2, N m^2 / Pa
  double per_jamming_pressure_nm2_per_pa = 0;  ///< b3, N m^2 / Pa
  /// EI identified at pressures of the central chamber (hybrid paper, Fig. 8): linear in between, constant
  /// beyond the ends, increasing pressures. Replaces the base and the material's stiffening where not empty.
  std::vector<PressureKnot> by_pressure = {};
  std::optional<double> per_mean_pressure_nm2_per_pa = {};
  std::optional<double> per_tension_nm2_per_n = {};
  std::optional<double> per_min_tension_nm2_per_n = {};
  std::optional<double> per_angle_nm2_per_rad = {};
  std::optional<double> per_min_angle_nm2_per_rad = {};
};

/// Two-term Mooney-Rivlin rubber (hybrid paper (13), single-chamber slides): gives how the moduli change with
/// the axial stretch that the actuation causes; their level is that of the segment's stiffnesses.
struct Material {
  double c10_pa = 0.0;
  double c01_pa = 0.0;
};

/// A chamber on the segment's axis: its pressure pulls the wall, P times area, without bending it.
struct CentralChamber {
  std::string input;
  double area_m2 = 0.0;
};

/// A straight tendon along the whole segment at a fixed offset from its axis, fixed at its end or passing
/// through to a distal segment (which then has it too). Pulls the segment together and bends it towards its
/// azimuth.
struct Tendon {
  std::string input;  ///< name of the tension input
  double bending_direction_rad = 0.0;
  double offset_m = 0.0;
  std::optional<double> saturation_per_n = {};          ///< see Saturation
  std::optional<double> stiffness_gain_nm2_per_n = {};  ///< EI per tension of this tendon
};

/// A cable wound up by a servo: a curvature proportional to the servo's angle (cable paper (4), (5), (15):
/// unloaded, a spool of radius r_s that turns by alpha shortens the cable by r_s alpha and bends the segment
/// to r_s alpha / (L (r + r_t))).
struct Cable {
  std::string input;  ///< name of the angle input
  double bending_direction_rad = 0.0;
  double curvature_gain_per_m_rad = 0.0;          ///< curvature per angle, r_s / (L (r + r_t)), 1 / (m rad)
  std::optional<double> saturation_per_rad = {};  ///< see Saturation
  std::optional<double> stiffness_gain_nm2_per_rad = {};  ///< EI per size of this cable's angle
};

/// One pneumatic chamber running along a segment.
struct Chamber {
  std::string input;                             ///< name of the pressure input that feeds it
  double bending_direction_rad = 0.0;            ///< azimuth towards which the arm bends when it is inflated
  double moment_gain_nm_per_pa = 0.0;            ///< c_i: bending moment per gauge pressure
  double near_elongation_m_per_pa = 0;           ///< a_1, a_3, a_5: elongation at the chamber's own side
  double far_elongation_m_per_pa = 0;            ///< a_2, a_4, a_6: elongation opposite the chamber
  std::optional<double> saturation_per_pa = {};  ///< see Saturation
  std::optional<double> stiffness_gain_nm2_per_pa = {};  ///< EI per gauge pressure of this chamber
};

/// Actuation that falls behind its input: what input i does is divided by
///   1 + a_i |x_i| + b sum_j |x_j|,
/// a_i of the chamber, tendon or cable, b of all of a segment's together; |x| is 0 for pressures and tensions
/// below zero. It grows with its own input everywhere, and keeps its sign. Absent: as 0, proportional, and
/// not to be identified unless asked for.
struct Saturation {
  std::optional<double> chambers_per_pa, tendons_per_n, cables_per_rad;  ///< b
};

/// One Kelvin-Voigt element of a segment's wall.
struct WallElement {
  double time_s = 1.0;  ///< time constant without pressure
  double share = 0.0;   ///< of what the static laws say, that comes with this time; without pressure
};

/// A viscoelastic wall: of the curvature and length that the static laws give for the inputs, shares come
/// late. With u(t) what those laws say, curvature M0 / EI + that of cables, or length, an arm whose loads
/// are taken out has
///   u - sum_j share_j (u - w_j),  tau_j w_j' = u - w_j,
///   tau_j = time_j (1 + slows_per_pa * p), p the mean of the segment's gauge pressures above zero.
/// Shares grow with pressure so that what comes late stands to what comes at once as S / (1 - S) times
/// 1 + g p, S the sum of shares (of bending or axial ones) and g shares_grow_per_pa: each share_j is taken
/// (1 + g p) / (1 + S g p) times, and their sum stays below 1 at any pressure.
/// The laws thus mean what is reached when all has crept; at once comes 1 - sum_j share_j of it. What loads
/// make creep is not in it. A recording begins with w_j(0) = u(0) + an error of standard deviation
/// initial_..., which is forgotten with tau_j.
struct Wall {
  std::vector<WallElement> bending, axial;
  std::optional<double> slows_per_pa = {}, shares_grow_per_pa = {};
  std::optional<double> initial_curvature_sd_per_m = {};  ///< absent: see wall_start_sd()
  std::optional<double> initial_length_sd_m = {};
  /// Of the whole wall, under loads too, where motion is in a model: moment = EI (u + lag_s du/dt). Absent:
  /// kUsualLag_s.
  std::optional<double> lag_s = {};

  static constexpr double kUsualLag_s = 0.02;  ///< silicone
  /// Nothing that laws at rest remember.
  bool empty() const { return bending.empty() && axial.empty(); }
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
  Saturation saturation;
  std::optional<double> torsional_stiffness_nm2;  ///< GJ; absent: rigid
  std::optional<double> axial_stiffness_n;        ///< EA; absent: rigid
  std::optional<double> shear_stiffness_n;        ///< GA; absent: rigid
  /// Turn of the joint at the segment's start, where it meets the base or the segment before it, per bending
  /// moment that the joint bears, rad / (N m); absent: rigid.
  std::optional<double> joint_compliance_rad_per_nm;
  std::vector<StiffnessKnot> stiffness_profile;                    ///< empty: uniform
  Eigen::Vector3d rest_curvature_per_m = Eigen::Vector3d::Zero();  ///< u* in the section frame, 1/m
  std::vector<Chamber> chambers;
  std::optional<std::string> jamming_input;  ///< name of the vacuum input of the jamming core
  std::optional<CentralChamber> central_chamber;
  std::vector<Tendon> tendons;
  std::vector<Cable> cables;
  std::optional<Material> material;  ///< absent: linear, moduli do not change with stretch
  Wall wall;                         ///< empty: what the laws say comes at once
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
  /// Rings known by unlabelled points: how many its marker cluster, a circle, has; 1: one point.
  int markers = 1;
  double marker_cluster_radius_m = 0.0;  ///< of that circle, where there are several
  /// Labelled markers that make up a ring, for drivers that report markers: its position is their centroid,
  /// or, where all say where they sit (three or more), pose of the body that fits them best. Empty: the
  /// body's name is the label of its only marker.
  std::vector<LabelledMarker> labelled_markers;
  double position_sd_m = 0.0;       ///< standard deviation per coordinate
  double orientation_sd_rad = 0.0;  ///< standard deviation of the tangent per axis
  /// How well it is known where the body sits on the arm: the same in all frames, per coordinate and per
  /// axis.
  double placement_sd_m = 0.001;
  double placement_sd_rad = 0.5 * M_PI / 180.0;
};

/// Where the base of the rod is in the mocap frame.
struct Base {
  std::optional<std::string> body;  ///< body whose pose carries the base; absent: fixed
  Eigen::Isometry3d rod_in_body = Eigen::Isometry3d::Identity();  ///< rod base frame in the body's frame
  Eigen::Isometry3d fixed_pose = Eigen::Isometry3d::Identity();   ///< rod base in mocap, if no body
  std::vector<LabelledMarker> labelled_markers;  ///< that fix the body's pose, as for MeasuredBody
  bool hold_last = true;  ///< while the body is lost, keep its last pose (the mount does not move)
};

enum class Method { kFullPoints, kEndOrientation, kCcPoints, kCcEndpoint };
enum class Unknown { kStiffness, kPayload, kBoth };
enum class Objective { kLeastSquares, kSumOfDistances };
enum class Weights { kNoise, kPaper };
enum class Dynamics { kStatic, kModal };

/// Trust in the arm's laws when they serve as a prior. The laws' errors are of two parts: one that stays (a
/// gain, a zero; common to all frames of a window) and one that comes and goes from frame to frame (the
/// ..._jitter_...).
struct LawPrior {
  bool enabled = false;
  double moment_sd_nm = 0.02;  ///< per component of the actuation moment; of cables times EI
  double moment_sd_rel = 0.0;  ///< and as a share of the moment, added in squares
  double bending_stiffness_sd_rel = 0.2;
  double length_sd_m = 0.003;
  /// Of EA, where it is given: as a share of it. What a load stretches a segment by is as uncertain.
  double axial_stiffness_sd_rel = 0.5;
  double moment_jitter_sd_nm = 0.002;
  double length_jitter_sd_m = 0.0005;
};

/// Choices of the estimator; each can be overridden on the command line or by a node parameter.
struct EstimatorOptions {
  Method method = Method::kFullPoints;
  Unknown unknown = Unknown::kStiffness;
  Objective objective = Objective::kLeastSquares;
  std::optional<Weights> weights;  ///< absent: noise for least squares, the paper's for sum of distances
  bool robust = true;              ///< bound the influence of an outlying body and drop it
  double identifiable_relative_sd = 0.25;  ///< a parameter is identifiable in a frame at this relative sd
  LawPrior prior;
  /// Frames of this last time share bending stiffness and payload (and the lasting part of the laws' errors);
  /// 0: each frame by itself.
  double window_s = 0.0;
  /// modal: the arm is followed through its swings, and a frame's equilibrium is what is fitted.
  Dynamics dynamics = Dynamics::kStatic;
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

}  // namespace softarm::arm
