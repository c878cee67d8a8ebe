// Residuals of trials by time and body, and the same at other times.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace softarm::prove {

constexpr double kTick_s = 0.05;  ///< two means of one body are further apart

/// Residuals of one recording under one set of constants, m: by trial, time in ticks and body (below 0:
/// of its tangent, rad).
using Residuals = std::vector<std::map<std::pair<std::int64_t, int>, Eigen::Vector3d>>;

/// Residuals of one recording under two sets of the arm's constants.
struct Left {
  Residuals held;      ///< under the reference's
  Residuals refitted;  ///< under those that fit this recording
};

/// Residuals at the times of others: where means were taken over other stretches of the same trials, between
/// neighbours that are no more than 0.7 s apart.
Residuals at_times_of(const Residuals& others, const Residuals& residuals);

/// One less the other where both have any.
Residuals differences(const Residuals& with, const Residuals& without);

constexpr int kDisplacementEvery_s = 3;  ///< as often as tells what an effect does in a trial

/// Those of bodies every kDisplacementEvery_s, at whole seconds, between neighbours. Where a body is not seen
/// then, at the last whole second since the one before at which it is: an arm may be seen at rest alone.
Residuals at_whole_seconds(const Residuals& residuals);

}  // namespace softarm::prove
