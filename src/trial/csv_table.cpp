#include "csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <utility>

#include "math/parse_number.h"

namespace softarm::trial {
namespace {

constexpr std::size_t kStartBytes = 65536;  // in which a line ends

/// What a file is that is no text of single bytes or UTF-8, and what to do; nothing for such text.
std::optional<std::string> other_than_text(const std::string& start, const std::string& path) {
  const auto begins = [&](const std::string& mark) { return start.compare(0, mark.size(), mark) == 0; };
  if (begins("PK\x03\x04") || begins("\xD0\xCF\x11\xE0"))
    return std::string("is a workbook or an archive, no text: save it as CSV first");
  const bool little = begins("\xFF\xFE"), big = begins("\xFE\xFF");
  const std::size_t zeros = static_cast<std::size_t>(
      std::count(start.begin(), start.begin() + std::min<long>(64, static_cast<long>(start.size())), '\0'));
  if (!little && !big && zeros == 0) return std::nullopt;
  if (!little && !big && zeros * 4 < std::min<std::size_t>(64, start.size()))
    return std::string("holds zero bytes: it is no text of separated numbers; export it as CSV");
  // Without a mark the zeros tell: digits have theirs second (little end first) or first.
  const char* from = little || big ? "UTF-16" : start.front() == '\0' ? "UTF-16BE" : "UTF-16LE";
  return fmt::format("is UTF-16 text, UTF-8 is needed: convert it by iconv -f {} -t UTF-8 {} > utf8.csv",
                     from, path);
}

/// Whatever the locale.
bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

enum class Parsed { kNumber, kNotFinite, kText };

Parsed parse(std::string cell, char decimal, double& value) {
  if (decimal != '.') std::replace(cell.begin(), cell.end(), decimal, '.');
  const std::optional<double> number = math::parse_number(cell);
  if (!number) return Parsed::kText;
  value = *number;
  return std::isfinite(value) ? Parsed::kNumber : Parsed::kNotFinite;
}

}  // namespace

// Cells in quotes may hold the separator, and a quote as two.
void CsvCells::divide(const std::string& line) {
  const bool blanks = separator_ == ' ';
  const auto separates = [&](char c) { return c == separator_ || (blanks && c == '\t'); };
  cells_.assign(1, "");
  bool quoted = false, was_quoted = false;
  const auto end_cell = [&] {
    if (!was_quoted) boost::trim_if(cells_.back(), is_space);
    was_quoted = false;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted) {
      const bool two = c == '"' && i + 1 < line.size() && line[i + 1] == '"';
      if (two) ++i;
      if (c != '"' || two)
        cells_.back() += c;
      else
        quoted = false;
    } else if (c == '"' && boost::all(cells_.back(), is_space)) {
      cells_.back().clear();
      quoted = was_quoted = true;
    } else if (separates(c)) {
      if (blanks && cells_.back().empty() && !was_quoted) continue;
      end_cell();
      cells_.emplace_back();
    } else if (!was_quoted || !is_space(c)) {
      cells_.back() += c;
    }
  }
  end_cell();
  if (blanks && cells_.size() > 1 && cells_.back().empty()) cells_.pop_back();
}

const std::string& CsvCells::text(std::size_t column) const {
  if (column >= cells_.size()) {
    throw CsvBadRow{"too short", fmt::format("{} columns, column {} is needed", cells_.size(), column + 1)};
  }
  return cells_[column];
}

std::optional<double> CsvCells::number(std::size_t column) const {
  const std::string& cell = text(column);
  if (cell.empty()) return std::nullopt;
  double value = 0.0;
  switch (parse(cell, decimal_, value)) {
    case Parsed::kNumber:
      return value;
    case Parsed::kNotFinite:
      return std::nullopt;
    case Parsed::kText:
      break;
  }
  // With a decimal comma it would be one.
  const bool comma = decimal_ == '.' && parse(cell, ',', value) == Parsed::kNumber;
  throw CsvBadRow{"not a number",
                  fmt::format("column {} holds '{}'{}", column + 1, cell.substr(0, 30),
                              comma ? " (with 'decimal: comma' in the layout it is a number)" : "")};
}

std::optional<double> CsvCells::number_if_any(std::size_t column) const {
  double value = 0.0;
  const bool found = column < cells_.size() && parse(cells_[column], decimal_, value) == Parsed::kNumber;
  return found ? std::optional<double>(value) : std::nullopt;
}

CsvTable::CsvTable(std::string path, const CsvFormat& format)
    : CsvCells(format), path_(std::move(path)), format_(format), file_(path_) {
  if (!file_) throw CsvError(fmt::format("{}: cannot be read", path_));
  look_at_start();
  std::string line;
  for (int i = 0; i < format_.skip_lines && get_line(line); ++i) continue;
  if (format_.header) header_ = line_of_words();
  if (format_.units_row) units_ = line_of_words();
}

std::vector<std::string> CsvTable::line_of_words() {
  std::string line;
  if (!get_line(line)) return {};
  take_mark(line);
  divide(line);
  return cells();
}

/// Takes the mark of a comment off a line. @return whether it had one
bool CsvTable::take_mark(std::string& line) const {
  const std::size_t from = line.find_first_not_of(" \t");
  if (format_.separator == '#' || from == std::string::npos || line[from] != '#') return false;
  line.erase(0, line.find_first_not_of("# \t", from));
  return true;
}

void CsvTable::look_at_start() {
  std::string start(kStartBytes, '\0');
  file_.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file_.gcount()));
  if (const auto what = other_than_text(start, path_)) throw CsvError(fmt::format("{}: {}", path_, *what));
  if (start.find('\n') == std::string::npos && start.find('\r') != std::string::npos) line_end_ = '\r';
  file_.clear();
  file_.seekg(0);
}

bool CsvTable::get_line(std::string& line) {
  if (!std::getline(file_, line, line_end_)) return false;
  ++line_;
  bytes_ += line.size() + 1;
  // Spreadsheets put a byte order mark in front.
  if (line_ == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) line.erase(0, 3);
  return true;
}

std::size_t CsvTable::resolve(const CsvColumn& column) const {
  auto found = std::find(header_.begin(), header_.end(), column.label);
  if (std::string label = column.label; found == header_.end() && !header_.empty() && take_mark(label))
    found = header_.front() == label ? header_.begin() : header_.end();  // named with its mark: "# t"
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
  while (next_line()) {
    if (!is_comment_) return true;
  }
  return false;
}

bool CsvTable::next_line() {
  while (get_line(text_)) {
    if (boost::all(text_, is_space)) continue;
    is_comment_ = take_mark(text_);
    divide(text_);
    return true;
  }
  if (file_.bad()) throw CsvError(fmt::format("{}: reading fails after line {}", path_, line_));
  return false;
}

std::string csv_id(const std::string& cell) {
  double value = 0.0;
  return !cell.empty() && parse(cell, '.', value) == Parsed::kNumber ? fmt::format("{}", value) : cell;
}

}  // namespace softarm::trial
