// The bags that one recording becomes.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "output_file.h"
#include "ros/csv_bag.h"
#include "trial/csv_recording.h"

namespace softarm::app {

/// Writes the rows of a recording to one bag, or to one for each of its trials and pieces. Nothing has its
/// final name before commit().
class ImportBags {
 public:
  /// @param path the bag; of several ones the stem that "_<trial>" and "_<piece from 0>" are added to
  /// @param split_every_s length of the pieces; absent: one piece
  /// @param layout_text the document that `layout` was read from; each bag keeps it
  ImportBags(const trial::CsvLayout& layout, const std::string& layout_text, std::filesystem::path path,
             std::optional<double> split_every_s, Replacing replacing);

  void write(const trial::CsvRow& row);
  /// Notes that rows between the last one and the next are left out as told: `check` takes that for no gap.
  void leave_out() { left_out_ = true; }
  /// Completes the last bag.
  void close();
  void commit();

  struct Bag {
    std::unique_ptr<OutputFile> file;
    std::uint64_t messages = 0;
  };
  const std::vector<Bag>& bags() const { return bags_; }

 private:
  void enter(const trial::CsvRow& row);

  const trial::CsvLayout& layout_;
  const std::string layout_text_;
  std::filesystem::path path_;
  std::optional<double> split_every_s_;
  Replacing replacing_;
  std::vector<Bag> bags_;
  std::unique_ptr<CsvBag> bag_;
  std::string trial_;
  double trial_start_s_ = 0.0;
  long piece_ = 0;
  bool left_out_ = false;
};

}  // namespace softarm::app
