// Pressures, payload and vacuum over time, and the semi-physical laws.
#include "softarm/rig/protocol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig/scenario_text.h"

namespace softarm::rig {
namespace {

Scenario scenario() {
  return parse_scenario(kScenarioText, "case.yaml");
}

TEST(Protocol, RandomPressuresStayWithinLimitsAreSmoothAndUseTheRange) {
  Scenario s = scenario();
  s.duration_s = 300.0;
  const Protocol protocol(s);
  const double dt = 0.01;
  std::vector<double> last = protocol.at(0.0).pressures_pa, last_rate(3, 0.0);
  double low = 1e9, high = 0.0;
  for (int i = 1; i <= 30000; ++i) {
    const std::vector<double> p = protocol.at(i * dt).pressures_pa;
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_GE(p[c], 0.0);
      ASSERT_LE(p[c], 40000.0);
      const double rate = (p[c] - last[c]) / dt;
      EXPECT_LT(std::abs(rate), 1e5);
      EXPECT_LT(std::abs(rate - last_rate[c]) / dt, 5e5);  // no corners
      last_rate[c] = rate;
      low = std::min(low, i > 500 && i < 29500 ? p[c] : 1e9);
      high = std::max(high, p[c]);
    }
    last = p;
  }
  EXPECT_LT(low, 4000.0);
  EXPECT_GT(high, 36000.0);
}

TEST(Protocol, StartsAndEndsAtRest) {
  Scenario s = scenario();
  s.pressures.rest = 3000.0;
  const Protocol protocol(s);
  for (double t : {0.0, 0.3, 0.5, 9.5, 9.8, 10.0})
    for (double p : protocol.at(t).pressures_pa) EXPECT_DOUBLE_EQ(p, 3000.0) << t;
  s.duration_s = 0.0;  // endless: no end to rest at
  const std::vector<double> later = Protocol(s).at(1000.0).pressures_pa;
  EXPECT_GT(std::abs(later[0] - 3000.0) + std::abs(later[1] - 3000.0), 1.0);
}

TEST(Protocol, ChambersAreIndependentAndSeedsMatter) {
  Scenario s = scenario();
  const std::vector<double> one = Protocol(s).at(5.0).pressures_pa;
  EXPECT_EQ(one, Protocol(s).at(5.0).pressures_pa);
  EXPECT_GT(std::abs(one[0] - one[1]), 1.0);
  s.seed = 2;
  EXPECT_GT(std::abs(one[0] - Protocol(s).at(5.0).pressures_pa[0]), 1.0);
}

TEST(Protocol, ScheduledPressuresAndVacuumRampBetweenSetpoints) {
  Scenario s = scenario();
  s.pressures.random.reset();
  s.pressures.settle_s = 0.0;
  s.pressures.ramp_s = 1.0;
  s.pressures.schedule = {{0.0, {1000.0, 2000.0, 3000.0}}, {4.0, {5000.0, 0.0, 3000.0}}};
  s.vacuum.ramp_s = 0.5;
  s.vacuum.schedule = {{0.0, {0.0}}, {2.0, {60000.0}}};
  const Protocol protocol(s);
  EXPECT_DOUBLE_EQ(protocol.at(3.0).pressures_pa[1], 2000.0);
  EXPECT_DOUBLE_EQ(protocol.at(4.5).pressures_pa[0], 3000.0);
  EXPECT_DOUBLE_EQ(protocol.at(5.5).pressures_pa[0], 5000.0);
  EXPECT_DOUBLE_EQ(protocol.at(2.25).vacuum_pa, 30000.0);
  EXPECT_DOUBLE_EQ(protocol.at(8.0).vacuum_pa, 60000.0);
}

TEST(Protocol, StepsAreAddedWithARampOfTheirOwn) {
  Scenario s = scenario(), plain = scenario();
  s.pressures.step_ramp_s = 0.1;
  s.pressures.steps = {{0.0, {0.0, 0.0, 0.0}}, {5.0, {8000.0, 0.0, -90000.0}}};
  s.pressures.lowest = 0.0;
  for (double t : {4.0, 5.0, 5.05, 5.1, 6.0}) {
    const std::vector<double> with = Protocol(s).at(t).pressures_pa,
                              without = Protocol(plain).at(t).pressures_pa;
    const double share = t <= 5.0 ? 0.0 : t < 5.1 ? 0.5 : 1.0;
    EXPECT_NEAR(with[0] - without[0], share * 8000.0, 1e-6) << t;
    EXPECT_DOUBLE_EQ(with[1], without[1]);
    EXPECT_GE(with[2], 0.0);
  }
}

TEST(Protocol, ARepeatedScheduleGoesOnForEver) {
  Scenario s = scenario();
  s.duration_s = 0.0;
  s.pressures.random.reset();
  s.pressures.ramp_s = 1.0;
  s.pressures.repeat_s = 10.0;
  s.pressures.schedule = {{0.0, {0.0, 0.0, 0.0}}, {4.0, {5000.0, 0.0, 3000.0}}, {8.0, {0.0, 0.0, 0.0}}};
  const Protocol protocol(s);
  for (double t : {3.0, 4.5, 6.0, 8.2, 9.9})
    EXPECT_NEAR(protocol.at(t).pressures_pa[0], protocol.at(t + 70.0).pressures_pa[0], 1e-6) << t;
  EXPECT_NEAR(protocol.at(76.0).pressures_pa[2], 3000.0, 1e-9);
}

TEST(Protocol, PayloadChangesSmoothlyWithAHandAtTheTipAndRepeats) {
  Scenario s = scenario();
  s.duration_s = 0.0;
  s.payload.ramp_s = 0.2;
  s.payload.steady_s = 0.8;
  s.payload.repeat_s = 8.0;
  const Protocol protocol(s);
  EXPECT_DOUBLE_EQ(protocol.at(0.05).payload_kg, 0.1);  // no change at the start
  EXPECT_EQ(protocol.at(0.05).hand_damping_n_s_m, 0.0);
  EXPECT_NEAR(protocol.at(5.1).payload_kg, 0.15, 1e-12);
  EXPECT_GT(protocol.at(5.1).hand_damping_n_s_m, 0.0);
  EXPECT_DOUBLE_EQ(protocol.at(5.3).payload_kg, 0.2);
  EXPECT_GT(protocol.at(5.7).hand_damping_n_s_m, 0.0);
  EXPECT_EQ(protocol.at(5.9).hand_damping_n_s_m, 0.0);
  EXPECT_NEAR(protocol.at(8.1).payload_kg, 0.15, 1e-12);
  EXPECT_DOUBLE_EQ(protocol.at(12.0).payload_kg, 0.1);
  EXPECT_DOUBLE_EQ(protocol.at(13.5).payload_kg, 0.2);

  EXPECT_DOUBLE_EQ(protocol.payload_known_at(5.05).kg, 0.1);
  EXPECT_DOUBLE_EQ(protocol.payload_known_at(5.2).kg, 0.2);
  EXPECT_NEAR(protocol.payload_known_at(5.2).t_s, 5.1, 1e-12);
  EXPECT_DOUBLE_EQ(protocol.payload_known_at(8.05).kg, 0.2);
  EXPECT_DOUBLE_EQ(protocol.payload_known_at(8.2).kg, 0.1);
  EXPECT_NEAR(protocol.payload_known_at(8.2).t_s, 8.1, 1e-12);
}

}  // namespace
}  // namespace softarm::rig
