// The online paper's full points method with the load moments as it prints them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "published/published.h"

namespace softarm::app::validate {

struct PrintedFit {
  double moment_nm = 0.0, bending_stiffness_nm2 = 0.0, length_m = 0.0;
  std::vector<Eigen::Vector3d> p_base;  ///< of the model at the measured points
};

/// M0, phi, EI and L at which equations (1)-(6) meet points at i L / K, by least squares
/// (Levenberg-Marquardt).
/// @param points measured, rod's base frame
/// @param start a rod nearby: its payload, weight and mounting are kept
/// @return nothing where the printed iteration has no settled shape
std::optional<PrintedFit> fit_printed(const std::vector<Eigen::Vector3d>& points,
                                      const published::PublishedArm& start, published::LoadLaw law);

}  // namespace softarm::app::validate
