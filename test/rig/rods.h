// Rods and independent references for the tests of the virtual rig.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <vector>

#include "rig/ritz_rod.h"

namespace softarm::rig {

/// The arm of the online paper without damping, in no gravity unless given.
inline RitzRodParams paper_rod(int elements = 6) {
  RitzRodParams params;
  params.pieces[0].elements = elements;
  params.pieces[0].mass_kg = 0.2;
  params.pieces[0].diameter_m = 0.04;
  return params;
}

inline RitzRodInputs paper_inputs() {
  RitzRodInputs inputs;
  inputs.pieces[0].length_m = 0.2;
  inputs.pieces[0].bending_stiffness_nm2 = 0.03;
  inputs.pieces[0].torsional_stiffness_nm2 = 0.03;
  return inputs;
}

/// Period between upward zero crossings of a signal, averaged from the first to the last.
inline double mean_period(const std::function<double()>& next, double dt, int steps) {
  double last = next(), first_crossing = -1.0, last_crossing = -1.0;
  int periods = -1;
  for (int i = 1; i < steps; ++i) {
    const double value = next();
    if (last < 0.0 && value >= 0.0) {
      last_crossing = dt * (i - 1 + last / (last - value));
      if (periods < 0) first_crossing = last_crossing;
      ++periods;
    }
    last = value;
  }
  return (last_crossing - first_crossing) / periods;
}

/// A planar elastica in the x-z plane under its own weight, a tip weight and an actuation moment.
struct PlanarElastica {
  double length_m = 0.2, bending_stiffness_nm2 = 0.03, mass_kg = 0.2, payload_kg = 0.0;
  double moment_nm = 0.0;  ///< > 0 bends towards +x
  double gravity_x = 0.0, gravity_z = 0.0;

  /// Points at 0, L/n ... L, by damped Picard iteration of EI theta' = M0 + integral of (r x f) on a fine
  /// grid with Simpson-like averages: no splines, no Newton's method, no code of the rig.
  std::vector<Eigen::Vector2d> solve(int intervals) const {
    const auto n = static_cast<std::size_t>(intervals);
    const double h = length_m / intervals;
    std::vector<double> theta(n + 1, 0.0), curvature(n + 1, moment_nm / bending_stiffness_nm2);
    for (int iteration = 0; iteration < 20000; ++iteration) {
      for (std::size_t i = 0; i < n; ++i)
        theta[i + 1] = theta[i] + 0.5 * h * (curvature[i] + curvature[i + 1]);
      double moment = moment_nm, change = 0.0;
      for (std::size_t i = n + 1; i-- > 0;) {
        if (i < n) {
          // dM/ds = -(t x n)_y; n is the weight beyond s. t = (sin theta, cos theta).
          const double middle = 0.5 * (theta[i] + theta[i + 1]);
          const double beyond = payload_kg + mass_kg * (1.0 - (static_cast<double>(i) + 0.5) / intervals);
          moment += h * beyond * (std::cos(middle) * gravity_x - std::sin(middle) * gravity_z);
        }
        const double target = moment / bending_stiffness_nm2;
        change = std::max(change, std::abs(target - curvature[i]));
        curvature[i] += 0.3 * (target - curvature[i]);
      }
      if (change < 1e-12) break;
    }
    std::vector<Eigen::Vector2d> points{Eigen::Vector2d::Zero()};
    for (std::size_t i = 0; i < n; ++i) {
      const double middle = 0.5 * (theta[i] + theta[i + 1]);
      points.emplace_back(points.back() + h * Eigen::Vector2d(std::sin(middle), std::cos(middle)));
    }
    return points;
  }
};

}  // namespace softarm::rig
