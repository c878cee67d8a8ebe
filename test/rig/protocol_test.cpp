// Pressures, payload and vacuum over time, and the semi-physical laws.
#include "rig/protocol.h"

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
  EXPECT_EQ(protocol.at(5.0).hand_damping_n_s_m, 0.0);
  EXPECT_EQ(protocol.at(5.0 + 1e-6).hand_damping_n_s_m, s.payload.hand_damping_n_s_m);  // takes hold at once
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

/// The scenario with a programme instead of the random pressures.
Scenario programme(const std::string& parts, double duration_s = 100.0, std::uint64_t seed = 3) {
  std::string text = kScenarioText;
  const std::string random = "  random: {min_pa: 0, max_pa: 40000}\n";
  text.replace(text.find(random), random.size(), "  programme:\n" + parts);
  Scenario s = parse_scenario(text.replace(text.find("duration_s: 10"), 14, "duration_s: 0"), "case.yaml");
  s.duration_s = duration_s;
  s.seed = seed;
  return s;
}

constexpr double kSettle = 0.5, kCorner = 0.1;

TEST(Programme, RampsHaveTheirRateAndAllInputsMoveTogether) {
  const Protocol protocol(
      programme("    - {ramp_to_pa: [40000, 0, -10000], rate_pa_per_s: 20000}\n    - {hold_s: 3}\n"));
  const auto at = [&](double t) { return protocol.at(kSettle + t).pressures_pa; };
  EXPECT_EQ(at(0.0)[0], 0.0);
  EXPECT_NEAR(at(0.5 * (2.0 + kCorner))[0], 20e3, 1e-6);
  EXPECT_NEAR((at(1.5)[0] - at(0.5)[0]) / 1.0, 20e3, 1e-6);
  EXPECT_NEAR((at(1.5)[2] - at(0.5)[2]) / 1.0, -5e3, 1e-6);
  EXPECT_NEAR(at(2.0 + kCorner)[0], 40e3, 1e-6);
  EXPECT_NEAR(at(5.0)[2], -10e3, 1e-6);
  // Then to rest within ramp_s, 2 s.
  EXPECT_NEAR(at(2.0 + kCorner + 3.0 + 1.0)[0], 20e3, 1e-6);
  EXPECT_EQ(at(2.0 + kCorner + 3.0 + 2.0)[0], 0.0);
  EXPECT_NEAR(protocol.programme_times().pressures_s, 7.1, 1e-9);
  EXPECT_EQ(protocol.programme_times().tensions_s, 0.0);
}

TEST(Programme, MovesHaveNoCorners) {
  const Protocol protocol(
      programme("    - {cycle_to_pa: [40000, 5000, 0], rates_pa_per_s: [10000, 400000]}\n"));
  const double dt = 1e-3;
  double last = 0.0, last_rate = 0.0, fastest = 0.0;
  for (int i = 1; i < 12000; ++i) {
    const double p = protocol.at(i * dt).pressures_pa[0], rate = (p - last) / dt;
    EXPECT_LT(std::abs(rate - last_rate) / dt, 1.6 * 400e3 / kCorner);
    fastest = std::max(fastest, std::abs(rate));
    last = p;
    last_rate = rate;
  }
  EXPECT_NEAR(fastest, 400e3, 4e3);
}

TEST(Programme, CyclesAtEachOfSeveralSpeeds) {
  const Protocol protocol(
      programme("    - {cycle_to_pa: [20000, 0, 0], rates_pa_per_s: [5000, 20000], times: 2, hold_s: 1}\n"));
  double t = kSettle;
  for (double rate : {5e3, 5e3, 20e3, 20e3}) {
    const double move_s = 20e3 / rate + kCorner;
    EXPECT_NEAR(protocol.at(t + 0.5 * move_s).pressures_pa[0], 10e3, 1e-6) << t;
    EXPECT_NEAR(protocol.at(t + move_s + 0.5).pressures_pa[0], 20e3, 1e-6) << t;
    EXPECT_NEAR(protocol.at(t + 1.5 * move_s + 1.0).pressures_pa[0], 10e3, 1e-6) << t;
    EXPECT_NEAR(protocol.at(t + 2.0 * move_s + 1.5).pressures_pa[0], 0.0, 1e-6) << t;
    t += 2.0 * (move_s + 1.0);
  }
  EXPECT_NEAR(protocol.programme_times().pressures_s, t - kSettle, 1e-9);  // it ends at rest
}

