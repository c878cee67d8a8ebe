// Regulators, valves, lines and supply against hand-computed cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig/hidden_inputs.h"

namespace softarm::rig {
namespace {

constexpr double kShort = 1e-3;  ///< s: a step of the command

TEST(PressureLag, FirstOrderReaches63PercentAfterItsTimeConstant) {
  Walk walk(with("pressure_lag", {{"time_constant_s", 0.3}}));
  walk.to(commands(10e3), kShort);
  walk.hold(0.3 - 0.5 * kShort);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 10e3 * (1.0 - std::exp(-1.0)), 20.0);
  EXPECT_EQ(walk.acting().pressures_pa[1], 0.0);
  walk.hold(5.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 10e3, 0.01);
  // In a ramp it is behind by rate times time constant.
  walk.to(commands(30e3), 4.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 30e3 - 5e3 * 0.3, 0.1);
}

TEST(PressureLag, MayBeOfOneChamber) {
  Walk walk(with("pressure_lag", {{"time_constant_s", 0.3}, {"chamber", 2.0}}));
  walk.to(commands(10e3, 10e3, 10e3), 4.0);
  walk.to(commands(30e3, 30e3, 30e3), 4.0);
  const std::vector<double>& acting = walk.acting().pressures_pa;
  EXPECT_NEAR(acting[0], 30e3, 1e-9);
  EXPECT_NEAR(acting[1], 30e3 - 5e3 * 0.3, 0.1);
  EXPECT_NEAR(acting[2], 30e3, 1e-9);
}

TEST(DeadZone, OfOneChamberTakesItsPressureItself) {
  for (const std::string form : {"sharp", "smooth"}) {
    Walk walk(with("pressure_dead_zone", {{"pressure_pa", 3e3}, {"chamber", 2.0}}, form),
              commands(10e3, 2e3, 10e3));
    EXPECT_LT(walk.acting().pressures_pa[1], form == "sharp" ? 1e-9 : 300.0);
    const Acting& acting = walk.to(commands(10e3, 30e3, 10e3), 1.0);
    EXPECT_EQ(acting.pressures_pa[0], 10e3);
    EXPECT_NEAR(acting.pressures_pa[1], 27e3, 15.0);
    EXPECT_EQ(acting.pressures_pa[2], 10e3);
    // The moments go by that, and lose nothing a second time.
    const Scenario& s = laboratory();
    const LawSpec laws = with("pressure_dead_zone", {{"pressure_pa", 3e3}, {"chamber", 2.0}}).input_path.laws;
    EXPECT_TRUE(apply_laws(s.arm.segments[0], acting, laws).moment_nm ==
                apply_laws(s.arm.segments[0], acting, s.input_path.laws).moment_nm);
  }
}

TEST(PressureLag, FirstOrderDoesNotDependOnTheSteps) {
  const Scenario s = with("pressure_lag", {{"time_constant_s", 0.05}});
  InputPath coarse(s, commands()), fine(s, commands());
  double in_one = 0.0, in_many = 0.0;
  for (int i = 1; i <= 4; ++i) {
    const double t = 0.02 * i;
    in_one = coarse.act(commands(1e5 * t), t).front().pressures_pa[0];
    for (int k = 19; k >= 0; --k) {
      const double then = t - 0.001 * k;
      in_many = fine.act(commands(1e5 * then), then).front().pressures_pa[0];
    }
  }
  EXPECT_NEAR(in_one, in_many, 1e-6);
}

TEST(PressureLag, SecondOrderOvershootsByItsDampingAndIsAsLateInRamps) {
  const double z = 0.4, tau = 0.2;
  Walk walk(with("pressure_lag", {{"time_constant_s", tau}, {"damping_ratio", z}}, "second_order"));
  double most = 0.0;
  const auto watch = [&](const Commands&, const Acting& a) { most = std::max(most, a.pressures_pa[0]); };
  walk.to(commands(10e3), kShort, watch);
  walk.to(commands(10e3), 3.0, watch);
  EXPECT_NEAR(most, 10e3 * (1.0 + std::exp(-M_PI * z / std::sqrt(1.0 - z * z))), 5.0);
  walk.to(commands(40e3), 6.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 40e3 - 5e3 * tau, 1.0);
}

TEST(PressureLag, ChokedFillsAtALimitedRateAndVentsSlowlyNearAmbient) {
  Walk walk(with("pressure_lag", {{"time_constant_s", 0.2}, {"vent_time_constant_s", 0.2}}, "choked"));
  walk.to(commands(1e3), kShort);
  walk.hold(0.2);  // small: a first-order line
  EXPECT_NEAR(walk.acting().pressures_pa[0], 1e3 * (1.0 - std::exp(-1.0)), 10.0);
  walk.to(commands(100e3), kShort);
  const double before = walk.acting().pressures_pa[0];
  walk.hold(0.3);  // fully open, choked until a critical ratio of 0.3, hardly less after
  EXPECT_NEAR(walk.acting().pressures_pa[0] - before, 0.3 * 10e3 / 0.2, 0.03 * 15e3);
  walk.hold(10.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 100e3, 1.0);
  // Down by 10 kPa from 100 kPa and from 12 kPa: the second takes longer.
  const auto time_to_lose = [&](double from_pa) {
    walk.to(commands(from_pa), 1.0);
    walk.hold(10.0);
    walk.to(commands(0.0), kShort);
    for (double t = 0.0; t < 20.0; t += kShort)
      if (walk.hold(kShort).pressures_pa[0] < from_pa - 10e3) return t;
    return 20.0;
  };
  EXPECT_GT(time_to_lose(12e3), 2.0 * time_to_lose(100e3));
}

TEST(PressureLeak, SteadyShareOfOneChamber) {
  Walk walk(with("pressure_leak", {{"chamber", 2.0}, {"share", 0.04}}));
  walk.to(commands(10e3, 20e3, 30e3), 1.0);
  EXPECT_EQ(walk.acting().pressures_pa[0], 10e3);
  EXPECT_NEAR(walk.acting().pressures_pa[1], 20e3 * 0.96, 1e-9);
  EXPECT_EQ(walk.acting().pressures_pa[2], 30e3);
}

TEST(PressureLeak, InHoldsItDecaysAndMovingItIsMadeUpFor) {
  Walk walk(with("pressure_leak", {{"share", 0.05}, {"time_s", 4.0}}, "in_holds"));
  walk.to(commands(20e3), 2.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3, 1e-3);
  walk.hold(4.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3 * (1.0 - 0.05 * (1.0 - std::exp(-1.0))), 0.5);
  walk.hold(40.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 19e3, 0.5);
  walk.to(commands(21e3), 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 21e3, 1.0);
}

TEST(PressureLeak, AnArmThatStartsInAHoldHasLongLeaked) {
  Walk walk(with("pressure_leak", {{"share", 0.05}}, "in_holds"), commands(10e3, 0.0, 0.0));
  EXPECT_NEAR(walk.acting().pressures_pa[0], 9.5e3, 1e-9);
}

TEST(Regulator, OffsetAndDeadBand) {
  Walk offset(with("regulator_error", {{"offset_pa", 300.0}}));
  EXPECT_EQ(offset.acting().pressures_pa[0], 300.0);
  EXPECT_NEAR(offset.to(commands(5e3), 1.0).pressures_pa[0], 5300.0, 1e-9);

  Walk band(with("regulator_error", {{"dead_band_pa", 1000.0}}));
  EXPECT_EQ(band.to(commands(999.0), 1.0).pressures_pa[0], 0.0);  // left alone
  double most_behind = 0.0;
  band.to(commands(20e3), 5.0, [&](const Commands& c, const Acting& a) {
    most_behind = std::max(most_behind, std::abs(c.pressures_pa[0] - a.pressures_pa[0]));
  });
  EXPECT_NEAR(most_behind, 1000.0, 10.0);
  band.to(commands(30e3), kShort);
  EXPECT_NEAR(band.hold(0.2).pressures_pa[0], 30e3, 1e-9);  // once it works, to the end
}

TEST(Valve, SticksAndMovesInSteps) {
  Walk walk(with("valve_stiction", {{"step_pa", 2000.0}}));
  std::vector<double> levels{0.0};
  walk.to(commands(10.5e3), 10.5, [&](const Commands& c, const Acting& a) {
    const double p = a.pressures_pa[0];
    if (std::fmod(c.pressures_pa[0], 2000.0) > 1900.0 && p - levels.back() > 100.0) levels.push_back(p);
  });
  ASSERT_EQ(levels.size(), 5u);
  for (std::size_t i = 1; i < levels.size(); ++i) EXPECT_NEAR(levels[i], 2000.0 * i, 5.0);
}

TEST(Valve, StictionAndRegulatorDoNotDependOnTheSteps) {
  for (const Scenario& s :
       {with("valve_stiction", {{"step_pa", 700.0}}), with("regulator_error", {{"dead_band_pa", 900.0}})}) {
    InputPath coarse(s, commands()), fine(s, commands());
    double last = 0.0;
    for (int i = 1; i <= 200; ++i) {
      const double now = 10e3 * std::sin(0.013 * i * std::sqrt(i));
      double in_many = 0.0;
      for (int k = 1; k <= 16; ++k)
        in_many = fine.act(commands(last + (now - last) * k / 16.0), 0.01 * (i - 1) + 0.01 * k / 16.0)
                      .front()
                      .pressures_pa[0];
      ASSERT_NEAR(coarse.act(commands(now), 0.01 * i).front().pressures_pa[0], in_many, 1e-5) << i;
      last = now;
    }
  }
}

TEST(Valve, SlewLimit) {
  Walk walk(with("flow_limit", {{"rise_pa_per_s", 10e3}, {"fall_pa_per_s", 5e3}}));
  walk.to(commands(20e3), kShort);
  EXPECT_NEAR(walk.hold(0.5).pressures_pa[0], 10e3 * (0.5 + kShort), 1e-6);
  walk.hold(3.0);
  walk.to(commands(0.0), kShort);
  EXPECT_NEAR(walk.hold(1.0).pressures_pa[0], 20e3 - 5e3 * (1.0 + kShort), 1e-6);
  EXPECT_EQ(walk.hold(5.0).pressures_pa[0], 0.0);
  Walk slow(with("flow_limit", {{"rise_pa_per_s", 10e3}}));
  EXPECT_NEAR(slow.to(commands(9e3), 1.0).pressures_pa[0], 9e3, 1e-6);  // slower commands pass
}

TEST(Valve, ASharedSupplyLimitsWhatRisesTogether) {
  Walk walk(with("flow_limit", {{"rise_pa_per_s", 10e3}, {"fall_pa_per_s", 5e3}}, "shared"));
  walk.to(commands(20e3), kShort);  // alone: as if it were its own
  EXPECT_NEAR(walk.hold(0.5).pressures_pa[0], 10e3 * (0.5 + kShort), 1e-6);
  walk.hold(3.0);
  // 30 kPa in all take three seconds, each its part; what falls meanwhile is no concern of theirs.
  walk.to(commands(0.0, 10e3, 20e3), kShort);
  walk.hold(1.5 - kShort);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3 - 5e3 * 1.5, 1e-6);
  EXPECT_NEAR(walk.acting().pressures_pa[1], 5e3, 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[2], 10e3, 1.0);
}

