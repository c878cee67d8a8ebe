// What the correlations of effects' numbers say together.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include "softarm/arm/arm_file.h"

namespace softarm::arm {

/// A number of a list of entries, by positions.
struct EffectNumberAt {
  std::size_t entry = 0, number = 0;
  friend bool operator<(const EffectNumberAt& a, const EffectNumberAt& b) {
    return std::tie(a.entry, a.number) < std::tie(b.entry, b.number);
  }
};

/// How a file calls it: creep.share; where the effect stands there several times, marker_slip.2.x_m of the
/// second one.
std::string name_in_file(const std::vector<EffectEntry>& entries, std::size_t entry,
                         const std::string& number);

/// Numbers with a standard deviation above 0, in the order of the file: those that may be correlated.
std::vector<EffectNumberAt> uncertain_numbers(const std::vector<EffectEntry>& entries);

/// The numbers that have a correlation, and all correlations of them.
struct CorrelatedNumbers {
  std::vector<EffectNumberAt> numbers;  ///< in the order of the file
  /// One row per number, of length 1: the product of two rows is the correlation of their numbers.
  Eigen::MatrixXd rows;
};

/// @throws ArmError for a correlation with what is no other uncertain number, one that is given twice or
/// outside [-1, 1], and where numbers cannot be correlated so all together
CorrelatedNumbers correlated_numbers(const std::vector<EffectEntry>& entries);

}  // namespace softarm::arm
