// Lines of a separated text file as cells and numbers.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "csv_layout.h"

namespace softarm::trial {

/// Thrown for a row that is skipped; the reason is also its key in the reports.
struct CsvBadRow {
  std::string reason;
  std::string what;
};

/// One line, divided as a format says.
class CsvCells {
 public:
  explicit CsvCells(const CsvFormat& format) : separator_(format.separator), decimal_(format.decimal) {}

  void divide(const std::string& line);
  const std::vector<std::string>& cells() const { return cells_; }

  /// Text of a cell. @throws CsvBadRow where the line is too short
  const std::string& text(std::size_t column) const;
  /// @return the number, or nothing for an empty or non-finite cell
  /// @throws CsvBadRow where the line is too short or the cell holds text
  std::optional<double> number(std::size_t column) const;
  /// The same, with nothing for text and for a cell that is not there, too.
  std::optional<double> number_if_any(std::size_t column) const;

 private:
  char separator_, decimal_;
  std::vector<std::string> cells_;
};

/// Rows of data of one file, after its header; the cells are those of the line where it is. Blank lines and
/// comments are passed over: lines that start with #, unless that is the separator. A header may be a
/// comment, as gnuplot and numpy write it. Lines end in LF, CR LF or, where a file has no LF, in CR.
class CsvTable : public CsvCells {
 public:
  /// @throws CsvError if it cannot be read, or is no text of single bytes or UTF-8
  CsvTable(std::string path, const CsvFormat& format);

  /// Index of a column, by the header's name or by number.
  /// @throws CsvError where the file has no such column
  std::size_t resolve(const CsvColumn& column) const;

  /// Goes to the next row of data. @return false at the end @throws CsvError where reading fails
  bool next();
  /// Goes to the next line that is not blank, comments too, without their mark. @return, throws as next()
  bool next_line();
  bool is_comment() const { return is_comment_; }
  const std::string& line_text() const { return text_; }  ///< of this line, without the mark of a comment

  const std::vector<std::string>& header() const { return header_; }  ///< empty without one
  const std::vector<std::string>& units() const { return units_; }    ///< as written; empty without them
  const std::string& path() const { return path_; }
  std::uint64_t line() const { return line_; }    ///< of this row, from 1
  std::uint64_t bytes() const { return bytes_; }  ///< read so far

 private:
  void look_at_start();
  bool get_line(std::string& line);
  std::vector<std::string> line_of_words();
  bool take_mark(std::string& line) const;

  std::string path_;
  CsvFormat format_;
  std::ifstream file_;
  char line_end_ = '\n';
  std::string text_;
  std::vector<std::string> header_, units_;
  bool is_comment_ = false;
  std::uint64_t line_ = 0, bytes_ = 0;
};

/// A cell that identifies a row, so that 7, 7.0 and 07 are the same one.
std::string csv_id(const std::string& cell);

}  // namespace softarm::trial
