#include "csv_join.h"

#include <fmt/format.h>

#include "csv_table.h"

namespace softarm::trial {

CsvJoin::CsvJoin(const CsvJoinLayout& layout, const std::string& path, const std::vector<CsvColumn>& columns)
    : path_(path) {
  CsvTable table(path, layout.format);
  const std::size_t id_column = table.resolve(layout.inputs_id);
  std::vector<std::size_t> indices;
  for (const CsvColumn& column : columns) indices.push_back(table.resolve(column));
  std::string first_bad;
  std::uint64_t bad = 0;
  while (table.next()) {
    ++report_.rows;
    try {
      if (table.text(id_column).empty())
        throw CsvBadRow{"no id", fmt::format("column {} is empty", id_column + 1)};
      Entry entry;
      for (const std::size_t i : indices) entry.values.push_back(table.number(i));
      const auto [place, is_new] = entries_.emplace(csv_id(table.text(id_column)), std::move(entry));
      if (is_new) continue;
      // Two rows claim it: whichever were taken, it might be the wrong one.
      place->second.ambiguous = true;
      throw CsvBadRow{"id given twice", fmt::format("'{}', no inputs are taken for it", place->first)};
    } catch (const CsvBadRow& row) {
      ++report_.bad_rows[row.reason];
      const std::string what = fmt::format("{}:{}: {}: {}", path_, table.line(), row.reason, row.what);
      if (++bad == 1) first_bad = what;
      if (report_.examples.size() < 2) report_.examples.push_back(what);
    }
  }
  if (report_.rows == 0) throw CsvError(fmt::format("{}: no rows of data", path_));
  if (2 * bad > report_.rows)
    throw CsvError(fmt::format("{}: {} of {} rows cannot be used (first: {}); does the layout fit this file?",
                               path_, bad, report_.rows, first_bad));
}

const std::vector<std::optional<double>>* CsvJoin::find(const std::string& id) {
  const auto found = entries_.find(csv_id(id));
  if (found == entries_.end()) return nullptr;
  found->second.used = true;
  return found->second.ambiguous ? nullptr : &found->second.values;
}

CsvJoinReport CsvJoin::report() const {
  CsvJoinReport report = report_;
  for (const auto& [id, entry] : entries_) report.unused_ids += entry.used ? 0 : 1;
  return report;
}

}  // namespace softarm::trial
