// Loads at which a straight column stops being stable.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

/// Load at which the base no longer turns when the tip does: the loss of stability of the straight column.
double critical(const std::function<rod::Rod(double)>& column, double low, double high) {
  const auto stable = [&](double load) {
    const rod::Rod rod = column(load);
    rod::Solver solver(rod, {rod.rest_length_m()}, {});
    EXPECT_EQ(solver.solve(rod, rod.q_base), rod::SolveStatus::kConverged) << load;
    EXPECT_EQ(solver.stable(), solver.base_per_tip_rotation()(0, 0) > 0.0) << load;
    return solver.stable();
  };
  EXPECT_TRUE(stable(low));
  EXPECT_FALSE(stable(high));
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

TEST(Buckling, EulerColumnUnderATipLoad) {
  const double length = 0.2, ei = 0.03;
  const double expected = M_PI * M_PI * ei / (4.0 * length * length);
  const double found = critical(
      [&](double load) {
        rod::Rod rod = testing::plain_rod(length, ei);
        rod.loads[0].force_n = {0.0, 0.0, -load};
        return rod;
      },
      0.5 * expected, 2.0 * expected);
  EXPECT_NEAR(found / expected, 1.0, 1e-6);
}

TEST(Buckling, ColumnUnderItsOwnWeight) {
  const double length = 0.2, ei = 0.03;
  const double found = critical(
      [&](double number) {
        rod::Rod rod = testing::plain_rod(length, ei);
        rod.segments[0].mass_kg = number * ei / (length * length) / 9.81;
        rod.gravity_m_s2 = {0.0, 0.0, -9.81};
        return rod;
      },
      4.0, 15.0);
  EXPECT_NEAR(found / 7.8373, 1.0, 1e-4);
}

}  // namespace
}  // namespace softarm::rod
