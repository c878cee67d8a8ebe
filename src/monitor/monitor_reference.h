// What an arm lastingly does otherwise than its laws say: learned slowly, doubted slowly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "math/linear_algebra.h"
#include "monitor_shape.h"
#include "softarm/arm/arm.h"

namespace softarm::monitor {

/// A Kalman filter on lasting errors of the laws and offsets of the bodies, and the covariance of what they
/// leave.
///
/// States per segment: zero of the moment (2, N m), its gain and its direction (relative), flexibility
/// (relative), length (m), length per moment (m / N m); delay of the whole arm (s); offset of each body (3,
/// m, in its section's frame).
class SlowReference {
 public:
  SlowReference(const arm::Arm& arm, double memory_s, double position_sd_m);

  void reset();
  /// Takes the displacements per state at a shape. @param velocity of the bodies, m/s, three rows each
  /// @param before predictions of a window ago; as empty as `predictions` is null
  void set_shape(const MonitorShape& shape, const std::vector<arm::SegmentPrediction>* predictions,
                 const std::vector<arm::SegmentPrediction>& before, const Displacements& velocity,
                 bool payload_is_free);
  /// @return what the states say of the discrepancy
  Displacements predicted() const { return jacobian_ * state_; }
  /// Covariance of the innovation of one window. Rows of bodies that are not usable say nothing.
  /// @param inertia displacements that the innovation allows for, known to a share
  const math::CholeskyFactor& innovation_covariance(const std::vector<char>& usable,
                                                    const Displacements& inertia);

  /// A window of its own, not overlapping the last one. @param innovation of the shape that was set
  /// To be called after innovation_covariance().
  void update(const Displacements& innovation);
  /// Any window. @param dt_s since the last one
  void learn_noise(const Displacements& innovation, const std::vector<char>& usable, double dt_s);
  /// Forgets: what is known counts less by dt_s / memory_s, down to the prior.
  void age(double dt_s);
  /// Doubts what was learned: this share of the variance is the prior's again. 1: nothing is known any more
  void doubt(double share);

 private:
  /// Adds column_ times a share, as an uncertainty.
  void allow(double share);

  const arm::Arm& arm_;
  double memory_s_;
  double noise_m_;                                       ///< of mocap, per coordinate
  Eigen::VectorXd state_, prior_sd_, column_of_states_;  // the state in its prior's standard deviations
  Eigen::MatrixXd covariance_, jacobian_, noise_, total_, work_, gain_, free_, information_;
  Displacements column_, velocity_, law_change_;
  double learned_s_ = 0.0, expected_m2_ = 0.0;
  int free_columns_ = 0;
  double floor_m2_;
  math::CholeskyFactor factor_;
};

}  // namespace softarm::monitor
