#include "csv_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "csv_table.h"
#include "csv_units.h"
#include "math/statistics.h"

namespace softarm::trial {
namespace {

constexpr std::size_t kRowsForFormat = 200;
constexpr std::size_t kMostRows = 50000;  // hours at the rates of mocap; the rest says nothing new
constexpr std::size_t kFirstValues = 15;  // whose median is the level at first
constexpr double kMostNumbers = 0.6;      // of the cells of a row of data: the others may be empty or text
constexpr double kFewQuantile = 0.01;     // of values that are none, such as single zeros

std::size_t numbers_in(const CsvCells& line) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < line.cells().size(); ++c) count += line.number_if_any(c).has_value();
  return count;
}

std::size_t cells_in(const CsvCells& line) {
  const std::size_t count = line.cells().size();
  // A separator at the end of the line makes no column.
  return count > 1 && line.cells().back().empty() ? count - 1 : count;
}

bool is_data(std::size_t numbers, std::size_t cells) {
  return static_cast<double>(numbers) > kMostNumbers * static_cast<double>(cells);
}

bool is_data(const CsvCells& line) {
  return is_data(numbers_in(line), cells_in(line));
}

/// Rows from the start of a file, undivided.
std::vector<std::string> first_rows(const std::string& path) {
  std::vector<std::string> rows;
  CsvTable table(path, CsvFormat{});
  while (rows.size() < kRowsForFormat && table.next()) rows.push_back(table.line_text());
  return rows;
}

/// How many numbers the rows of data have together, as read in a format; 0 where rows differ in length.
double numbers_by(const std::vector<std::string>& rows, const CsvFormat& format) {
  CsvCells line(format);
  std::map<std::size_t, std::size_t> lengths;
  std::size_t all_numbers = 0, all_cells = 0, data = 0;
  for (const std::string& row : rows) {
    line.divide(row);
    const std::size_t numbers = numbers_in(line), cells = cells_in(line);
    if (!is_data(numbers, cells)) continue;
    ++data;
    ++lengths[cells];
    all_numbers += numbers;
    all_cells += cells;
  }
  if (lengths.empty()) return 0.0;
  std::size_t usual = 0;
  for (const auto& [length, count] : lengths) usual = std::max(usual, count);
  // Numbers count twice where nothing else is in the rows: "1,5;2,5" is two numbers by the one format, and
  // two of four cells by another.
  return 10 * usual < 9 * data ? 0.0 : std::pow(all_numbers, 2) / static_cast<double>(all_cells);
}

/// Each character once, in the order in which they come.
std::string characters_of(const std::vector<std::string>& rows) {
  std::string characters;
  for (const std::string& row : rows) {
    for (const char c : row)
      if (characters.find(c) == std::string::npos) characters += c;
  }
  return characters;
}

/// Those of most files, and any other one character of this one that a layout may name. Of those that are not
/// in it one is enough: all make one cell of a row.
std::string possible_separators(const std::string& characters) {
  std::string separators;
  bool has_absent = false;
  for (const std::string usual : {",", ";", "\t", "|", ":", " \t"}) {
    const bool is_there = characters.find_first_of(usual) != std::string::npos;
    if (is_there || !std::exchange(has_absent, true)) separators += usual.front();
  }
  for (const char c : characters) {
    if (std::isprint(static_cast<unsigned char>(c)) && may_separate(c) &&
        separators.find(c) == std::string::npos)
      separators += c;
  }
  return separators;
}

CsvFormat find_format(const std::string& path) {
  const std::vector<std::string> rows = first_rows(path);
  const std::string characters = characters_of(rows);
  const std::string decimals = characters.find(',') == std::string::npos ? "." : ".,";
  CsvFormat best;
  double most = 0.0;
  for (const char separator : possible_separators(characters)) {
    for (const char decimal : decimals) {
      CsvFormat format;
      format.separator = separator;
      format.decimal = decimal;
      const double numbers = numbers_by(rows, format);
      if (numbers > most * (1.0 + 1e-9)) {
        most = numbers;
        best = format;
      }
    }
  }
  if (most == 0.0) throw CsvError(fmt::format("{}: no rows of numbers are found in it", path));
  return best;
}

/// A line of text before the data.
struct TextLine {
  std::uint64_t number = 0;
  std::vector<std::string> cells;
  bool is_comment = false, fits = false;  ///< fits: has as many cells as the data
};

