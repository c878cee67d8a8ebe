// Effects of the arm file in the fit of one frame.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "../effects/online_effects.h"
#include "problem.h"
#include "softarm/arm/arm.h"
#include "softarm/fit/frame.h"

namespace softarm::fit {

/// What effects do to the bodies, as a linear function of the fit's parameters about the last place where it
/// was asked for:
///
///   p(x) = p_laws(x) + g + D (x - x_0),   g = p_effects(x_0) - p_laws(x_0),   D = dg / dx
///
/// Problem adds g and D to the rod of the laws: a fit costs what it costs without effects, and its covariance
/// has their derivatives. Where the fit has moved so far that the line is off by a share of the noise, it is
/// asked for again: Newton's method, and exact where that ends. D changes little from frame to frame and is
/// kept until the parameters or the loads have moved on.
class ExtendedFrame {
 public:
  ExtendedFrame(const Arm& arm, const std::vector<effects::Present>& effects, const Problem& problem);

  const std::vector<std::string>& notes() const { return online_.notes(); }
  void reset();

  /// The frame with what effects make of its inputs and payload. @param base the rod's in mocap
  const Frame& begin(const Frame& frame, const Eigen::Isometry3d& base);
  /// What begin() gave.
  const Frame& frame() const { return frame_; }
  /// Of the frame that was begun: what acts as a moment where that is not what the laws' other parts follow.
  const InputValues& moment_inputs() const { return moment_inputs_; }

  /// Works out g at x, and D where it is not known near x. @param laws predictions at the frame's inputs
  /// @param anew D in any case
  /// @return false where the arm has no equilibrium with effects there
  bool linearise(Problem& problem, const Eigen::VectorXd& x, const std::vector<SegmentPrediction>& laws,
                 bool anew);
  const EffectsAt& at() const { return at_; }
  /// How far the line is off at x, in standard deviations of the body for which it is largest; the next
  /// linearise() at x costs nothing. @return nothing where there is no equilibrium with effects
  std::optional<double> off_sd(Problem& problem, const Eigen::VectorXd& x,
                               const std::vector<SegmentPrediction>& laws);
  /// x is the frame's estimate: shapes are its from now on. @return false as linearise()
  bool keep(const Problem& problem, const Eigen::VectorXd& x, const std::vector<SegmentPrediction>& laws);
  /// After keep().
  rod::RodState shape_at(double s_m) const { return online_.at(s_m); }

 private:
  struct Difference {
    Eigen::Matrix3Xd p, tangent;  ///< by body: with effects less without
  };
  Eigen::VectorXd within_range(const Problem& problem, const Eigen::VectorXd& x) const;
  bool solve(const Problem& problem, const Eigen::VectorXd& x, const std::vector<SegmentPrediction>& laws);
  std::optional<Difference> difference(Problem& problem, const Eigen::VectorXd& x,
                                       const std::vector<SegmentPrediction>& laws);
  bool differentiate(Problem& problem, const Eigen::VectorXd& x, const std::vector<SegmentPrediction>& laws,
                     const Difference& here);
  bool derivative_holds(const Problem& problem, const Eigen::VectorXd& x) const;

  const Arm arm_;
  effects::OnlineEffects online_;
  Frame frame_;
  InputValues moment_inputs_;
  EffectsAt at_;
  struct Known {
    Eigen::VectorXd x;
    Difference difference;
  };
  std::optional<Known> known_;               ///< of this frame
  std::optional<Eigen::VectorXd> solved_x_;  ///< of the last solution with effects
  // Where D is of.
  Eigen::VectorXd derivative_x_;
  std::vector<bool> derivative_of_;  ///< parameters
  Eigen::Vector3d derivative_gravity_ = Eigen::Vector3d::Zero();
  double derivative_stamp_s_ = 0.0;
};

}  // namespace softarm::fit
