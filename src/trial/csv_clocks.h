// Rows of a recording whose bodies were stamped by another clock than its inputs.
#pragma once

#include <functional>
#include <vector>

#include "csv_recording.h"

namespace softarm::trial {

/// Hands on the rows of one trial with the bodies' stamps put right: each row becomes one of bodies and one
/// of inputs, in the order of their times, from where both are there to where one of them ends.
/// @param rows of one trial, in order
/// @param bodies_ahead_s what the bodies' clock is ahead of the inputs'
/// @return how many of the rows have bodies or inputs that the other has no time for
std::size_t put_clocks_right(const std::vector<CsvRow>& rows, double bodies_ahead_s,
                             const std::function<void(const CsvRow&)>& on_row);

}  // namespace softarm::trial
