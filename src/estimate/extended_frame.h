// Effects of the arm file in the fit of one frame.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/online_effects.h"
#include "problem.h"
#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm::estimate {

/// What effects do to the bodies, as a linear function of the fit's parameters about the last place where it
/// was asked for:
///
///   p(x) = p_laws(x) + g + D (x - x_0),   g = p_effects(x_0) - p_laws(x_0),   D = dg / dx
///
/// Problem adds g and D to the rod of the laws: a fit costs what it costs without effects, and its covariance
/// has their derivatives. A fit begins with the line of the frame before it. Its first step leads nearly to
/// its end: there the arm with effects is solved, and the fit goes on with the line through that place. Where
/// it ends so far from there that the line may be off by a share of the noise, the arm is solved again:
/// Newton's method, and exact where that ends. D changes little from frame to frame: each solution corrects
/// it along the way that the fit went (Broyden's update), and it is worked out anew when the parameters or
/// the loads have moved on.
class ExtendedFrame {
 public:
  ExtendedFrame(const arm::Arm& arm, const std::vector<model::Present>& effects, const Problem& problem);

  const std::vector<std::string>& notes() const { return online_.notes(); }
  void reset();

  /// The frame with what effects make of its inputs and payload. @param base the rod's in mocap
  const trial::Frame& begin(const trial::Frame& frame, const Eigen::Isometry3d& base);
  /// Of each segment's curvature, for what is not known of how effects were left before the arm was first
  /// seen; see OnlineEffects.
  std::vector<Eigen::Vector2d> start_variance(const std::vector<arm::SegmentPrediction>& laws,
                                              double payload_kg) {
    return online_.start_variance(laws, payload_kg);
  }
  /// Independent errors of the effects' numbers.
  int errors() const { return online_.size_errors(); }
  /// What the laws say of the frame that was begun, laws(inputs), as what depends on the effects' numbers.
  void set_laws(const std::vector<arm::SegmentPrediction>& laws);
  /// By what those of x that they say move by a standard deviation of an error, a column each.
  Eigen::MatrixXd laws_by_errors(const std::vector<arm::SegmentPrediction>& laws,
                                 const std::vector<double>& reference_stiffness) const;
  /// Works out anew what errors of the numbers do, where x is far from where that was done.
  /// @return whether it was
  bool renew_errors(Problem& problem, const Eigen::VectorXd& x,
                    const std::vector<arm::SegmentPrediction>& laws);
  /// The errors are so many standard deviations large.
  void set_errors(const Eigen::VectorXd& errors) { at_.errors = errors; }
  /// The arm moves, as at rest under this gravity.
  void set_gravity(const Eigen::Vector3d& gravity_base) {
    online_.set_gravity(gravity_base);
    solved_x_.reset();
  }
  /// What begin() gave.
  const trial::Frame& frame() const { return frame_; }
  /// Of the frame that was begun: what acts as a moment where that is not what the laws' other parts follow.
  const arm::InputValues& moment_inputs() const { return moment_inputs_; }

  /// Works out g at x, and D where it is not known near x. @param laws predictions at the frame's inputs
  /// @param anew D in any case
  /// @return false where the arm has no equilibrium with effects there
  bool linearise(Problem& problem, const Eigen::VectorXd& x, const std::vector<arm::SegmentPrediction>& laws,
                 bool anew);
  const EffectsAt& at() const { return at_; }
  /// Whether the line of the frame before may serve a fit that begins at x.
  bool line_reaches(const Problem& problem, const Eigen::VectorXd& x) const;
  /// Moves the line to x.
  /// @return by how much it was off there, in standard deviations of the body for which that is largest;
  /// nothing where there is no equilibrium with effects
  std::optional<double> move_line(Problem& problem, const Eigen::VectorXd& x,
                                  const std::vector<arm::SegmentPrediction>& laws);
  /// By how much it may be off at x, as the last lines were on their ways; nothing where none of this frame
  /// or none before has shown it.
  std::optional<double> expected_off_sd(const Problem& problem, const Eigen::VectorXd& x) const;
  /// x is the frame's estimate, and what was evaluated last: shapes are its from now on, or those of the last
  /// solution where that is the same within a small share of the noise. @return false as linearise()
  bool keep(const Problem& problem, const Eigen::VectorXd& x,
            const std::vector<arm::SegmentPrediction>& laws);
  /// After keep().
  rod::RodState shape_at(double s_m) const { return online_.at(s_m); }

