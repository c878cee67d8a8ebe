// The least-squares problem of one frame: residuals and Jacobian as functions of the free parameters.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "model/arm_rod.h"
#include "prior.h"
#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/solver.h"

namespace softarm::estimate {

constexpr int kSegmentParameters = 4;  ///< a, b, c, l of each segment, see Problem

/// One measured body, in the rod's base frame.
struct Observation {
  int body = 0;  ///< its index, and its station of the solver
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tangent;  ///< used by end_orientation
  bool used = true;
};

/// What effects beyond the laws do to the bodies, about x: added to the rod of the laws.
struct EffectsAt {
  struct OnBody {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();        ///< shift, m
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  ///< change of the tangent
    Eigen::Matrix3Xd p_by_x, tangent_by_x;
    /// More of both by a standard deviation of an error of the effects' numbers, a column each; and what of
    /// that no change of x makes.
    Eigen::Matrix3Xd p_by_error, tangent_by_error, p_beyond_x, tangent_beyond_x;
  };
  Eigen::VectorXd x;
  /// The change of x that makes nearly the same as such an error. What frames cannot tell from x they never
  /// can: it has x's derivatives of the frame, wherever it was worked out.
  Eigen::MatrixXd errors_as_x;
  Eigen::VectorXd errors;      ///< the numbers' most probable errors, in standard deviations
  std::vector<OnBody> bodies;  ///< by index into Arm::bodies
};

/// By what the bodies are off together, each body by a standard deviation of each of some errors: 3 x errors.
struct CommonOffsets {
  std::vector<Eigen::Matrix3Xd> p, tangent;  ///< by index into Arm::bodies
};

/// Residuals of one frame for ceres::TinySolver.
///
/// Parameters, all dimensionless, chosen so that the shape is nearly linear in them:
///   a, b   actuation curvature M0/EI times the segment's length at rest, towards phi = 0 and phi = 90
///   degrees c      flexibility: base bending stiffness / EI l      length / length at rest and last the
///   payload in units of kPayloadUnit.
/// The flexibility may pass through zero on the way to the optimum: nothing is singular there.
///
/// A block of residuals (the position of one body, or its tangent) is scaled as a whole so that its squared
/// norm is the loss of its distance: the cost of the solver is then exactly the robust or summed cost that
/// was asked for.
class Problem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  static constexpr double kPayloadUnit = 0.1;  // kg

  Problem(const arm::Arm& arm, const arm::EstimatorOptions& options);

  // --- the frame ---
  void set_gravity(const Eigen::Vector3d& gravity_base) {
    rod_.gravity_m_s2 = gravity_base;
    valid_ = false;
  }
  std::vector<Observation>& observations() { return observations_; }
  const std::vector<Observation>& observations() const { return observations_; }
  /// Free parameters: true in the order above.
  std::vector<bool>& free() { return free_; }
  const std::vector<bool>& free() const { return free_; }
  /// What the inputs make of the moduli that are not fitted; absent: those at no input.
  void set_laws(const std::optional<std::vector<arm::SegmentPrediction>>& predictions);
  void set_belief(const std::optional<Belief>& belief);
  const std::optional<Belief>& belief() const { return belief_; }
  /// @param effects kept by reference, until the next call; nullptr: none
  void set_effects(const EffectsAt* effects) { effects_ = effects; }
  const EffectsAt* effects() const { return effects_; }
  /// What is not known of the arm's motion; kept by reference, nullptr: nothing.
  void set_motion(const CommonOffsets* motion) { motion_ = motion; }
  /// Errors that all bodies have in common: of the effects' numbers, and behind them those of the motion.
  Eigen::Index errors() const;
  /// What a standard deviation of each adds: 3 x errors(). @param j position_jacobian()
  Eigen::Matrix3Xd position_by_errors(const Observation& o, const Eigen::Matrix3Xd& j) const;
  Eigen::Matrix3Xd tangent_by_errors(const Observation& o, const Eigen::Matrix3Xd& j) const;
  /// Counts the rows and forgets cached evaluations: call after the frame's data change.
  void begin();
  /// Forgets the last tip orientation as well: the next evaluation is not tied to an earlier frame.
  void forget() { anchored_ = false; }

  // --- for ceres::TinySolver ---
  int NumResiduals() const { return rows_; }
  int NumParameters() const { return static_cast<int>(free_.size()); }
  bool operator()(const double* x, double* residuals, double* jacobian) const;

  /// The same fit with the tip's orientation as three more unknowns and the clamped base as a residual: it
  /// has a value for every x, where the rod itself has no equilibrium near the shape, and leads to parameters
  /// for which it has one.
  /// @param base_sd_rad the weight of the base's orientation
  bool evaluate_free_tip(const double* x, const Eigen::Quaterniond& q_tip, double base_sd_rad,
                         double* residuals, double* jacobian, int rows) const;

