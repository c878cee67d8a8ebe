// An arm's shape by its laws, its rod and the effects of its file, and how it follows from what drives it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "arm_statics.h"
#include "online_effects.h"
#include "softarm/arm/arm.h"
#include "softarm/arm/constants.h"

namespace softarm::model {

/// As the estimator has effects (OnlineEffects), with what the laws make of the inputs in the place of what
/// it fits; bodies are where they are seen. Without effects it is ArmStatics. Not thread-safe.
class ExtendedStatics {
 public:
  using Outcome = ArmStatics::Outcome;

  /// @param points_m, and what it throws: as ArmStatics
  ExtendedStatics(const arm::Arm& arm, std::vector<Present> effects, const std::vector<double>& points_m);

  /// Which effects are in it, and which cannot be and why; one line each.
  std::vector<std::string> notes() const;

  /// A trial of its own, that begins and ends here: what effects remember is at rest. From nothing.
  Outcome solve(const StaticLoad& load);
  /// The next one is the first of a trial.
  void begin_trial();
  /// The next of a trial, whose stamps increase: effects remember those before. After half a second without
  /// one they are at rest again.
  Outcome solve_next(double stamp_s, const StaticLoad& load);

  // Valid after kSolved, until the next.
  const std::vector<arm::SegmentPrediction>& laws() const { return online_ ? laws_ : plain_.laws(); }
  rod::RodState point(int i) const;
  Eigen::Vector3d body_position(int i) const;
  Eigen::Vector3d body_tangent(int i) const;

  /// As ArmStatics, after solve(). With effects: differences of whole solutions, right to a thousandth; NaN
  /// where there is none on either side.
  Eigen::MatrixXd by_inputs();
  Eigen::VectorXd by_payload();
  Eigen::MatrixXd by_gravity();
  Eigen::MatrixXd by_constants(const std::vector<arm::ConstantRef>& constants);

 private:
  /// The places of all bodies and points after a change of so much; false where there is no shape then.
  using Changed = std::function<bool(double change, Eigen::VectorXd& places)>;

  /// The rod's base frame in mocap: that of the file, turned as little as this gravity asks for.
  Eigen::Isometry3d base_under(const Eigen::Vector3d& gravity_base) const;
  Outcome solve(OnlineEffects& online, const arm::Arm& arm, double stamp_s, const StaticLoad& load,
                std::vector<arm::SegmentPrediction>& laws) const;
  Eigen::VectorXd places(const OnlineEffects& online) const;
  Eigen::VectorXd difference(double step, const Changed& changed) const;
  Eigen::VectorXd by_load(double step, const std::function<void(StaticLoad&, double)>& change);

  const arm::Arm arm_;
  const std::vector<Present> effects_;
  const std::vector<double> points_m_;
  ArmStatics plain_;
  std::optional<OnlineEffects> online_;  ///< absent: without effects
  std::vector<arm::SegmentPrediction> laws_;
  StaticLoad load_;  ///< of the last solution
};

}  // namespace softarm::model
