// How far an arm's predicted shapes lie from measured ones.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"
#include "softarm/trial/trial.h"

namespace softarm::identify {

/// Error as Table 2 of the semi-physical paper states it: per frame the distance between measured and
/// predicted bodies, averaged over the bodies; over all frames its mean, median, maximum and minimum. All 0
/// without frames.
struct ShapeError {
  std::size_t frames = 0;
  double mean_m = 0.0, median_m = 0.0, maximum_m = 0.0, minimum_m = 0.0;
  double length_m = 0.0;  ///< of the arm at zero input: what percent refers to

  double percent(double error_m) const { return length_m > 0.0 ? 100.0 * error_m / length_m : 0.0; }
};

/// One body of one frame in the rod's base frame, m.
struct BodyComparison {
  int body = 0;
  Eigen::Vector3d measured_p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d predicted_p_base = Eigen::Vector3d::Zero();
};

/// One frame: the shape predicted from inputs and payload alone beside the measured one.
struct FrameComparison {
  std::size_t trial = 0;  ///< index into the trials
  double stamp_s = 0.0;
  double payload_kg = 0.0;
  arm::InputValues inputs;
  std::vector<BodyComparison> bodies;
  double error_m = 0.0;  ///< mean distance of the bodies
};

/// Which frames of a trial are compared or fitted.
struct FrameChoice {
  /// At most so many per trial, spread evenly over the inputs and the payload; 0: all.
  std::size_t frames_per_trial = 40;
  /// Only frames at rest (inputs, payload and bodies still for a while) in trials where those span most of
  /// the range of every input.
  bool prefer_static = true;
};

/// Predicts the chosen frames of each trial. Frames without known payload, base, inputs or bodies are left
/// out, as are those for which the arm has no equilibrium.
SOFTARM_EXPORT std::vector<FrameComparison> compare(const arm::Arm& arm,
                                                    const std::vector<trial::Trial>& trials,
                                                    const FrameChoice& choice = {});

SOFTARM_EXPORT ShapeError summarise(const std::vector<FrameComparison>& frames, double length_m);

/// summarise(compare(...)).
SOFTARM_EXPORT ShapeError shape_error(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                      const FrameChoice& choice = {});

}  // namespace softarm::identify
