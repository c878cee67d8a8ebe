// The mean of what was seen of one body in a short time, and how sure it is.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace softarm::model {

constexpr std::size_t kFewestOfMean = 3;  ///< frames of a mean
constexpr int kFewestOfBend = 5;          ///< frames of a mean whose scatter is about a parabola

/// Vectors of one body over a block, as a straight line in time. Lengths are in the unit of the vectors: m of
/// positions, 1 of tangents (rad across them).
struct BodyLine {
  Eigen::Vector3d at_centre = Eigen::Vector3d::Zero();  ///< at t = 0
  double sum2 = 0.0;  ///< of residuals, squared; about a parabola where the frames are enough
  int frames = 0, dof = 0;
  double variance_factor = 1.0;  ///< of at_centre against that of a frame
  /// The mean off the way's place at that time; 0 with too few frames.
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  double bend_factor = 0.0;  ///< of its variance per coordinate against that of a frame
};

/// By least squares; a mean without a slope where the frames are fewer than three, or of one time.
/// @param t of each frame, s, from where the line's place is looked for
/// @param p as many vectors
/// @param used of each frame whether it counts; one at least
BodyLine fit_line(const std::vector<double>& t, const std::vector<Eigen::Vector3d>& p,
                  const std::vector<bool>& used);

/// Variance of the means of parts, over what the differences of neighbouring values make of it: 1 where the
/// values are noise about one place.
/// @param part of each value, ascending
/// @return nothing of fewer than two parts, or where the values never differ
std::optional<double> scatter_of_parts(const std::vector<Eigen::Vector3d>& values,
                                       const std::vector<std::size_t>& part);

/// The mean of one vector of a body over a block, in the unit of the vectors.
struct BodyMean {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  int frames = 0;  ///< that it is the mean of
  double variance_factor = 1.0;
  double bend2 = 0.0, bend_factor = 0.0;  ///< see BodyLine; bend2 is the bend's square

  /// Of a coordinate, with that of a frame: what the noise leaves, and the bend of the way.
  double sd(double frame_sd) const;
};

/// The line through a body's values, without what jumped in single frames.
/// @param when of each frame, s, from the time of the mean
/// @param values as many; one at least
/// @param sd of a value as the arm file states it
/// @param scatter gets the variance per coordinate and frame, where frames are left to tell it
/// @return nothing where fewer than kFewestOfMean frames are left
std::optional<BodyMean> mean_of(const std::vector<double>& when, const std::vector<Eigen::Vector3d>& values,
                                double sd, std::vector<double>& scatter);

}  // namespace softarm::model
