// Estimates as the rows of estimates.csv.
#pragma once

#include <cstddef>
#include <optional>
#include <ostream>

#include "softarm/estimate/estimate.h"

namespace softarm::estimate {

/// The columns of estimates.csv, SI (N m, rad, N m^2, m, kg): one row per frame and segment. Without a line
/// end.
inline constexpr const char* kEstimatesCsvHeader =
    "stamp,segment,status,M0,phi,EI,L,payload,sd_M0,sd_phi,sd_EI,sd_L,sd_payload,identifiable_EI,"
    "identifiable_payload,"
    "theta_tip,tip_x,tip_y,tip_z,rms_residual";

/// Writes the rows of one frame, one per segment of the arm, counted from 1 at the base.
///
/// A cell is empty where its value does not exist: neither estimated nor known, or no estimate at all.
/// theta_tip is the angle (rad) between the tangents at the arm's base and tip; tip_x, tip_y, tip_z (m) are
/// in the rod's base frame. Numbers have nine significant digits, stamps 1e-7 s, which is what a double holds
/// of a date.
/// @param segments number of segments of the arm: a frame without estimate has a row for each, too
void write_estimate_rows(std::ostream& out, const Estimate& estimate, std::size_t segments);

/// Angle (rad, 0 to pi) between the tangents at base and tip; absent without a backbone.
std::optional<double> tip_angle_rad(const Estimate& estimate);

}  // namespace softarm::estimate