TEST(Line, DelayIsADeadTime) {
  Walk walk(with("line_delay", {{"delay_s", 0.1005}}));
  EXPECT_EQ(walk.to(commands(1e3), 0.1).pressures_pa[0], 0.0);
  walk.to(commands(11e3), 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 11e3 - 10e3 * 0.1005, 1e-6);
  EXPECT_NEAR(walk.hold(0.2).pressures_pa[0], 11e3, 1e-9);
}

TEST(Supply, DroopsWhenTheOthersAreOpen) {
  Walk walk(with("supply_sag", {{"share", 0.1}, {"reference_pa", 40e3}}));
  EXPECT_EQ(walk.to(commands(40e3), 1.0).pressures_pa[0], 40e3);  // alone
  walk.to(commands(40e3, 40e3), 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 40e3 * 0.95, 1e-6);
  walk.to(commands(40e3, 40e3, 80e3), 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 40e3 * (1.0 - 0.1 * 9.0 / 10.0), 1e-6);
  EXPECT_NEAR(walk.acting().pressures_pa[2], 80e3 * (1.0 - 0.1 * 4.0 / 5.0), 1e-6);
}

TEST(Supply, OfATankFallsByWhatIsTakenAndIsFilledAgain) {
  Walk walk(with("supply_sag", {{"share", 0.2}, {"reference_pa", 100e3}, {"refill_pa_per_s", 10e3}}, "tank"));
  // Two chambers take 40 kPa within a second, in which the pump brings 10 back.
  walk.to(commands(20e3, 20e3), 1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3 * (1.0 - 0.2 * 0.3), 0.1);
  EXPECT_NEAR(walk.acting().pressures_pa[1], 20e3 * (1.0 - 0.2 * 0.3), 0.1);
  walk.hold(1.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3 * (1.0 - 0.2 * 0.2), 0.1);
  // What is let off does not come back; in the end the tank is full, and no fuller.
  walk.to(commands(20e3, 0.0), 0.5);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3 * (1.0 - 0.2 * 0.15), 0.1);
  walk.hold(9.0);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 20e3, 1e-6);
  // Empty it gives no less.
  walk.to(commands(150e3, 150e3), 0.5);
  EXPECT_NEAR(walk.acting().pressures_pa[0], 150e3 * (1.0 - 0.2), 1e-6);
}

