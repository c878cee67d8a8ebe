#include "table.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <filesystem>
#include <map>

#include "../command.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

/// As RFC 4180 has it.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return "\"" + boost::replace_all_copy(text, "\"", "\"\"") + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : ",") + csv_cell(cells[i]);
  return line + "\n";
}

/// Every figure that some job has, in the order in which they come.
std::vector<Figure> columns_of(const std::vector<TableRow>& rows) {
  std::vector<Figure> columns;
  for (const TableRow& row : rows)
    for (const Figure& figure : row.figures)
      if (std::none_of(columns.begin(), columns.end(),
                       [&](const Figure& c) { return c.column == figure.column; }))
        columns.push_back(figure);
  // One that has a number somewhere is a column of numbers.
  for (Figure& column : columns)
    for (const TableRow& row : rows)
      for (const Figure& figure : row.figures)
        if (figure.column == column.column && figure.number) column.number = figure.number;
  return columns;
}

const Figure* figure_in(const TableRow& row, const std::string& column) {
  const auto found = std::find_if(row.figures.begin(), row.figures.end(),
                                  [&](const Figure& figure) { return figure.column == column; });
  return found == row.figures.end() ? nullptr : &*found;
}

std::string words_of(const std::vector<Word>& options) {
  std::vector<std::string> words;
  for (const Word& option : options) words.push_back(option.name + (option.value ? " " + *option.value : ""));
  return boost::join(words, " ");
}

std::string names_of(const std::vector<std::string>& bags) {
  std::vector<std::string> names;
  for (const std::string& bag : bags) names.push_back(fs::path(bag).filename().string());
  return boost::join(names, " ");
}

std::string duration(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.1f} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.1f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

/// Behind a heading; it stays on one line.
std::string with_unit(const std::string& unit) {
  return unit.empty() ? "" : " " + boost::replace_all_copy("/ " + unit, " ", "\xC2\xA0");
}

report::TablePage::Cell cell_of(const Figure* figure) {
  if (figure == nullptr) return {};
  if (!figure->number) return {figure->text, std::nullopt, ""};
  return {fmt::format("{:.4g}", *figure->number * figure->scale), figure->number, ""};
}

report::TablePage::Row page_row(const TableRow& row, const std::vector<Figure>& columns) {
  report::TablePage::Row shown;
  shown.marked = row.state == "failed";
  shown.cells.push_back({row.name, std::nullopt, row.page});
  shown.cells.push_back({row.state, std::nullopt, row.log});
  shown.cells.push_back({row.reason, std::nullopt, ""});
  for (const Figure& column : columns) shown.cells.push_back(cell_of(figure_in(row, column.column)));
  shown.cells.push_back({fs::path(row.job.arm).stem().string(), std::nullopt, ""});
  shown.cells.push_back({names_of(row.job.bags), std::nullopt, ""});
  shown.cells.push_back({words_of(row.job.options), std::nullopt, ""});
  const bool ran = row.seconds > 0.0;
  shown.cells.push_back({ran ? fmt::format("{:.1f}", row.seconds) : "",
                         ran ? std::optional<double>(row.seconds) : std::nullopt, ""});
  shown.cells.push_back({ran ? fmt::format("{:.0f}", 1e-6 * row.peak_memory_bytes) : "",
                         ran ? std::optional<double>(row.peak_memory_bytes) : std::nullopt, ""});
  return shown;
}

