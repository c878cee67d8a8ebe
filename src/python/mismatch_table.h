// What the live monitor says of a recording, column by column.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include "monitor/alarm_list.h"

namespace softarm::python {

/// Rows are frames. NaN: nothing is said.
class MismatchTable {
 public:
  void add(const monitor::Mismatch& mismatch);
  void interrupt() { alarms_.interrupt(); }
  /// The alarms as the program's summary has them.
  std::string text() const { return alarms_.text(); }
  /// NumPy arrays by name, and the list of alarms; the table is empty afterwards. With Python's lock.
  pybind11::dict take();

 private:
  monitor::AlarmList alarms_;
  std::vector<std::int8_t> valid_, laws_, alarm_, kind_, or_kind_, axis_;
  std::vector<std::int16_t> body_;  ///< -1: none
  std::vector<double> score_, rms_, change_, threshold_, onset_, size_, s_, s_from_, s_to_;
  std::vector<std::string> description_;
};

/// Words of the codes, in their order.
std::vector<std::string> change_kinds();
std::vector<std::string> mismatch_axes();

}  // namespace softarm::python
