// The estimator's state and steps; estimator.cpp holds the frame's side, estimator_solve.cpp the fit,
// estimator_report.cpp what is said of it.
#pragma once

#include <ceres/tiny_solver.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arm/wall_memory.h"
#include "covariance.h"
#include "extended_frame.h"
#include "payload_changes.h"
#include "problem.h"
#include "softarm/estimate/estimator.h"
#include "swing_filter.h"
#include "tip_motion.h"
#include "white_noise.h"
#include "window.h"

namespace softarm::estimate {

struct Estimator::Impl {
  using VectorXd = Eigen::VectorXd;

  Impl(const arm::Arm& a, const arm::EstimatorOptions& o, const std::vector<model::Present>& e);
  void check() const;
  /// The most distal ring of a segment that serves the method; -1 if there is none.
  int end_body(int segment) const;
  void fail(Status status, std::string detail);
  const Estimate& run(const trial::Frame& frame);
  void clear(const trial::Frame& frame);

  // --- step 1 ---
  bool place_base(const trial::Frame& frame);
  std::vector<int> end_bodies() const;
  bool observe(const trial::Frame& frame);
  /// For the detail of a refusal: the bodies that are too far from the base; empty if none is.
  std::string too_far_words() const;
  /// Each segment has three unknowns of shape, each body three coordinates: from every joint to the tip there
  /// must be as many bodies as segments.
  bool enough_beyond_every_joint() const;

  // --- what is known ---
  /// What the laws say of the frame's inputs, all segments or nothing.
  std::optional<std::vector<arm::SegmentPrediction>> predict_laws(const trial::Frame& frame);
  /// Whether the laws that this fit needs have their inputs; fails where not.
  bool has_needed_inputs(const trial::Frame& frame, bool estimate_stiffness);
  /// Of the segments' curvature, for how the arm was left before it was first seen; empty: nothing is
  /// missing.
  std::vector<Eigen::Vector2d> unknown_starts(const std::vector<arm::SegmentPrediction>& laws);
  bool set_knowns(const trial::Frame& frame);
  /// Gives the problem what the laws and the window's frames say of this one.
  void believe();

  // --- steps 2 and 3 ---
  void impose_knowns(VectorXd& v) const;
  void refresh_covariance();
  double rms() const;
  /// @param free_tip go by way of a rod whose base is not yet clamped
  bool start_cold(bool free_tip = false);
  void iterate();
  /// By how much chi^2 would still fall from here, by its derivatives there; infinity without equilibrium.
  double left_to_fall(const VectorXd& at) const;
  /// Whether the fit that gave x converged; fails where not.
  bool has_converged();
  bool minimise();
  bool solve();
  /// The same with outliers set aside and, where the window's frames stand against this one, without them.
  bool solve_with_window();
  bool solve_without_window();
  /// Some body is an outlier of the fit, or there is none.
  bool contradicted(bool fitted) const;

  // --- frames that share, estimator_window.cpp ---
  /// Where b has its motions, and how many it has of all.
  Eigen::Index motions() const;
  Eigen::Index errors() const;
  Eigen::Vector3d tip() const;
  /// Of the tip's acceleration, by which the gravity that the rod feels is off, and its variance.
  double inertia_share() const;
  Eigen::Vector3d inertia_variance() const;
  /// What bodies say where the arm is not at rest.
  /// @param repeats how many frames in a row move alike: each of them says as much less
  Evidence moving(Evidence bodies, double repeats) const;
  /// @param found (x - this frame's, b)
  Eigen::Vector3d most_probable_motion(const BodyRows& own, const VectorXd& found) const;
  /// This frame's rod is that of an arm which moves so: by D'Alembert, under another gravity.
  void feel(const Eigen::Vector3d& by_motion);
  Eigen::VectorXd passing_variance() const;
  Eigen::VectorXd placement_variance() const;
  Eigen::VectorXd posture_variance() const;
  /// Linearises postures anew, about this frame's stiffness and payload.
  void linearise_postures();
  /// A posture's own parameters, given those that it shares with this frame: a Gauss-Newton step.
  VectorXd parameters_of(const Window::Posture& posture) const;
  std::optional<BodyRows> rows_of(Window::Posture& posture, const VectorXd& at);
  /// The fit took what bodies are off by for noise of this frame. It is the same in others: of x and of that,
  /// together, this is the most probable by the bodies and what other frames say of either, and its
  /// covariance.
  void settle();
  double settle_from_here();
  /// Takes the most probable x within its bounds, and the motion. @param of x - the fit's
  Eigen::VectorXd move_to(const Evidence& of, const Eigen::Vector3d& by_motion);
  BodyRows rows() const;
  Window::Entry entry() const;
  /// Adds what this frame says to the window; fits it again where that ends a change.
  bool share();

  // --- a payload that changes, estimator_payload.cpp ---
  /// Without a window: by what the load that the arm feels may be off is an error that all bodies of the
  /// frame have in common, about where the problem was last evaluated.
  /// @return whether there is such an error
  bool allow_for_payload_change();
  /// The same as a gravity that is off along itself, its variance: with a window.
  Eigen::Vector3d gravity_variance_by_payload() const;
  /// After the fit: nothing is identifiable while the payload changes; how it goes if it is estimated.
  void look_at_payload();
  /// This parameter would be identifiable, were it not for a payload that changes.
  bool told_but_for_change(int column) const;
  double own_kg() const;
  double end_kg() const;