constexpr std::size_t kMostText = 50;  // lines before the data in which a header is looked for

std::vector<TextLine> lines_before_data(CsvTable& table) {
  std::vector<TextLine> lines;
  std::vector<std::size_t> lengths;
  while (table.next_line()) {
    if (!table.is_comment() && is_data(table)) break;
    lengths.push_back(cells_in(table));
    lines.push_back({table.line(), table.cells(), table.is_comment(), false});
    if (lines.size() > kMostText) {
      lines.erase(lines.begin());
      lengths.erase(lengths.begin());
    }
  }
  // The last of the names may be that of a column that is empty.
  for (std::size_t i = 0; i < lines.size(); ++i)
    lines[i].fits = lengths[i] == cells_in(table) || lines[i].cells.size() == table.cells().size();
  return lines;
}

/// The header, the row of units below it, and the lines to pass over before them, or before the data. A
/// header may be a comment, where it is the last.
void find_header(const std::string& path, CsvFormat* format) {
  CsvTable table(path, *format);
  const std::vector<TextLine> lines = lines_before_data(table);
  const auto last_text =
      std::find_if(lines.rbegin(), lines.rend(), [](const TextLine& l) { return !l.is_comment; });
  const bool of_text = last_text != lines.rend() && last_text->fits;
  if (!of_text && (lines.empty() || !lines.back().fits)) {
    if (last_text != lines.rend()) format->skip_lines = static_cast<int>(table.line()) - 1;
    return;
  }
  std::size_t at = of_text ? static_cast<std::size_t>(lines.rend() - last_text) - 1 : lines.size() - 1;
  const auto units_below = [&](std::size_t i) {
    return i + 1 < lines.size() && lines[i + 1].fits && lines[i + 1].number == lines[i].number + 1 &&
           is_units_row(lines[i + 1].cells) && !is_units_row(lines[i].cells);
  };
  if (at > 0 && lines[at - 1].fits && units_below(at - 1)) --at;
  format->header = true;
  format->units_row = units_below(at);
  format->skip_lines = static_cast<int>(lines[at].number) - 1;
}

void summarise(CsvNumbers* column) {
  std::vector<double> finite, steps;
  for (const double x : column->values) {
    if (!std::isfinite(x)) continue;
    if (!finite.empty()) steps.push_back(x - finite.back());
    finite.push_back(x);
  }
  column->count = finite.size();
  if (finite.empty()) return;
  column->distinct = std::set<double>(finite.begin(), finite.end()).size();
  column->level = math::median(
      {finite.begin(), finite.begin() + static_cast<std::ptrdiff_t>(std::min(finite.size(), kFirstValues))});
  for (const double x : finite) column->mean += x / static_cast<double>(finite.size());
  column->increases =
      !steps.empty() && std::all_of(steps.begin(), steps.end(), [](double d) { return d > 0.0; });
  column->never_falls =
      !steps.empty() && std::all_of(steps.begin(), steps.end(), [](double d) { return d >= 0.0; });
  column->median_step = math::median(steps);
  column->low = math::quantile(finite, kFewQuantile);
  column->high = math::quantile(finite, 1.0 - kFewQuantile);
}

}  // namespace

CsvShape read_shape(const std::string& path) {
  CsvShape shape;
  shape.format = find_format(path);
  find_header(path, &shape.format);
  CsvTable table(path, shape.format);
  while (shape.rows < kMostRows && table.next()) {
    if (!is_data(table)) continue;
    if (shape.columns.empty()) {
      const std::size_t cells = cells_in(table);
      const bool more = table.header().size() > cells && !table.header()[cells].empty();
      shape.columns.resize(more ? cells + 1 : cells);
      for (std::size_t c = 0; c < shape.columns.size() && c < table.header().size(); ++c)
        shape.columns[c].name = table.header()[c];
      for (std::size_t c = 0; c < shape.columns.size(); ++c)
        shape.columns[c].unit =
            c < table.units().size() ? csv_unit(table.units()[c]) : unit_in_brackets(shape.columns[c].name);
    }
    ++shape.rows;
    for (std::size_t c = 0; c < shape.columns.size(); ++c) {
      const std::optional<double> value = table.number_if_any(c);
      shape.columns[c].values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  for (CsvNumbers& column : shape.columns) summarise(&column);
  return shape;
}

}  // namespace softarm::trial
