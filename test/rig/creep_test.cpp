// The rig's wall that creeps: against the integral over its spectrum of times, and in what it records.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig/simulator.h"
#include "rig/truth_yaml.h"
#include "rig/wall_creep.h"

namespace softarm::rig {
namespace {

using ::testing::HasSubstr;

/// What is late of a unit step after t: the mean of e^(-t / tau) over the spectrum, by the trapezoidal rule.
double late(double t_s, double time_s, double decades) {
  double sum = 0.0, weights = 0.0;
  for (double z = -6.0; z <= 6.0; z += 0.01) {
    const double weight = std::exp(-0.5 * z * z);
    sum += weight * std::exp(-t_s / (time_s * std::pow(10.0, decades * z)));
    weights += weight;
  }
  return sum / weights;
}

Actuation driven(double moment_nm, double length_m) {
  Actuation actuation;
  actuation.moment_nm = {moment_nm, -0.5 * moment_nm};
  actuation.length_m = length_m;
  return actuation;
}

TEST(RigCreep, AStepComesByTheSpectrum) {
  for (const double decades : {0.0, 0.2, 0.4}) {
    CreepSpec spec;
    spec.moment = {{2.0, 0.4, decades}};
    spec.length = {{0.5, 0.3, decades}};
    WallCreep wall(spec);
    constexpr double kStep_s = 1e-3;
    for (int i = 0; i <= 10000; ++i) {
      // From 0.1 to 0.2 N m and from 0.2 to 0.21 m at t = 0+.
      Actuation actuation = i == 0 ? driven(0.1, 0.2) : driven(0.2, 0.21);
      const double t_s = kStep_s * i;
      wall.act(t_s, actuation);
      if (i % 500 != 0 || i == 0) continue;
      EXPECT_NEAR(actuation.moment_nm.x(), 0.2 - 0.1 * 0.4 * late(t_s, 2.0, decades), 4e-4) << t_s;
      EXPECT_NEAR(actuation.moment_nm.y(), -0.5 * actuation.moment_nm.x(), 1e-12) << t_s;
      EXPECT_NEAR(actuation.length_m, 0.21 - 0.01 * 0.3 * late(t_s, 0.5, decades), 4e-5) << t_s;
    }
  }
}

TEST(RigCreep, WhatWasBeforeIsForgotten) {
  CreepSpec spec;
  spec.moment = {{1.0, 0.5, 0.0}};
  spec.before_moment_nm = {0.02, 0.0};
  spec.before_length_m = 0.01;  // nothing of the length creeps
  WallCreep wall(spec);
  for (int again = 0; again < 2; ++again) {  // equilibrium at the beginning is sought by repetition
    Actuation first = driven(0.1, 0.2);
    wall.act(0.0, first);
    EXPECT_NEAR(first.moment_nm.x(), 0.1 + 0.5 * 0.02, 1e-15);
    EXPECT_NEAR(first.length_m, 0.2, 1e-15);
  }
  Actuation later = driven(0.1, 0.2);
  wall.act(3.0, later);
  EXPECT_NEAR(later.moment_nm.x(), 0.1 + 0.5 * 0.02 * std::exp(-3.0), 1e-15);
}

TEST(RigCreep, OfAHiddenWallBeginsElsewhereByTheSeed) {
  const auto hidden = [](std::uint64_t seed) {
    Scenario scenario;
    scenario.arm.segments.resize(2);
    scenario.seed = seed;
    hide({"creep", "wall", {{"share", 0.25}, {"time_s", 8.0}, {"left_nm", 0.02}}}, scenario);
    return scenario.arm.segments;
  };
  const std::vector<SegmentSpec> one = hidden(3), other = hidden(4);
  ASSERT_EQ(one[0].creep.moment.size(), 1u);
  EXPECT_NEAR(one[0].creep.moment[0].share, 0.2, 1e-15);
  EXPECT_EQ(one[0].creep.moment[0].time_s, 8.0);
  EXPECT_NEAR(one[0].creep.before_moment_nm.norm(), 0.02, 1e-12);
  EXPECT_GT((one[0].creep.before_moment_nm - one[1].creep.before_moment_nm).norm(), 1e-3);
  EXPECT_GT((one[0].creep.before_moment_nm - other[0].creep.before_moment_nm).norm(), 1e-3);
}

TEST(RigCreep, PressureSlowsItAndMakesMoreOfItLate) {
  CreepSpec spec;
  spec.moment = {{2.0, 0.36, 0.0}};
  spec.slows_pa = 40e3;
  spec.grows_pa = 20e3;
  WallCreep wall(spec);
  Actuation first = driven(0.1, 0.2), second = driven(0.2, 0.2), third = second;
  first.mean_pressure_pa = second.mean_pressure_pa = third.mean_pressure_pa = 10e3;
  wall.act(0.0, first);
  EXPECT_NEAR(first.moment_nm.x(), 0.1, 1e-15);
  wall.act(1e-9, second);
  const double late = 1.0 - std::pow(0.64, 1.5);
  EXPECT_NEAR(second.moment_nm.x(), 0.2 - 0.1 * late, 1e-9);
  wall.act(1.0, third);
  EXPECT_NEAR(third.moment_nm.x(), 0.2 - 0.1 * late * std::exp(-1.0 / (2.0 * std::exp(0.25))), 1e-9);
}

std::string text(const std::string& creep) {
  return R"(format: 1
name: creeping
duration_s: 6
arm:
  length_m: 0.2
  mass_kg: 0.2
  retardation_s: 0.2
  bending_stiffness: {base_nm2: 0.03}
)" + creep +
         R"(  chambers: [{bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6}]
pressures: {settle_s: 0, ramp_s: 0.4, schedule: [{t_s: 0, pressures_pa: [0]}, {t_s: 0.5, pressures_pa: [20000]}]}
)";
}

