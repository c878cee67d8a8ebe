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

#include "csv_layout.h"
#include "stamp.h"

namespace softarm::trial {

/// Pose of a body in a mocap frame whose z axis points up, SI.
struct CsvPose {
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> q_mocap;  ///< unit; absent: only the position was measured
};

/// One row. Entries are in the order of the layout; what the row does not have is absent.
struct CsvRow {
  double time_s = 0.0;  ///< as recorded
  Stamp stamp;          ///< time_s + CsvLayout::start_stamp_s
  std::vector<std::optional<CsvPose>> bodies;
  std::vector<std::optional<double>> pressures_pa;  ///< absolute
  std::vector<std::optional<double>> scalars;       ///< rad or N
  std::optional<double> payload_kg;                 ///< of the layout's payload column
  std::string trial;                                ///< of the layout's trial column; else empty
};

/// What became of a joined inputs file.
struct CsvJoinReport {
  std::uint64_t rows = 0;
  std::map<std::string, std::uint64_t> bad_rows;  ///< by reason: no id, id given twice, not a number ...
  std::uint64_t unmatched = 0;                    ///< rows of the recording whose id it lacks
  std::uint64_t unused_ids = 0;                   ///< ids that no row of the recording has
  std::vector<std::string> examples;
};

/// What became of the rows of a file.
struct CsvReport {
  std::uint64_t rows = 0;                         ///< rows of data, good or bad
  std::uint64_t used = 0;                         ///< rows that were delivered
  std::map<std::string, std::uint64_t> bad_rows;  ///< skipped rows by reason
  std::map<std::string, std::uint64_t> lost;      ///< absent values by reason: "tip: not a number"
  std::uint64_t one_clock_only = 0;   ///< poses or inputs of rows that the other clock has no time for
  std::uint64_t repeated = 0;         ///< rows whose poses only repeat the last row (drop_repeated)
  std::vector<std::string> examples;  ///< "file:line: what", the first few
  std::optional<CsvJoinReport> join;
};

/// What else a recording is read with.
struct CsvSources {
  std::string inputs_path;  ///< the file of CsvLayout::join; empty where the layout has none
  std::function<void(std::uint64_t)> on_bytes;  ///< bytes of the recording read since the last call
};

/// Reads a recording. Columns of a joined inputs file are absent in rows whose id it does not have exactly
/// once. A row that is too short, that holds text where a number belongs, or whose time does not advance,
/// without an id or with one that was there before, is skipped and reported; an empty, non-finite or
/// (orientation) all-zero cell means that the value is absent.
/// @param path the recording
/// @param on_row called for each good row, in order
/// @throws CsvError if a file cannot be read, has no rows, lacks a column, if more than half of its rows are
/// bad or lack their inputs, if a trial comes a second time, or if the layout joins inputs and there is no
/// file or the reverse
CsvReport read_csv_recording(const CsvLayout& layout, const std::string& path,
                             const std::function<void(const CsvRow&)>& on_row,
                             const CsvSources& sources = {});

}  // namespace softarm::trial
