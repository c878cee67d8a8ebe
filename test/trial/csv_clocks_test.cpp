// Recordings whose bodies were stamped by another clock than their inputs.
#include "trial/csv_clocks.h"

#include <gtest/gtest.h>

namespace softarm {
namespace {

/// Ten rows a tenth of a second apart; the inputs count, the bodies move along x.
std::vector<trial::CsvRow> rows() {
  std::vector<trial::CsvRow> all;
  for (int k = 0; k < 10; ++k) {
    trial::CsvRow row;
    row.time_s = 0.1 * k;
    row.stamp = 1000.0 + row.time_s;
    row.bodies.push_back(trial::CsvPose{Eigen::Vector3d(k, 0.0, 0.0), std::nullopt});
    row.pressures_pa.emplace_back(k);
    row.scalars.emplace_back(-k);
    row.payload_kg = 0.1 * k;
    all.push_back(row);
  }
  return all;
}

TEST(CsvClocks, BodiesMeetTheInputsOfTheirInstantInOrderOfTime) {
  for (const double ahead_s : {0.25, -0.25}) {
    SCOPED_TRACE(ahead_s);
    double last_s = -1e9;
    int bodies = 0, inputs = 0;
    const std::size_t without = trial::put_clocks_right(rows(), ahead_s, [&](const trial::CsvRow& row) {
      EXPECT_GE(row.time_s, last_s);
      last_s = row.time_s;
      EXPECT_NEAR(row.stamp.s, 1000.0 + row.time_s, 1e-9);
      if (row.bodies[0]) {
        ++bodies;
        EXPECT_NEAR(row.time_s, 0.1 * row.bodies[0]->p_mocap.x() - ahead_s, 1e-9);
        EXPECT_FALSE(row.pressures_pa[0] || row.scalars[0] || row.payload_kg);
      } else {
        ++inputs;
        EXPECT_NEAR(row.time_s, 0.1 * *row.pressures_pa[0], 1e-9);
        EXPECT_TRUE(row.scalars[0] && row.payload_kg);
      }
    });
    // Both are handed on where both are there: 0.65 s of 0.9.
    EXPECT_EQ(bodies, 7);
    EXPECT_EQ(inputs, 7);
    EXPECT_EQ(without, 6u);
  }
}

TEST(CsvClocks, ClocksThatNeverMeetLeaveNothing) {
  EXPECT_EQ(trial::put_clocks_right(rows(), 5.0, [](const trial::CsvRow&) { FAIL(); }), 20u);
  EXPECT_EQ(trial::put_clocks_right({}, 5.0, [](const trial::CsvRow&) { FAIL(); }), 0u);
}

}  // namespace
}  // namespace softarm