TEST(Supply, RipplesWithItsPeriodFallingFourTimesAsLongAsRising) {
  Scenario s = with("supply_ripple", {{"share", 0.1}, {"period_s", 5.0}});
  Walk walk(s, commands(20e3, 0.0, 0.0));
  double low = 1e9, high = 0.0, last = walk.acting().pressures_pa[0], sum = 0.0;
  int falling = 0;
  walk.to(commands(20e3), 10.0, [&](const Commands&, const Acting& a) {
    const double p = a.pressures_pa[0];
    low = std::min(low, p);
    high = std::max(high, p);
    falling += p < last ? 1 : 0;
    sum += p;
    last = p;
    EXPECT_EQ(a.pressures_pa[1], 0.0);
  });
  EXPECT_NEAR(low, 19e3, 5.0);
  EXPECT_NEAR(high, 21e3, 5.0);
  EXPECT_NEAR(falling, 8000, 5);
  EXPECT_NEAR(sum / 10000.0, 20e3, 1.0);
  s.seed = 2;
  EXPECT_NE(Walk(s, commands(20e3)).acting().pressures_pa[0],
            Walk(with("supply_ripple", {{"share", 0.1}, {"period_s", 5.0}}), commands(20e3))
                .acting()
                .pressures_pa[0]);
}

