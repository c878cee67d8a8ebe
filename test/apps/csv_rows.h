// Tables that the program writes, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace softarm {

using Row = std::map<std::string, std::string>;

/// Rows of a CSV file by column name.
inline std::vector<Row> csv_rows(const std::string& path) {
  std::vector<Row> rows;
  std::vector<std::string> names;
  std::istringstream file(text_of(path));
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> cells;
    boost::split(cells, line, [](char c) { return c == ','; });
    if (names.empty()) {
      names = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), names.size()) << path << ": " << line;
    Row row;
    for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace softarm
