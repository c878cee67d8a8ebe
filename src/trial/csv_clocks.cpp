#include "csv_clocks.h"

#include <algorithm>

namespace softarm::trial {
namespace {

CsvRow inputs_of(const CsvRow& row) {
  CsvRow inputs = row;
  std::fill(inputs.bodies.begin(), inputs.bodies.end(), std::nullopt);
  return inputs;
}

CsvRow bodies_of(const CsvRow& row, double bodies_ahead_s) {
  CsvRow bodies = row;
  bodies.time_s -= bodies_ahead_s;
  bodies.stamp = row.stamp.earlier(bodies_ahead_s);
  std::fill(bodies.pressures_pa.begin(), bodies.pressures_pa.end(), std::nullopt);
  std::fill(bodies.scalars.begin(), bodies.scalars.end(), std::nullopt);
  bodies.payload_kg.reset();
  return bodies;
}

}  // namespace

std::size_t put_clocks_right(const std::vector<CsvRow>& rows, double bodies_ahead_s,
                             const std::function<void(const CsvRow&)>& on_row) {
  if (rows.empty()) return 0;
  const double from_s = rows.front().time_s + std::max(0.0, -bodies_ahead_s),
               to_s = rows.back().time_s - std::max(0.0, bodies_ahead_s);
  std::size_t of_inputs = 0, of_bodies = 0, without = 0;
  const auto hand_on = [&](const CsvRow& row) {
    if (row.time_s >= from_s && row.time_s <= to_s)
      on_row(row);
    else
      ++without;
  };
  while (of_inputs < rows.size() || of_bodies < rows.size()) {
    const bool body =
        of_inputs == rows.size() ||
        (of_bodies < rows.size() && rows[of_bodies].time_s - bodies_ahead_s < rows[of_inputs].time_s);
    hand_on(body ? bodies_of(rows[of_bodies++], bodies_ahead_s) : inputs_of(rows[of_inputs++]));
  }
  return without;
}

}  // namespace softarm::trial
