#include "csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <utility>

namespace softarm::trial {
namespace {

void split(const std::string& line, char separator, std::vector<std::string>& cells) {
  if (separator == ' ') {
    const std::string trimmed = boost::trim_copy(line);
    boost::split(cells, trimmed, boost::is_any_of(" \t"), boost::token_compress_on);
  } else {
    boost::split(cells, line, [separator](char c) { return c == separator; });
  }
  for (std::string& cell : cells) boost::trim_if(cell, boost::is_any_of(" \t\r\""));
}

enum class Parsed { kNumber, kNotFinite, kText };

Parsed parse(const std::string& cell, double& value) {
  const char* first = cell.data() + (!cell.empty() && cell.front() == '+' ? 1 : 0);
  const char* last = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(first, last, value);
  if (end != last || error == std::errc::invalid_argument) return Parsed::kText;
  return error != std::errc() || !std::isfinite(value) ? Parsed::kNotFinite : Parsed::kNumber;
}

}  // namespace

CsvTable::CsvTable(std::string path, const CsvFormat& format)
    : path_(std::move(path)), format_(format), file_(path_) {
  if (!file_) throw CsvError(fmt::format("{}: cannot be read", path_));
  std::string line;
  for (int i = 0; i < format_.skip_lines && get_line(line); ++i) continue;
  if (format_.header && get_line(line)) {
    // Spreadsheets put a byte order mark in front.
    if (line.compare(0, 3, "\xEF\xBB\xBF") == 0) line.erase(0, 3);
    split(line, format_.separator, header_);
  }
}

bool CsvTable::get_line(std::string& line) {
  if (!std::getline(file_, line)) return false;
  ++line_;
  bytes_ += line.size() + 1;
  return true;
}

std::size_t CsvTable::resolve(const CsvColumn& column) const {
  const auto found = std::find(header_.begin(), header_.end(), column.label);
  if (found != header_.end()) return static_cast<std::size_t>(found - header_.begin());
  std::size_t index = 0;
  const char* last = column.label.data() + column.label.size();
  const auto [end, error] = std::from_chars(column.label.data(), last, index);
  if (error != std::errc() || end != last || index < 1) {
    throw CsvError(fmt::format("{}: no column '{}' ({} of the layout); the header has {}", path_,
                               column.label, column.key,
                               header_.empty() ? "nothing" : boost::join(header_, ", ")));
  }
  return index - 1;
}

bool CsvTable::next() {
  for (std::string line; get_line(line);) {
    if (line.empty() || line.front() == '#' || boost::all(line, boost::is_space())) continue;
    split(line, format_.separator, cells_);
    return true;
  }
  if (file_.bad()) throw CsvError(fmt::format("{}: reading fails after line {}", path_, line_));
  return false;
}

const std::string& CsvTable::text(std::size_t column) const {
  if (column >= cells_.size()) {
    throw CsvBadRow{"too short", fmt::format("{} columns, column {} is needed", cells_.size(), column + 1)};
  }
  return cells_[column];
}

std::optional<double> CsvTable::number(std::size_t column) const {
  const std::string& cell = text(column);
  if (cell.empty()) return std::nullopt;
  double value = 0.0;
  switch (parse(cell, value)) {
    case Parsed::kNumber:
      return value;
    case Parsed::kNotFinite:
      return std::nullopt;
    case Parsed::kText:
      break;
  }
  throw CsvBadRow{"not a number", fmt::format("column {} holds '{}'", column + 1, cell.substr(0, 30))};
}

std::string csv_id(const std::string& cell) {
  double value = 0.0;
  return !cell.empty() && parse(cell, value) == Parsed::kNumber ? fmt::format("{}", value) : cell;
}

}  // namespace softarm::trial
