// An effect of the catalogue with its values, as it is handed around.
#pragma once

#include <Eigen/Core>

namespace softarm::model {

class Effect;

/// Values of an effect's parameters, in their order.
using Values = Eigen::VectorXd;

/// An effect with its values.
struct Present {
  const Effect* effect = nullptr;
  Values values;
  /// How the trial finds what it remembers, see Effect::starts(), over their standard deviations; empty: at
  /// rest.
  Eigen::VectorXd start = {};
  /// Standard deviations of the values, 0 where one is known; empty: all are.
  Values sd = {};
  /// How their errors go together: one row per value, of length 1, or 0 where it goes with nothing. The
  /// product of two rows, also of different effects of a list, is the correlation of their values. Empty: all
  /// err by themselves.
  Eigen::MatrixXd correlated = {};
};

}  // namespace softarm::model
