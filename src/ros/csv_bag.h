// The rows of a CSV recording as a trial bag.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "bag_writer.h"
#include "trial/csv_recording.h"

namespace softarm {

/// Writes the rows of one trial, in their order, to one bag.
class CsvBag {
 public:
  /// @param layout by which the rows were read; must outlive this
  /// @param layout_text the document that it was read from: the bag keeps it
  /// It and all that writes: @throws BagError where the file cannot be written
  /// @param called as which people know it, where it is renamed when it is complete
  CsvBag(const trial::CsvLayout& layout, std::string layout_text, const std::string& path,
         const std::string& called = "");

  void write(const trial::CsvRow& row);
  /// Notes that rows between the last one and the next are left out as told: `check` takes that for no gap.
  void leave_out() { left_out_ = true; }
  /// Completes the file.
  void close() { writer_.close(); }
  std::uint64_t messages() const { return writer_.messages(); }

 private:
  void payload(const trial::CsvRow& row);

  const trial::CsvLayout& layout_;
  const std::string layout_text_;
  TrialBagWriter writer_;
  std::size_t next_step_ = 0;               // of the layout's payload
  std::optional<double> payload_kg_;        // last published
  std::optional<trial::Stamp> last_stamp_;  // of the last row
  bool left_out_ = false;
};

}  // namespace softarm
