// One frame to one estimate.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/estimate/estimate.h"
#include "softarm/export.h"
#include "softarm/model/present.h"
#include "softarm/trial/frame.h"

namespace softarm::estimate {

/// Fits the rod model of an arm to one frame at a time; the node, the offline program and the tests all use
/// it.
///
/// 1. Base pose from its markers; measured bodies into the rod's base frame; gravity too.
/// 2. Start: the last frame's solution if it explains this frame, else one built from the measured shape.
/// 3. Levenberg-Marquardt (Ceres) on actuation curvature, flexibility (or payload) and length per segment.
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
  const Estimate& estimate(const trial::Frame& frame);

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

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For people: why these options cannot give what they ask for, and the remedy, in one line; empty if they
/// can.
SOFTARM_EXPORT std::string advice(const arm::EstimatorOptions& options);

}  // namespace softarm::estimate
