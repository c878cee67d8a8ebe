// One large table as a page of its own, in the report's looks: it can be sorted and searched.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softarm/report/report.h"

namespace softarm::report {

/// All texts are shown as they are: nothing in them is taken for HTML.
struct TablePage {
  struct Cell {
    std::string text;
    std::optional<double> number;  ///< by which a column of numbers is sorted
    std::string link;              ///< a path relative to the page; empty: none
  };
  struct Row {
    std::vector<Cell> cells;
    bool marked = false;  ///< stands out: something went wrong
  };
  struct Column {
    enum Kind { kTexts, kWide, kNumbers };
    std::string heading;
    Kind kind = kTexts;  ///< wide: of whole sentences
  };

  std::string title;                                         ///< "Batch: diagnose"
  std::string kicker;                                        ///< above it
  std::string verdict;                                       ///< beside it, in a frame: "38 of 40 done"
  bool whole = true;                                         ///< whether that is all that was asked for
  std::vector<std::pair<std::string, std::string>> figures;  ///< a value, and what it is
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< paragraphs below
};

/// The page's files: config/report/table.html and what it names.
/// @throws std::runtime_error naming the file that cannot be read
PageFiles read_table_page_files(const std::filesystem::path& folder);

/// @throws std::invalid_argument if table.html has a place that nothing fills
std::string to_html(const TablePage& page, const PageFiles& files);

}  // namespace softarm::report
