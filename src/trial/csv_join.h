// The columns of an inputs file, found by the id of a recording's row.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "csv_layout.h"
#include "csv_recording.h"

namespace softarm::trial {

/// An inputs file in memory.
class CsvJoin {
 public:
  /// @param columns those of the layout that stand in the inputs file
  /// @throws CsvError if it cannot be read, lacks a column, has no rows, or if more than half of them are bad
  CsvJoin(const CsvJoinLayout& layout, const std::string& path, const std::vector<CsvColumn>& columns);

  /// The row of an id, in the order of the columns; nullptr where the file has none or more than one.
  const std::vector<std::optional<double>>* find(const std::string& id);

  /// What became of the file's rows; ids that nobody asked for are counted up to now.
  CsvJoinReport report() const;
  const std::string& path() const { return path_; }

 private:
  struct Entry {
    std::vector<std::optional<double>> values;
    bool ambiguous = false, used = false;
  };
  std::string path_;
  std::unordered_map<std::string, Entry> entries_;
  CsvJoinReport report_;
};

}  // namespace softarm::trial