TEST(Programme, StaircaseUpAndDown) {
  const Protocol protocol(
      programme("    - {staircase_to_pa: [30000, 6000, 0], levels: 3, over_s: 0.5, hold_s: 2}\n"));
  const double up[] = {10e3, 20e3, 30e3, 20e3, 10e3, 0.0};
  for (int i = 0; i < 6; ++i) {
    const double begin = kSettle + 2.5 * i;
    for (double within : {0.5, 1.5, 2.5}) {
      EXPECT_NEAR(protocol.at(begin + within).pressures_pa[0], up[i], 1e-6) << i;
      EXPECT_NEAR(protocol.at(begin + within).pressures_pa[1], 0.2 * up[i], 1e-6) << i;
    }
    EXPECT_NEAR(protocol.at(begin + 0.25).pressures_pa[0], 0.5 * (up[i] + (i ? up[i - 1] : 0.0)), 1e-6) << i;
  }
  const Protocol one_way(
      programme("    - {staircase_to_pa: [30000, 0, 0], levels: 3, hold_s: 2, over_s: 0.5, back: false}\n"));
  EXPECT_NEAR(one_way.programme_times().pressures_s, 3 * 2.5 + 2.0, 1e-9);
}

TEST(Programme, RandomHoldsComeFromTheSeedAndChambersAreOffWithTheirChance) {
  const std::string parts =
      "    - {random_holds: 400, hold_s: 1, over_s: 0.5, min_pa: 5000, max_pa: [50000, 40000, 30000], "
      "off_probability: 0.3}\n";
  const Protocol protocol(programme(parts, 0.0)), same(programme(parts, 0.0)),
      other(programme(parts, 0.0, 4));
  EXPECT_NEAR(protocol.programme_times().pressures_s, 400 * 1.5 + 2.0, 1e-9);
  int off = 0, equal = 0;
  double most[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < 400; ++i) {
    const double begin = kSettle + 1.5 * i;
    const std::vector<double> p = protocol.at(begin + 0.6).pressures_pa;
    EXPECT_EQ(p, same.at(begin + 0.6).pressures_pa);
    EXPECT_EQ(p, protocol.at(begin + 1.4).pressures_pa);  // a hold
    for (std::size_t k = 0; k < 3; ++k) {
      off += p[k] == 0.0 ? 1 : 0;
      EXPECT_TRUE(p[k] == 0.0 || p[k] >= 5e3);
      most[k] = std::max(most[k], p[k]);
      equal += p[k] != 0.0 && p[k] == other.at(begin + 0.6).pressures_pa[k] ? 1 : 0;
    }
  }
  EXPECT_NEAR(off / 1200.0, 0.3, 4.0 * std::sqrt(0.3 * 0.7 / 1200.0));
  EXPECT_EQ(equal, 0);
  const double limits[] = {50e3, 40e3, 30e3};
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(most[k], limits[k]);
    EXPECT_GT(most[k], 0.97 * limits[k]);
  }
}

TEST(Programme, RepeatsForEverWhereItShould) {
  const std::string parts = "    - {ramp_to_pa: [10000, 0, 0], over_s: 1}\n    - {hold_s: 2}\n";
  const Protocol once(programme(parts, 0.0)), again(programme(parts + "  repeat_programme: true\n", 0.0));
  EXPECT_NEAR(again.programme_times().pressures_s, 5.0, 1e-12);
  for (double t : {0.3, 1.5, 3.7}) {
    EXPECT_NEAR(again.at(kSettle + t + 35.0).pressures_pa[0], once.at(kSettle + t).pressures_pa[0], 1e-6);
    EXPECT_EQ(once.at(kSettle + t + 35.0).pressures_pa[0], 0.0);
  }
}