TEST(RigCreep, TheRecordedArmCreeps) {
  const auto bends_rad = [](const std::string& creep) {
    Simulator simulator(parse_scenario(text(creep), "s.yaml"));
    std::vector<double> list;
    while (const std::optional<Sample> sample = simulator.next()) list.push_back(sample->truth.tip_angle_rad);
    return list;
  };
  const std::vector<double> plain = bends_rad(""),
                            creeping = bends_rad("  creep: {moment: [{time_s: 1, share: 0.4}]}\n");
  ASSERT_EQ(plain.size(), creeping.size());
  const std::size_t middle = plain.size() / 3, last = 3 * plain.size() / 4;  // before it is let down again
  EXPECT_NEAR(plain[middle], plain[last], 0.01 * plain[last]) << "at rest by then";
  EXPECT_LT(creeping[middle], 0.95 * plain[middle]);
  EXPECT_GT(creeping[last], creeping[middle] + 0.03 * plain[last]);
  EXPECT_NEAR(creeping[0], plain[0], 1e-9);
}

TEST(RigCreep, IsInTheTruthAndRefusedInOneLine) {
  const std::string truth = truth_yaml(parse_scenario(
      text("  creep: {moment: [{time_s: 1.25, share: 0.375}], before_moment_nm: [0.0125, 0]}\n"), "s.yaml"));
  for (const char* words : {"time_s: 1.25", "share: 0.375", "decades: 0.3", "before_moment_x_nm: 0.0125"})
    EXPECT_THAT(truth, HasSubstr(words));
  const auto refusal = [](const std::string& creep) -> std::string {
    try {
      parse_scenario(text(creep), "s.yaml");
      return "";
    } catch (const std::exception& e) {
      return e.what();
    }
  };
  EXPECT_THAT(refusal("  creep: {moment: [{time_s: 1, share: 0.5}, {time_s: 9, share: 0.6}]}\n"),
              HasSubstr("allowed together [0, 0.98]"));
  EXPECT_THAT(refusal("  creep: {moment: [{time_s: 0, share: 0.5}]}\n"), HasSubstr("time_s"));
  EXPECT_THAT(refusal("  creep: {bending: []}\n"), HasSubstr("bending"));
}

}  // namespace
}  // namespace softarm::rig
