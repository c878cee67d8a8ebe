#include "table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace softarm::app::validate {
namespace {

constexpr std::size_t kRemarkWidth = 60, kNoteWidth = 110;

/// Number of characters, not of bytes: the texts hold Greek letters and signs.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, width_of(text)), ' ');
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    if (!lines.back().empty() && width_of(lines.back()) + 1 + width_of(word) > width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    start = end + 1;
  }
  return lines;
}

std::string without_trailing_blanks(std::string line) {
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line + "\n";
}

std::string to_text(const Table& table) {
  std::vector<std::vector<std::string>> cells{{"quantity", "published"}};
  for (const std::string& column : table.columns) cells.front().push_back(column);
  for (const Row& row : table.rows) {
    cells.push_back({row.quantity, row.published});
    for (const Cell& ours : row.ours) cells.back().push_back(ours.text);
  }
  std::vector<std::size_t> widths(cells.front().size(), 0);
  for (const auto& row : cells) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  std::size_t before_remark = 0;
  for (std::size_t width : widths) before_remark += width + 2;

  std::string text = fmt::format("{}\n", table.title);
  for (std::size_t r = 0; r < cells.size(); ++r) {
    std::string line;
    for (std::size_t i = 0; i < widths.size(); ++i)
      line += padded(i < cells[r].size() ? cells[r][i] : "", widths[i] + 2);
    const std::vector<std::string> remark =
        wrapped(r == 0 ? std::string("remark") : table.rows[r - 1].remark, kRemarkWidth);
    for (std::size_t i = 0; i < remark.size(); ++i)
      text += without_trailing_blanks((i == 0 ? line : std::string(before_remark, ' ')) + remark[i]);
  }
  for (const std::string& note : table.notes) {
    for (const std::string& line : wrapped(note, kNoteWidth)) text += "  " + line + "\n";
  }
  return text;
}

}  // namespace

Cell cell(const char* format, double value) {
  if (!std::isfinite(value)) return {"none", std::nullopt};
  return {fmt::vformat(format, fmt::make_format_args(value)), value};
}

std::string to_text(const Result& result) {
  std::string text = fmt::format("=== {}: {}\n", result.name, result.paper);
  for (const Table& table : result.tables) text += "\n" + to_text(table);
  return text;
}

nlohmann::json to_json(const Result& result) {
  nlohmann::json tables = nlohmann::json::array();
  for (const Table& table : result.tables) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Row& row : table.rows) {
      nlohmann::json ours = nlohmann::json::object();
      for (std::size_t i = 0; i < row.ours.size(); ++i) {
        nlohmann::json& entry = ours[table.columns[i]];
        entry["text"] = row.ours[i].text;
        if (row.ours[i].value) entry["value"] = *row.ours[i].value;
      }
      rows.push_back(
          {{"quantity", row.quantity}, {"published", row.published}, {"ours", ours}, {"remark", row.remark}});
    }
    tables.push_back({{"id", table.id},
                      {"title", table.title},
                      {"rows", rows},
                      {"notes", table.notes},
                      {"text", to_text(table)}});
  }
  return {{"name", result.name}, {"paper", result.paper}, {"tables", tables}};
}

std::string to_csv(const Series& series) {
  std::string text = fmt::format("{}\n", fmt::join(series.columns, ","));
  for (const std::vector<double>& row : series.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) text += ',';
      if (std::isfinite(row[i])) fmt::format_to(std::back_inserter(text), "{:.9g}", row[i]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace softarm::app::validate