/// Columns of the page in which no row says anything go.
void drop_empty_columns(report::TablePage& page) {
  for (std::size_t c = page.columns.size(); c-- > 2;) {
    if (std::any_of(page.rows.begin(), page.rows.end(),
                    [&](const report::TablePage::Row& row) { return !row.cells[c].text.empty(); }))
      continue;
    page.columns.erase(page.columns.begin() + static_cast<std::ptrdiff_t>(c));
    for (report::TablePage::Row& row : page.rows)
      row.cells.erase(row.cells.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

/// How often each verdict, or whatever sums up this command, is there.
std::vector<std::pair<std::string, std::string>> counts(const std::string& column,
                                                        const std::vector<TableRow>& rows) {
  std::map<std::string, std::size_t> counted;
  for (const TableRow& row : rows)
    if (const Figure* figure = figure_in(row, column))
      ++counted[boost::replace_all_copy(figure->text, "_", " ")];
  std::vector<std::pair<std::string, std::string>> figures;
  for (const auto& [word, count] : counted) figures.emplace_back(std::to_string(count), word);
  return figures;
}

}  // namespace

TableRow row_of(const Job& job, const JobFolder& folder) {
  TableRow row;
  row.job = job;
  row.name = folder.name();
  const std::optional<Outcome> outcome = folder.outcome();
  row.state = !outcome ? "open" : outcome->done ? "done" : "failed";
  if (!outcome) return row;
  row.reason = outcome->reason;
  row.seconds = outcome->seconds;
  row.core_seconds = outcome->core_seconds;
  row.peak_memory_bytes = outcome->peak_memory_bytes;
  const fs::path below = fs::path("jobs") / row.name;
  std::error_code error;
  if (fs::is_regular_file(folder.log(), error)) row.log = (below / folder.log().filename()).string();
  if (!outcome->done) return row;
  try {
    row.figures = figures_of(job, folder);
    if (const std::string page = page_of(job, folder); !page.empty()) row.page = (below / page).string();
  } catch (const Failure& failure) {
    row.state = "failed";
    row.reason = failure.what();
  }
  return row;
}

std::string to_csv(const std::vector<TableRow>& rows) {
  const std::vector<Figure> columns = columns_of(rows);
  std::vector<std::string> head{"job", "state"};
  for (const Figure& column : columns) head.push_back(column.column);
  for (const char* last : {"reason", "arm", "bags", "options", "result"}) head.emplace_back(last);
  std::string text = csv_line(head);
  for (const TableRow& row : rows) {
    std::vector<std::string> cells{row.name, row.state};
    for (const Figure& column : columns) {
      const Figure* figure = figure_in(row, column.column);
      cells.push_back(figure == nullptr ? ""
                      : figure->number  ? fmt::format("{:.9g}", *figure->number)
                                        : figure->text);
    }
    cells.insert(cells.end(),
                 {row.reason, row.job.arm, boost::join(row.job.bags, " "), words_of(row.job.options),
                  row.state == "done" ? (fs::path("jobs") / row.name / "result").string() : ""});
    text += csv_line(cells);
  }
  return text;
}

report::TablePage table_page(const std::string& work, const std::vector<TableRow>& rows,
                             const std::string& kicker) {
  report::TablePage page;
  page.title = fmt::format("{} of {} {}",
                           work == "check"      ? "Checks"
                           : work == "diagnose" ? "Diagnoses"
                                                : "Estimates",
                           rows.size(), work == "diagnose" ? "arms" : "trials");
  page.kicker = kicker;
  std::size_t done = 0, failed = 0;
  double seconds = 0.0, core_seconds = 0.0, longest = 0.0, memory = 0.0;
  for (const TableRow& row : rows) {
    done += row.state == "done";
    failed += row.state == "failed";
    seconds += row.seconds;
    core_seconds += row.core_seconds;
    longest = std::max(longest, row.seconds);
    memory = std::max(memory, row.peak_memory_bytes);
  }
  page.whole = done == rows.size();
  page.verdict = fmt::format("{} of {} done", done, rows.size());
  if (failed > 0) page.figures.emplace_back(std::to_string(failed), "failed");
  for (const auto& figure : counts(work == "check" ? "worst" : "verdict", rows))
    page.figures.push_back(figure);
  page.figures.emplace_back(duration(core_seconds), "of processor time");
  page.figures.emplace_back(duration(longest), "the longest job");
  page.figures.emplace_back(fmt::format("{:.0f} MB", 1e-6 * memory), "the most memory of a job");
  const std::vector<Figure> columns = columns_of(rows);
  page.columns = {{"job"}, {"state"}, {"why", report::TablePage::Column::kWide}};
  for (const Figure& column : columns)
    page.columns.push_back(
        {column.heading + with_unit(column.unit),
         column.number ? report::TablePage::Column::kNumbers : report::TablePage::Column::kTexts});
  for (const char* heading : {"arm", "bags", "options"}) page.columns.push_back({heading});
  page.columns.push_back({"time" + with_unit("s"), report::TablePage::Column::kNumbers});
  page.columns.push_back({"memory" + with_unit("MB"), report::TablePage::Column::kNumbers});
  for (const TableRow& row : rows) page.rows.push_back(page_row(row, columns));
  drop_empty_columns(page);
  page.notes = {
      "A click on a heading sorts. A job's name leads to its result, its state to what the command said.",
      "batch.csv beside this page has the same in SI units, with whole paths."};
  return page;
}

}  // namespace softarm::app::batch