TEST(Programme, CutShortItComesToRest) {
  const std::string parts = "    - {ramp_to_pa: [10000, 0, 0], over_s: 1}\n    - {hold_s: 20}\n";
  const Protocol cut(programme(parts, 8.0)), whole(programme(parts, 24.0));
  EXPECT_NEAR(cut.at(5.4).pressures_pa[0], 10e3, 1e-6);
  EXPECT_NEAR(cut.at(6.5).pressures_pa[0], 5e3, 1e-6);
  EXPECT_EQ(cut.at(7.5).pressures_pa[0], 0.0);
  EXPECT_NEAR(whole.at(21.4).pressures_pa[0], 10e3, 1e-6);
  EXPECT_EQ(whole.at(23.5).pressures_pa[0], 0.0);
}

TEST(Programme, MistakesAreOneLine) {
  struct Mistake {
    std::string parts;
    std::vector<std::string> says;
  };
  for (const Mistake& mistake : std::vector<Mistake>{
           {"    - {wait_s: 2}\n", {"pressures.programme[0].hold_s", "missing", "random_holds"}},
           {"    - {hold_s: -2}\n", {"pressures.programme[0].hold_s", "-2", "0 ... "}},
           {"    - {ramp_to_pa: [1, 2]}\n", {"programme[0].ramp_to_pa", "2 values", "3"}},
           {"    - {ramp_to_pa: [1, 2, 3], rate_pa_per_s: 1, over_s: 2}\n", {"over_s", "rate_pa_per_s"}},
           {"    - {ramp_to_pa: [1, 2, 3], cycle_to_pa: [1, 2, 3]}\n", {"cycle_to_pa", "ramp_to_pa"}},
           {"    - {ramp_to_pa: [1, 2, 3], times: 2}\n", {"programme[0].times", "unknown"}},
           {"    - {random_holds: 3, min_pa: 2000, max_pa: 1000}\n", {"max_pa", "1000", "2000"}},
           {"    - {random_holds: 3, off_probability: 1.2}\n", {"off_probability", "1.2", "0 ... 1"}},
           {"    - {hold_s: 1}\n  schedule: [{t_s: 0, pressures_pa: [0, 0, 0]}]\n",
            {"pressures.programme", "schedule"}},
           {"    []\n  repeat_programme: true\n", {"repeat_programme", "without a programme"}}}) {
    try {
      programme(mistake.parts);
      ADD_FAILURE() << "accepted: " << mistake.parts;
    } catch (const ScenarioError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos);
      for (const std::string& part : mistake.says)
        EXPECT_NE(what.find(part), std::string::npos) << what << " lacks " << part;
    }
  }
  // Too short for its programme.
  std::string text = kScenarioText;
  const std::string random = "  random: {min_pa: 0, max_pa: 40000}\n";
  text.replace(text.find(random), random.size(),
               "  programme: [{hold_s: 1}, {ramp_to_pa: [1, 2, 3], over_s: 8}]\n");
  try {
    parse_scenario(text, "case.yaml");
    ADD_FAILURE() << "accepted";
  } catch (const ScenarioError& error) {
    EXPECT_STREQ(
        error.what(),
        "case.yaml: key duration_s: value 10, allowed 0 (endless) or from 12 (pressures.programme, and "
        "settle_s at both ends)");
  }
}

TEST(Protocol, SetpointsMayHaveRampsOfTheirOwn) {
  std::string text = kScenarioText;
  text +=
      "vacuum:\n  ramp_s: 0.5\n  schedule:\n    - {t_s: 0, vacuum_pa: 0}\n"
      "    - {t_s: 1, vacuum_pa: 60000, over_s: 4}\n    - {t_s: 6, vacuum_pa: 0}\n";
  const Protocol protocol(parse_scenario(text, "case.yaml"));
  EXPECT_NEAR(protocol.at(3.0).vacuum_pa, 30e3, 1e-6);
  EXPECT_NEAR(protocol.at(6.25).vacuum_pa, 30e3, 1e-6);
  text.replace(text.find("t_s: 6"), 6, "t_s: 4");
  EXPECT_THROW(parse_scenario(text, "case.yaml"), ScenarioError);
}

}  // namespace
}  // namespace softarm::rig
