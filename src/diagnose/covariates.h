// What the parameters of single instants are held against.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "instant_fits.h"

namespace softarm::diagnose {

/// One instant of the grid that all parameters and covariates share.
struct GridPoint {
  std::size_t trial = 0, block = 0;
  const InstantFit* fit = nullptr;  ///< null: none, but it keeps the rhythm
};

/// Something that the arm's parameters ought not to go with.
struct Covariate {
  static constexpr std::size_t kBins = 6;

  std::string name, unit;
  std::vector<double> x;       ///< by point
  std::vector<int> bin;        ///< by point, 0 ... kBins
  std::vector<double> middle;  ///< of x, by bin
};

/// The law's moment, its rate, history and direction, pressure, vacuum, payload, attitude, time, the trial:
/// those that differ between points.
/// @param arm with the constants of the fit
std::vector<Covariate> covariates_of(const JointModel& model, const arm::Arm& arm, const Linearised& at,
                                     const std::vector<GridPoint>& points);

}  // namespace softarm::diagnose
