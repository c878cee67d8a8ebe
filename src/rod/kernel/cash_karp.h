// Coefficients of the explicit Runge-Kutta method of order 5 with 6 stages of Cash and Karp, and its embedded
// method of order 4 (J. R. Cash, A. H. Karp, ACM Trans. Math. Softw. 16(3), 1990, doi:10.1145/79505.79507).
#pragma once

#include <cmath>

namespace softarm::rod::kernel {

struct CashKarp {
  static constexpr int kStages = 6;

  static constexpr double kC[kStages] = {0.0, 1.0 / 5.0, 3.0 / 10.0, 3.0 / 5.0, 1.0, 7.0 / 8.0};

  static constexpr double kA[kStages][kStages] = {
      {0.0},
      {1.0 / 5.0},
      {3.0 / 40.0, 9.0 / 40.0},
      {3.0 / 10.0, -9.0 / 10.0, 6.0 / 5.0},
      {-11.0 / 54.0, 5.0 / 2.0, -70.0 / 27.0, 35.0 / 27.0},
      {1631.0 / 55296.0, 175.0 / 512.0, 575.0 / 13824.0, 44275.0 / 110592.0, 253.0 / 4096.0},
  };

  static constexpr double kB[kStages] = {37.0 / 378.0,  0.0, 250.0 / 621.0,
                                         125.0 / 594.0, 0.0, 512.0 / 1771.0};

  /// Difference of the methods of order 5 and 4.
  static constexpr double kE5[kStages] = {37.0 / 378.0 - 2825.0 / 27648.0,
                                          0.0,
                                          250.0 / 621.0 - 18575.0 / 48384.0,
                                          125.0 / 594.0 - 13525.0 / 55296.0,
                                          -277.0 / 14336.0,
                                          512.0 / 1771.0 - 1.0 / 4.0};
  static constexpr double kE3[kStages] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  // there is one estimator alone

  static double error(double e5, double) { return std::sqrt(e5); }
};

}  // namespace softarm::rod::kernel
