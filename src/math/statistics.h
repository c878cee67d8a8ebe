// Robust statistics of short lists.
#pragma once

#include <vector>

namespace softarm::math {

/// Median of the length of a vector of three independent standard normal numbers.
constexpr double kMedianOfChi3 = 1.5382;

/// Standard deviation of a normal distribution over its median absolute deviation.
constexpr double kSdPerMad = 1.4826;

/// The value below which a share `fraction` (0 ... 1) of the values lies: one of them, the nearest rank. 0 of
/// none.
double quantile(std::vector<double> values, double fraction);

/// The middle value, of an even number the mean of the two middle ones; 0 of none.
double median(std::vector<double> values);

/// 0 of none.
double mean(const std::vector<double>& values);

/// Standard deviation from the median absolute deviation: a few wild values do not matter. 0 of none.
double robust_sd(const std::vector<double>& values);

}  // namespace softarm::math
