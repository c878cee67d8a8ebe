// One frame to one estimate.
#pragma once

#include <memory>
#include <string>

#include "softarm/arm/arm.h"
#include "softarm/fit/estimate.h"
#include "softarm/fit/frame.h"

namespace softarm {

/// Fits the rod model of an arm to one frame at a time; the node, the offline program and the tests all use
/// it.
///
/// 1. Base pose from its markers; measured bodies into the rod's base frame; gravity too.
/// 2. Start: the last frame's solution if it explains this frame, else one built from the measured shape.
/// 3. Levenberg-Marquardt (Ceres) on actuation curvature, flexibility (or payload) and length per segment.
/// 4. A body that the others contradict is set aside and the fit repeated.
/// 5. Covariance, which parameters the frame can tell, residuals, backbone.
///
/// Not thread-safe; one instance per stream of frames.
class Estimator {
 public:
  /// @throws std::invalid_argument if the arm cannot be estimated with these options (say, no usable
  /// orientation for end_orientation)
  explicit Estimator(const Arm& arm) : Estimator(arm, arm.estimator) {}
  Estimator(const Arm& arm, const EstimatorOptions& options);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  /// Never throws for bad measurements: they become a Status. The reference stays valid until the next call.
  const Estimate& estimate(const Frame& frame);

  /// Forgets the last frame: the next one starts cold.
  void reset();

  const Arm& arm() const;
  const EstimatorOptions& options() const;
  void set_unknown(Unknown unknown);
  /// Number of evenly spaced points of Estimate::backbone (41 by default; 0: none, which saves their cost).
  void set_backbone_points(int count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For people: why these options cannot give what they ask for, and the remedy, in one line; empty if they
/// can.
std::string advice(const EstimatorOptions& options);

}  // namespace softarm