TEST(InputPath, PassesEverythingExactlyWhereNothingIsHidden) {
  const Scenario s = laboratory();
  InputPath path(s, commands(1.0, 2.0, 3.0));
  EXPECT_FALSE(path.feels_bending());
  for (int i = 0; i < 50; ++i) {
    Commands c = commands(1e4 * std::sin(0.3 * i), 123.456 * i, 7.0 / (i + 1));
    c.tensions_n = {0.1 * i, 1.0 / 3.0};
    c.vacuum_pa = 1e3 * i;
    c.payload_kg = 0.1;
    const std::vector<Acting> acting = path.act(c, 0.002 * i);
    ASSERT_EQ(acting.size(), 2u);
    for (const Acting& a : acting) {
      EXPECT_EQ(a.pressures_pa, c.pressures_pa);
      EXPECT_EQ(a.tensions_n, c.tensions_n);
      EXPECT_EQ(a.vacuum_pa, c.vacuum_pa);
      EXPECT_EQ(a.jamming_pa, c.vacuum_pa);
      EXPECT_EQ(a.gain_scale, 1.0);
      EXPECT_EQ(a.stiffness_scale, 1.0);
      EXPECT_EQ(a.length_scale, 1.0);
    }
  }
}

TEST(InputPath, TheSameTimeAgainGivesTheSame) {
  Scenario s = with("pressure_lag", {{"time_constant_s", 0.3}});
  s = with("valve_stiction", {{"step_pa", 500.0}}, "", s);
  s = with("hysteresis", {{"loop_pa", 1000.0}}, "bouc_wen", s);
  s = with("line_delay", {{"delay_s", 0.01}}, "", s);
  s = with("pressure_leak", {{"share", 0.05}}, "in_holds", s);
  InputPath path(s, commands());
  for (int i = 0; i < 200; ++i) {
    const Commands c = commands(2e4 * std::sin(0.02 * i));
    const double p = path.act(c, 0.002 * i).front().pressures_pa[0];
    EXPECT_NEAR(path.act(c, 0.002 * i).front().pressures_pa[0], p, 1e-9);
  }
}

}  // namespace
}  // namespace softarm::rig