 private:
  struct OfBodies {
    Eigen::Matrix3Xd p, tangent;
  };
  /// What drives the frame with an error of the effects' numbers; as it is: nothing.
  struct OtherDrive {
    std::vector<arm::SegmentPrediction> laws;
    std::optional<double> payload_kg;
  };
  std::vector<arm::SegmentPrediction> segments_at(const Problem& problem, const Eigen::VectorXd& x,
                                                  const std::vector<arm::SegmentPrediction>& laws) const;
  Eigen::Quaterniond turned(const Problem& problem) const;
  using Difference = OfBodies;  ///< with effects less without
  /// The bodies of what was evaluated last are those of the last solution.
  bool is_solved_near(const Problem& problem) const;
  void start_here();
  Eigen::VectorXd within_range(const Problem& problem, const Eigen::VectorXd& x) const;
  /// x is what was evaluated last.
  bool solve(const Problem& problem, const Eigen::VectorXd& x,
             const std::vector<arm::SegmentPrediction>& laws);
  std::optional<Difference> difference(Problem& problem, const Eigen::VectorXd& x,
                                       const std::vector<arm::SegmentPrediction>& laws);
  void put_line(const Eigen::VectorXd& x, const Difference& difference);
  bool differentiate(Problem& problem, const Eigen::VectorXd& x,
                     const std::vector<arm::SegmentPrediction>& laws, const Difference& here);
  /// What errors of the effects' numbers do at x, of which the last solution is; to be split by what x can
  /// do.
  void look_at_errors(const Problem& problem, const Eigen::VectorXd& x,
                      const std::vector<arm::SegmentPrediction>& laws);
  void split_errors(const Problem& problem);
  /// By how much the numbers' errors displace the body that is seen for which that is most, in its sd.
  double errors_off_sd(const Problem& problem) const;
  bool derivative_holds(const Problem& problem, const Eigen::VectorXd& x) const;
  /// By what each parameter may move on before D is worked out anew.
  Eigen::VectorXd reach(const Problem& problem) const;
  /// Way from the line's place, in shares of reach().
  double way_to(const Problem& problem, const Eigen::VectorXd& x) const;
  /// D as it must be for g to have changed by so much more than it says on the way that the line went.
  void correct_derivative(const Problem& problem, const Eigen::VectorXd& way, const Difference& more);

  const arm::Arm arm_;
  model::OnlineEffects online_;
  trial::Frame frame_;
  arm::InputValues moment_inputs_;
  std::vector<std::optional<OtherDrive>> other_drives_;  ///< by error
  EffectsAt at_;
  bool line_ = false;                        ///< at_ is the line of this frame or the last
  bool of_this_frame_ = false;               ///< the line
  std::optional<double> off_sd_per_way_;     ///< of the last lines, about the largest
  std::optional<Eigen::VectorXd> solved_x_;  ///< of the last solution with effects
  Eigen::Quaterniond solved_tip_ = Eigen::Quaterniond::Identity();  ///< by the laws alone there
  std::optional<Eigen::Quaterniond> near_tip_;                      ///< the same of where solutions begin
  OfBodies solved_by_laws_;   ///< where the laws alone have the bodies there
  Eigen::VectorXd errors_x_;  ///< where what errors do was worked out
  // Where D is of.
  Eigen::VectorXd derivative_x_;
  std::vector<bool> derivative_of_;  ///< parameters
  Eigen::Vector3d derivative_gravity_ = Eigen::Vector3d::Zero();
  double derivative_stamp_s_ = 0.0;
};

}  // namespace softarm::estimate
