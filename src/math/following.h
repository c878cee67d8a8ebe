// What follows an input with a time constant.
#pragma once

#include <cmath>

namespace softarm::math {

/// After a time in which the input went straight:
/// state = kept * state + weight_last * last + weight_now * now. The three sum to 1.
struct Following {
  double kept = 1.0, weight_last = 0.0, weight_now = 0.0;
};

inline Following following(double dt_s, double time_constant_s) {
  Following f;
  if (!(dt_s > 0.0)) return f;
  if (!(time_constant_s > 0.0)) return {0.0, 0.0, 1.0};
  const double h = dt_s / time_constant_s;
  const double passed = -std::expm1(-h);
  f.kept = 1.0 - passed;
  f.weight_now = h > 1e-4 ? 1.0 - passed / h : 0.5 * h - h * h / 6.0;
  f.weight_last = passed - f.weight_now;
  return f;
}

}  // namespace softarm::math
