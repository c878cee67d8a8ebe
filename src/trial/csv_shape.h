// What the lines of a file look like, and its numbers: what a layout is guessed from.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "csv_layout.h"

namespace softarm::trial {

/// The numbers of one column; NaN where a row has none.
struct CsvNumbers {
  std::string name;  ///< of the header; empty without
  std::string unit;  ///< of the row of units, or in brackets in the name, as csv_unit; empty without
  std::vector<double> values;

  // Of the finite ones:
  double low = 0.0, high = 0.0;  ///< 1 and 99 % quantiles
  double level = 0.0;            ///< median of the first values
  double mean = 0.0, median_step = 0.0;
  std::size_t count = 0, distinct = 0;
  bool increases = false;  ///< from each value to the next
  bool never_falls = false;

  bool is_constant() const { return distinct <= 1; }
};

struct CsvShape {
  CsvFormat format;
  std::size_t rows = 0;             ///< that were looked at
  std::vector<CsvNumbers> columns;  ///< in the file's order
};

/// Reads a file whose separator, decimal sign and header nobody has named: those by which most of its cells
/// are numbers, in rows of equal length.
/// @throws CsvError where it cannot be read, or no rows of numbers are found in it
CsvShape read_shape(const std::string& path);

}  // namespace softarm::trial
