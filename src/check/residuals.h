// What no shape of the arm explains: the estimator's residuals, frame by frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "context.h"

namespace softarm::check {

struct Residual {
  double t_s = 0.0;
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< measured less estimated, in the section frame
};

using ResidualSeries = std::vector<Residual>;

struct Residuals {
  std::vector<ResidualSeries> bodies;  ///< m, as Arm::bodies
  /// Of the tangent where the body's orientation is known, 1 (rad as long as it is small).
  std::vector<ResidualSeries> tangents;
  std::vector<double> rms_m;  ///< one per frame
};

/// The arm as the recording has it: lengths and arclengths that check_spacing found wrong are put right.
arm::Arm repaired_arm(const Context& context);

/// Every frame by itself, stiffness or whatever the arm's method can find free. Poses that a check found
/// wrong are left out, labels are as check_exchanged put them.
/// @param most frames, spread over the recording
/// @param with_sections false: only rms_m and the residuals in the base frame, quicker
/// @return nothing in it where such an arm cannot be fitted
Residuals residuals_of(const Context& context, const arm::Arm& arm, std::size_t most, bool with_sections);

// Of [from, to).
Eigen::Vector3d mean_of(const ResidualSeries& residuals, std::size_t from, std::size_t to);
Eigen::Vector3d mean_of(const ResidualSeries& residuals);
/// Standard deviation of a coordinate about its median, the largest of the three.
double spread_of(const ResidualSeries& residuals);
/// From one frame to the next, in a coordinate: what does not last.
double jitter_of(const ResidualSeries& residuals);
/// What lasts beyond a tenth of a second, of all coordinates together, beside the mean: root of the
/// covariance of neighbours; 0 where it is no more than chance.
double lasting_of(const ResidualSeries& residuals);

struct Slip {
  double change = 0.0, t_s = 0.0, significance = 0.0;
};
/// The instant before and after which the means differ most, in standard errors.
Slip slip_of(const ResidualSeries& residuals);

}  // namespace softarm::check
