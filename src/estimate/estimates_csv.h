// Estimates as the rows of estimates.csv.
#pragma once

#include <cstddef>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "softarm/estimate/estimator.h"

namespace softarm::estimate {

/// What a row of estimates.csv is about: one segment of one frame.
struct EstimateRow {
  const Estimate& frame;
  const SegmentEstimate& segment;  ///< all absent where the frame has none
  std::size_t number = 1;          ///< of the segment, counted from the base
};

/// A column of estimates.csv; doc/estimates_csv.md has the same rows.
struct EstimateColumn {
  const char* name;
  const char* unit;  ///< SI; empty: none
  const char* meaning;
  void (*append)(std::string& cell, const EstimateRow& row);  ///< nothing where the value does not exist
};

/// In the order of the file. Readers may count: a new one stands at the end.
const std::vector<EstimateColumn>& estimate_columns();

/// The first line of estimates.csv, without a line end.
std::string estimates_csv_header();

/// Writes the rows of one frame, one per segment of the arm.
/// @param segments number of segments of the arm: a frame without estimate has a row for each, too
void write_estimate_rows(std::ostream& out, const Estimate& estimate, std::size_t segments);

/// Angle (rad, 0 to pi) between the tangents at base and tip; absent without a backbone.
std::optional<double> tip_angle_rad(const Estimate& estimate);

}  // namespace softarm::estimate
