// Effects of an arm file frame by frame, with nothing known of what comes later: for the live node and for
// recordings alike.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "drive_history.h"
#include "effect.h"
#include "instant_solver.h"
#include "memories.h"
#include "size_errors.h"
#include "softarm/arm/arm.h"
#include "softarm/arm/laws.h"
#include "unknown_starts.h"

namespace softarm::model {

/// What the laws make of inputs where moments and curvatures follow others; nothing where they have no value.
std::optional<std::vector<arm::SegmentPrediction>> predict(const arm::Arm& arm,
                                                           const arm::InputValues& inputs,
                                                           const arm::InputValues& moment_inputs);

/// 1. begin(): what drives the frame, as effects on inputs and payload change it.
/// 2. solve(), as often as wanted: the equilibrium with all effects, whose segments have given values.
/// 3. keep(): the last solution is the frame's. Memories take notice of means over a tenth of a second, as
///    those from which a diagnosis found the effects.
/// A gap of half a second, or a step back in time, is a new beginning: memories are empty, as at the
/// beginning of a trial. Not thread-safe.
class OnlineEffects {
 public:
  /// How exact solutions are, and of which arm.
  struct Solving {
    double settled_m = 1e-6;  ///< to which shapes agree with what they cause: far below what cameras see
    const arm::Arm* layout =
        nullptr;  ///< the arm, where the one that is given has other constants of its laws
  };
  OnlineEffects(const arm::Arm& arm, const std::vector<Present>& effects)
      : OnlineEffects(arm, effects, Solving()) {}
  OnlineEffects(const arm::Arm& arm, const std::vector<Present>& effects, const Solving& solving);

  /// Which effects are in the model, and which cannot be and why; one line each.
  const std::vector<std::string>& notes() const { return notes_; }
  void reset();

  struct Driven {
    arm::InputValues inputs, moment_inputs;  ///< absent where they were
    std::optional<double> payload_kg;        ///< known; what really hangs there
  };
  /// @param payload_kg known; @param base rod's base frame in mocap
  /// @param samples of the inputs since the frame before, see trial::Frame
  const Driven& begin(double stamp_s, const arm::InputValues& inputs, std::optional<double> payload_kg,
                      const Eigen::Isometry3d& base, const std::vector<trial::InputSample>& samples = {});

  /// Solutions are under this gravity, rod's base frame, until the next begin().
  void set_gravity(const Eigen::Vector3d& gravity_base) { now_.gravity_base = gravity_base; }

  /// @param segments what stands for the laws' predictions
  /// @param turned of the tip, since start_here(), as far as that is known
  /// @return false where there is no equilibrium with the effects
  bool solve(const std::vector<arm::SegmentPrediction>& segments, double payload_kg,
             const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity());
  /// The same with the numbers of the effects off by each error so many standard deviations large.
  bool solve_leaning(const Eigen::VectorXd& by_sd, const std::vector<arm::SegmentPrediction>& segments,
                     double payload_kg, const Eigen::Quaterniond& turned);
  /// Of each segment's curvature towards x and y, 1/m^2, for what is not known of how the arm was left before
  /// it was first seen. @param segments as in solve()
  std::vector<Eigen::Vector2d> start_variance(const std::vector<arm::SegmentPrediction>& segments,
                                              double payload_kg);
  /// Independent errors of the effects' numbers, see SizeErrors.
  int size_errors() const { return errors_.count(); }
  /// What drives the frame with a standard deviation of one of them, as begin() has it for what the file
  /// says. @param differs from that
  Driven driven_by_error(int k, bool& differs) const;
  /// By what a difference so made is to be multiplied.
  double error_scale(int k) const { return errors_.scale(k); }
  /// By how much more the bodies of the arm are displaced, and turned, then. After that at() is of no use.
  /// @param segments, payload_kg as in solve(), of which the last solution is
  struct Moved {
    Eigen::Matrix3Xd p, tangent;
  };
  std::optional<Moved> moved_by_error(int k, const std::vector<arm::SegmentPrediction>& segments,
                                      double payload_kg);
  /// The next solves begin at the last solution.
  void start_here();
  /// Of the last solution: bodies of the arm as they are seen, rod's base frame.
  const Bodies& bodies() const { return bodies_; }
  /// Of the last solution.
  rod::RodState at(double s_m) const { return solver_.values.at(s_m); }
  /// The last solution is the frame's.
  void keep();

 private:
  /// Of a tenth of a second, by the stamps.
  struct Sum {
    double block = 0.0;
    int count = 0;
    Instant instant;
    Shape shape;
  };
  std::vector<Present> choose(std::vector<Present> all);
  Driven driven(const Instant& instant) const;
  bool solve(const std::vector<Present>& effects, const std::vector<arm::SegmentPrediction>& segments,
             double payload_kg, const Eigen::Quaterniond& turned);
  void observe(const std::vector<Present>& effects);
  void remember();

  const arm::Arm arm_;
  std::vector<std::string> notes_;  ///< these two by choose()
  bool looks_back_ = false;
  const std::vector<Present> effects_;
  InstantSolver solver_;
  DriveHistory history_;
  arm::InputValues given_inputs_;
  std::optional<double> given_payload_kg_;
  Driven driven_;
  Instant now_;
  Predicted last_;                 ///< solution
  std::optional<Predicted> near_;  ///< where solves begin
  Bodies bodies_;
  Feedback feedback_;
  Memories memories_;
  UnknownStarts unknown_;
  SizeErrors errors_;
  std::optional<Sum> sum_;
  std::optional<double> first_s_, last_s_, remembered_s_;
  Eigen::VectorXd values_;  ///< of the inputs, the last ones known
};

}  // namespace softarm::model
