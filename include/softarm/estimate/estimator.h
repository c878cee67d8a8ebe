// One frame to one estimate.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"
#include "softarm/model/present.h"
#include "softarm/trial/trial.h"

namespace softarm::estimate {

/// Why a frame has, or has not, an estimate.
enum class Status {
  kOk,
  kNoBasePose,       ///< the base has never been seen
  kNotEnoughBodies,  ///< what was measured cannot determine the unknowns
  kMissingPayload,   ///< stiffness is asked for, but the payload is not known
  kMissingInputs,    ///< the prior or the known stiffness needs pressures, tensions or angles that are absent
  kInvalidInput,     ///< non-finite or absurd numbers (kilometres, zero quaternion)
  kNoConvergence,    ///< the solver found no fit, or had not converged in its iterations
  kInconsistent,     ///< converged, but to a shape that the measurements contradict grossly
};

SOFTARM_EXPORT std::string to_string(Status status);

/// Why EI is not identifiable in a frame.
enum class WhyNot {
  kIdentifiable,
  kNotDetermined,  ///< no load bends the arm enough: its interval is too wide
  kByLawsAlone,    ///< the interval is that of the laws as a prior; the bodies say nothing of it
  kNearBuckling,   ///< the shape follows EI closely, but another EI with another moment has nearly the same
  kSettling,  ///< the payload has just changed: a hand is on the arm, or it swings, see Estimate::settling
};

/// Estimates of one segment. sd_... is absent where the frame does not determine the value at all (a value
/// without sd is then the assumed one); a value is absent where it is neither estimated nor known.
struct SegmentEstimate {
  std::optional<double> moment_nm;                  ///< M0 >= 0
  std::optional<double> direction_rad;              ///< phi, (-pi, pi], in the base frame of the segment
  std::optional<double> bending_stiffness_nm2;      ///< EI
  std::optional<double> length_m;                   ///< L
  std::optional<double> actuation_curvature_per_m;  ///< M0 / EI: observable even without load
  std::optional<double> sd_moment_nm, sd_direction_rad, sd_bending_stiffness_nm2, sd_length_m,
      sd_actuation_curvature_per_m;
  bool identifiable_stiffness =
      false;  ///< this frame determines EI to EstimatorOptions::identifiable_relative_sd
  WhyNot stiffness_why_not = WhyNot::kIdentifiable;
  bool identifiable_moment = false;
  double bending_angle_rad = 0.0;  ///< angle between the tangents at the segment's ends
  /// Covariance of (M0, phi, EI, L); NaN-free: rows of undetermined parameters are zero, see the sd_...
  /// fields.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

/// The backbone at one arclength, in the base frame of the rod.
struct BackbonePoint {
  double arclength_m = 0.0;  ///< along the arm at zero input
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base = Eigen::Quaterniond::Identity();
  Eigen::Vector3d curvature_per_m = Eigen::Vector3d::Zero();  ///< strain u in the section frame
};

/// Estimated against measured position of one body.
struct BodyResidual {
  int body = 0;
  Eigen::Vector3d measured_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimated_base = Eigen::Vector3d::Zero();
  bool used = true;  ///< false: set aside as an outlier
};

/// A body that was seen where no body of this arm can be: the frame is estimated without it.
struct BodyTooFar {
  int body = 0;
  double distance_m = 0.0;  ///< from the base of the rod
};

struct SolverSummary {
  int iterations = 0;
  int rod_solves = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool warm_start = false;
};

/// One frame's estimate.
struct Estimate {
  double stamp_s = 0.0;
  Status status = Status::kNotEnoughBodies;
  std::string detail;  ///< one line for people where status is not kOk
  /// The payload changes or has just changed: what hangs on the arm is not the load that the arm feels, since
  /// a hand holds it and then the arm swings. Intervals are as wide as that makes them, nothing is
  /// identifiable.
  bool settling = false;
  std::vector<SegmentEstimate> segments;
  std::optional<double> payload_kg;     ///< estimated or known
  std::optional<double> sd_payload_kg;  ///< absent when known or undetermined
  bool identifiable_payload = false;
  Eigen::Isometry3d base_in_mocap = Eigen::Isometry3d::Identity();  ///< rod base frame
  std::vector<BackbonePoint> backbone;
  std::vector<BodyResidual> residuals;
  /// Not among the residuals: who plots them, or looks for slipped rings in them, has no use for such places.
  std::vector<BodyTooFar> too_far;
  double rms_residual_m = 0.0;      ///< root mean square distance over the bodies used
  double reduced_chi_square = 0.0;  ///< chi-square per degree of freedom against the stated noise
  int degrees_of_freedom = 0;
  SolverSummary solver;
};

/// Fits the rod model of an arm to one frame at a time; the node, the offline program and the tests all use
/// it.
///
/// 1. Base pose from its markers; measured bodies into the rod's base frame; gravity too.
/// 2. Start: the last frame's solution if it explains this frame, else one built from the measured shape.
/// 3. Levenberg-Marquardt (Ceres) on actuation curvature, flexibility (or payload) and length per segment. A
///    fit that has not met its tolerance in its iterations is no estimate: kNoConvergence.
/// 4. A body that the others contradict is set aside and the fit repeated.
/// 5. Covariance, which parameters are identifiable, residuals, backbone.
///
/// Effects of the arm file (effects/arm_effects.h) are in the model: what they do to the bodies at the
/// estimate is added to the laws' rod, with its derivatives, and the fit repeated until both agree
/// (src/estimate/extended_frame.h). Estimates are those of the laws' constants, before the effects change
/// them.
///
/// Not thread-safe; one instance per stream of frames.
class SOFTARM_EXPORT Estimator {
 public:
  /// @throws std::invalid_argument if the arm cannot be estimated with these options (say, no usable
  /// orientation for end_orientation)
  explicit Estimator(const arm::Arm& arm) : Estimator(arm, arm.estimator) {}
  Estimator(const arm::Arm& arm, const arm::EstimatorOptions& options);
  Estimator(const arm::Arm& arm, const arm::EstimatorOptions& options,
            const std::vector<model::Present>& effects);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  /// Never throws for bad measurements: they become a Status. The reference stays valid until the next call.
  const Estimate& estimate(const trial::Frame& frame) &;
  /// Of an estimator that is about to go: the estimate itself, which outlives it.
  Estimate estimate(const trial::Frame& frame) &&;

  /// The last frame and its estimate as an arm without effects would have them: inputs as the effects change
  /// them, bodies and backbone by the laws alone. For comparisons with the laws (monitor::MismatchMonitor).
  /// Without effects those that were given; valid until the next call of estimate().
  struct ByLaws {
    const trial::Frame& frame;
    const Estimate& estimate;
  };
  ByLaws by_laws() const;

  /// Forgets the last frame: the next one starts cold.
  void reset();

  const arm::Arm& arm() const;
  const arm::EstimatorOptions& options() const;
  /// For people: the effects that the fit has in it, and those that it cannot have and why, one line
  /// each; empty for an arm without.
  std::vector<std::string> effect_notes() const;
  void set_unknown(arm::Unknown unknown);
  /// Number of evenly spaced points of Estimate::backbone (41 by default; 0: none, which saves their cost).
  void set_backbone_points(int count);
  /// Number of iterations in which a fit must meet its tolerance; a frame whose fit has not is refused, as
  /// kNoConvergence. 59 by default, several times what frames take.
  void set_most_iterations(int count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For people: why these options cannot give what they ask for, and the remedy, in one line; empty if they
/// can.
SOFTARM_EXPORT std::string advice(const arm::EstimatorOptions& options);

}  // namespace softarm::estimate
