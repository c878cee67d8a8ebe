// What a validation yields: tables for people and programs, series for plots.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "softarm/progress.h"

namespace softarm::app::validate {

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// A figure of ours: as it is printed, and the number behind it.
struct Cell {
  std::string text;
  std::optional<double> value;
};

/// @param format of fmt for the printed text, say "{:.2f} %"
Cell cell(const char* format, double value);

struct Row {
  std::string quantity;
  std::string published;   ///< as printed in the paper; empty: the paper has none
  std::vector<Cell> ours;  ///< one per Table::columns
  std::string remark;
};

struct Table {
  std::string id;     ///< "online.table_2"
  std::string title;  ///< one line: which table or figure of the paper
  std::vector<std::string> columns;
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< paragraphs below the table
};

/// Numbers for a plot, one CSV file.
struct Series {
  std::string name;  ///< file name without ending
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// One paper's tables.
struct Result {
  std::string name;   ///< as on the command line
  std::string paper;  ///< its title
  std::vector<Table> tables;
  std::vector<Series> series;
};

/// What every validation is given.
struct Settings {
  std::uint64_t seed = 1;
  bool quick = false;  ///< fewer conditions: a look, not the figures of the documentation
  unsigned jobs = 1;
};

std::string to_text(const Result& result);
nlohmann::json to_json(const Result& result);
std::string to_csv(const Series& series);

}  // namespace softarm::app::validate
