// Robust statistics of short lists.
#pragma once

#include <vector>

namespace softarm::check {

constexpr double kSdPerMad = 1.4826;  // of a normal distribution

/// Of a copy; 0 of an empty list. @param fraction 0 ... 1, nearest rank
double quantile(std::vector<double> values, double fraction);
double median(std::vector<double> values);
double mean(const std::vector<double>& values);
/// Standard deviation from the median absolute deviation: a few wild values do not matter.
double robust_sd(const std::vector<double>& values);

}  // namespace softarm::check