  // --- an arm that is followed through its swings, estimator_swing.cpp ---
  /// Before the fit: where the arm is in its swing, and under which gravity it is at rest so.
  void follow_swing(const trial::Frame& frame, const std::vector<arm::SegmentPrediction>& laws);
  /// After it: how the bodies follow from the inputs, and the modes, where the arm has moved on.
  void look_at_swing();
  std::vector<arm::SegmentPrediction> segments_of_modes() const;

  // --- steps 2 to 4 with effects of the arm file in the model ---
  bool solve_with_effects();
  /// Where the line of effects is that of the frame before: a first step, and the line moved to its end.
  void move_old_line();
  /// Fills estimate_by_laws.
  void take_effects_out();
  /// The fit again, where the effects have been worked out anew. @param whole all bodies are used again
  bool fit_again(bool whole);

  // --- step 4 ---
  /// How far the bodies used are from the fit, in standard deviations.
  struct Distances {
    double largest = 0.0, sum_of_squares = 0.0;
    int used = 0;
  };
  double distance(const Observation& o) const;
  Distances distances() const;
  /// The fit without each body in turn: an outlier pulls the fit so much that its own residual need not be
  /// the largest. The body is set aside whose absence leaves the least, if the rest then contradicts it.
  /// @param fitted x is a fit to all bodies in use
  /// @return false where everything stays as it was
  bool set_one_aside(bool fitted);
  /// @param fitted x is a fit to all bodies
  bool set_outliers_aside(bool fitted);
  int estimated_parameters() const;
  /// Of x: the arm file's physical ranges.
  std::vector<arm::Range> bounds() const;
  /// A flexibility, length or payload outside its physical range is held at the limit and the rest fitted
  /// again.
  bool keep_to_bounds();

  // --- step 4b ---
  /// What the loads stretch each segment by at x, m; the payload as in its range.
  std::vector<double> stretch_by_loads() const;
  /// What is not known of EA counts with the stretch at the solution, which is fitted again until the two
  /// agree.
  bool allow_for_stretch();

  // --- step 5 ---
  /// For the detail of a refusal: both lengths where the way from the base through the bodies is less than
  /// half or more than twice that of the arm file; else nothing.
  std::string length_hint() const;
  void finish();
  /// Near a buckling load the shape is so sensitive to the stiffness that the linear covariance promises
  /// much, while another stiffness with another moment explains the bodies nearly as well. There, EI is
  /// identifiable only if fits with EI moved by twice the relative standard deviation that is asked for are
  /// worse by what such a deviation would make them.
  void confirm_stiffness();
  void residuals_and_chi_square();
  void bending_angles();
  void payload();
  void backbone();

  // --- state ---
  const arm::Arm arm;
  arm::EstimatorOptions options;
  Problem problem;
  ceres::TinySolver<Problem> solver;
  bool converged = false;  ///< x is of a fit that has
  std::vector<double> inflation_limit;
  int backbone_points = 41;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  bool base_seen = false;
  std::optional<double> payload_known;
  std::vector<std::optional<double>> known_flexibility;
  std::vector<std::optional<double>> start_flexibility;  ///< known, or believed by the laws
  arm::LawMemory memory;                                 ///< of the walls
  FrameLaw law;
  std::vector<double> stretch_m;  ///< with which `law` counts what is not known of EA
  std::optional<Window> window;
  std::unique_ptr<Problem> past;                                  ///< with a window: of its postures
  VectorXd last_offsets;                                          ///< b of the last frame
  std::optional<std::vector<arm::SegmentPrediction>> laws_given;  ///< to the problem
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  ///< by what this frame's rod feels another gravity
  TipMotion motion;                                   ///< with a window only
  WhiteNoise noise;                                   ///< with a window or `swing` only
  std::optional<SwingFilter> swing;
  PayloadChanges payload_changes;
  CommonOffsets swing_errors;                               ///< of the frame
  CommonOffsets motion_errors;                              ///< the same, behind them that of the payload
  Eigen::Vector3d swing_gravity = Eigen::Vector3d::Zero();  ///< the same: beyond the true one
  std::vector<arm::SegmentPrediction> swing_laws;           ///< the same
  std::optional<VectorXd> last_x_by_laws;                   ///< of the last frame that had inputs
  std::vector<Eigen::Matrix3Xd> bodies_by_x;                ///< of the last fit; empty: none yet
  /// What the modes are of.
  struct ModesAt {
    Eigen::Matrix3Xd bodies;
    std::vector<double> stiffness_nm2;
    double payload_kg = 0.0;
    Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();
  };
  std::optional<ModesAt> modes_at;
  VectorXd influence;  ///< of each block of rows of the bodies, see settle()
  const std::vector<model::Present> effects;
  std::unique_ptr<ExtendedFrame> extension;           ///< of an arm with effects
  std::vector<arm::SegmentPrediction> laws_at_frame;  ///< with the inputs as the effects change them
  bool extended = false;                              ///< the frame's fit has the effects in it
  bool line_is_old = false;                           ///< that of the effects
  int contradictions = 0;            ///< frames in a row that may be a change or a wrong body
  std::optional<bool> inputs_known;  ///< of the last frame
  std::vector<bool> estimated;       ///< free before any parameter was held at a bound
  Covariance covariance;
  Eigen::MatrixXd scatter;  ///< the same without what a changing payload adds, which biases nothing
  const trial::Frame* frame_given = nullptr;
  trial::Frame frame_by_laws;  ///< with `extended` only
  Estimate estimate_by_laws;   ///< the same
  VectorXd x, last_x;
  bool have_last = false;
  Estimate estimate;
};

bool is_constant_curvature(arm::Method method);
inline constexpr const char* kUnitsHint =
    "are the units (inputs.bodies.unit) and the lengths of the arm file right?";

}  // namespace softarm::estimate