  // --- the model at x ---
  /// Solves the rod; q_tip_start where the last evaluation is of no help. @return false without equilibrium.
  bool evaluate(const Eigen::VectorXd& x,
                const std::optional<Eigen::Quaterniond>& q_tip_start = std::nullopt) const;
  const rod::Solver& solver() const { return solver_; }
  const rod::Rod& rod() const { return rod_; }
  Eigen::Vector3d position(const Observation& o) const;
  Eigen::Vector3d tangent(const Observation& o) const;
  /// The same of the laws' rod alone.
  Eigen::Vector3d position_by_laws(const Observation& o) const;
  /// What is measured, less what the effects do about their x: what the laws' rod is to explain.
  Eigen::Vector3d measured_for_laws(const Observation& o) const;
  Eigen::Vector3d tangent_for_laws(const Observation& o) const;
  /// d position / d x (3 x P), free or not.
  void position_jacobian(const Observation& o, Eigen::Matrix3Xd& j) const;
  /// Of the laws' rod alone.
  void position_jacobian_by_laws(const Observation& o, Eigen::Matrix3Xd& j) const;
  void tangent_jacobian_by_laws(const Observation& o, Eigen::Matrix3Xd& j) const;
  /// d position / d payload (kg), be it free or not, and the same of the tangent: of the laws' rod.
  Eigen::Vector3d position_by_payload(const Observation& o) const;
  Eigen::Vector3d tangent_by_payload(const Observation& o) const;
  /// d position / d gravity (base frame); only with a window.
  Eigen::Matrix3d position_by_gravity(const Observation& o) const;
  Eigen::Matrix3d tangent_by_gravity(const Observation& o) const;
  void tangent_jacobian(const Observation& o, Eigen::Matrix3Xd& j) const;
  const arm::MeasuredBody& body_of(const Observation& o) const {
    return arm_.bodies[static_cast<std::size_t>(o.body)];
  }
  /// Of a frame by itself; with a window what bodies are off by for good is in it.
  double position_sd(const Observation& o) const { return position_sd_[static_cast<std::size_t>(o.body)]; }
  /// By what those errors displace it, rms of its coordinates, beside its noise.
  double displaced_sd(const Observation& o) const;
  double tangent_sd(const Observation& o) const { return tangent_sd_[static_cast<std::size_t>(o.body)]; }
  /// By what the residuals of a body's position and of its tangent are multiplied: 1/sd, or the paper's
  /// weights.
  double position_weight(const Observation& o) const;
  double tangent_weight(const Observation& o) const;
  /// Weight that the robust loss leaves a body at this many standard deviations, 0 ... 1.
  double bounded_influence(double distance) const;
  bool noise_weights() const { return noise_weights_; }
  int rod_solves() const { return rod_solves_; }

  // --- translation ---
  static int column(int segment, int which) { return segment * kSegmentParameters + which; }
  int payload_column() const { return NumParameters() - 1; }
  double reference_stiffness(int segment) const {
    return reference_stiffness_[static_cast<std::size_t>(segment)];
  }
  const std::vector<double>& reference_stiffnesses() const { return reference_stiffness_; }
  double rest_length(int segment) const {
    return rod_.segments[static_cast<std::size_t>(segment)].rest_length_m;
  }

 private:
  /// Weight c_i of a body as printed below equation (7): 1 / (i L), for the i-th body of the arm.
  double paper_weight(const Observation& o) const;
  void apply(const Eigen::VectorXd& x) const;
  /// Adds the columns of what is free.
  void add_free(const Eigen::Matrix3Xd& by_x, Eigen::Matrix3Xd& j) const;
  /// Of the rod's parameters, behind those of the segments.
  Eigen::Index rod_payload_column() const {
    return static_cast<Eigen::Index>(rod_.segments.size()) * model::kSegmentColumns;
  }
  void chain(const Eigen::Ref<const Eigen::Matrix3Xd>& by_rod, Eigen::Matrix3Xd& by_x) const;
  template <typename Columns>
  void add_block(const Eigen::Vector3d& e, const Columns& de, double weight, bool robust, int row,
                 double* residuals, double* jacobian) const;

  const arm::Arm& arm_;
  const arm::EstimatorOptions options_;
  const bool noise_weights_;
  const bool constant_curvature_;
  std::vector<Observation> observations_;
  std::vector<bool> free_;
  std::optional<Belief> belief_;
  Eigen::MatrixXd belief_rows_;
  const EffectsAt* effects_ = nullptr;
  const CommonOffsets* motion_ = nullptr;
  std::vector<double> reference_stiffness_, position_sd_, tangent_sd_;
  int rows_ = 0;

  // Scratch and the last evaluation; evaluating is const for TinySolver.
  mutable rod::Rod rod_;
  const rod::Rod unactuated_;
  mutable rod::Solver solver_;
  mutable Eigen::VectorXd x_, last_x_;
  mutable bool valid_ = false;     ///< solver_ holds the rod at last_x_
  mutable bool anchored_ = false;  ///< anchor_ is some equilibrium
  mutable model::Equilibrium anchor_;
  mutable Eigen::VectorXd accepted_x_;  ///< where the Jacobian was last asked for, and the tip there
  mutable Eigen::Quaterniond accepted_tip_ = Eigen::Quaterniond::Identity();
  mutable int rod_solves_ = 0;
  mutable Eigen::Matrix3Xd block_;
};

}  // namespace softarm::estimate
