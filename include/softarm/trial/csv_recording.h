// Reads a CSV recording row by row as its layout says.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "softarm/trial/csv_layout.h"

namespace softarm {

/// Pose of a body in a mocap frame whose z axis points up, SI.
struct CsvPose {
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_mocap = Eigen::Quaterniond::Identity();  ///< unit
};

/// One row. Entries are in the order of the layout; what the row does not have is absent.
struct CsvRow {
  double time_s = 0.0;   ///< as recorded
  double stamp_s = 0.0;  ///< time_s + CsvLayout::start_stamp_s
  std::vector<std::optional<CsvPose>> bodies;
  std::vector<std::optional<double>> pressures_pa;  ///< absolute
};

/// What became of the rows of a file.
struct CsvReport {
  std::uint64_t rows = 0;                         ///< rows of data, good or bad
  std::uint64_t used = 0;                         ///< rows that were delivered
  std::map<std::string, std::uint64_t> bad_rows;  ///< skipped rows by reason
  std::map<std::string, std::uint64_t> lost;      ///< absent values by reason: "tip: not a number"
  std::uint64_t repeated = 0;         ///< rows whose poses only repeat the last row (drop_repeated)
  std::vector<std::string> examples;  ///< "file:line: what", the first few
};

/// Reads a recording. A row that is too short, that holds text where a number belongs, or whose time does not
/// advance is skipped and reported; an empty, non-finite or (orientation) all-zero cell means that the value
/// is absent.
/// @param path the recording
/// @param on_row called for each good row, in order
/// @throws CsvError if the file cannot be read, has no rows, lacks a column, or if more than half of its rows
/// are bad
CsvReport read_csv_recording(const CsvLayout& layout, const std::string& path,
                             const std::function<void(const CsvRow&)>& on_row);

}  // namespace softarm
