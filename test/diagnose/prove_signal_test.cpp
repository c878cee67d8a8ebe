// What of a hidden effect the arm's constants leave to be found.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "prove/signal.h"
#include "recorded_case.h"

namespace softarm::prove {
namespace {

using diagnose::testing::record;
using diagnose::testing::RecordedCase;

TEST(ProveSignal, WhatConstantsAbsorbIsNotLeft) {
  const RecordedCase plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0);
  Reference reference(plain.arm, plain.trials, 0);
  const auto said = [&](const std::function<double(double)>& logged) {
    std::vector<trial::Trial> trials;
    for (std::size_t i = 0; i < plain.truth.size(); ++i)
      trials.push_back(record(plain.arm, plain.truth[i], plain.trials[i].name, [&](rig::InputSample& input) {
        const double ambient = plain.arm.inputs.ambient_pressure_pa;
        input.value = ambient + logged(input.value - ambient);
        return true;
      }));
    return reference.signal(reference.residuals(trials), reference.residuals(plain.trials));
  };
  // A third less is logged than acts: the gains take it, and what goes with pressure besides takes the rest.
  const Signal gain = said([](double pa) { return pa / 1.5; });
  EXPECT_GT(gain.raw_m, 5e-3);
  EXPECT_LT(gain.leftover_m, 1e-4);
  // Small pressures are logged as none: no constant does that.
  const Signal dead = said([](double pa) { return std::max(0.0, pa - 5e3); });
  EXPECT_GT(dead.leftover_m, 5e-4);
  EXPECT_LT(dead.leftover_m, dead.raw_m);
  EXPECT_EQ(
      reference.signal(reference.residuals(plain.trials), reference.residuals(plain.trials)).leftover_snr,
      0.0);
}

std::size_t count_of(const Residuals& residuals) {
  std::size_t sum = 0;
  for (const auto& trial : residuals) sum += trial.size();
  return sum;
}

TEST(ProveSignal, RecordingsThatAreCutAtOtherTimesLoseNothing) {
  const RecordedCase plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0);
  Reference reference(plain.arm, plain.trials, 0);
  const Left own = reference.residuals(plain.trials);
  // A few frames are lost early on: from there on means begin elsewhere.
  std::vector<trial::Trial> trials = plain.trials;
  for (trial::Trial& trial : trials) trial.frames.erase(trial.frames.begin() + 61, trial.frames.begin() + 75);
  const Left cut = reference.residuals(trials);
  EXPECT_LT(count_of(differences(cut.held, own.held)), count_of(own.held) * 4 / 5);
  const Signal same = reference.signal(own, own), other = reference.signal(cut, own);
  EXPECT_GT(other.there.sum(), 0.98 * same.there.sum());
  EXPECT_EQ(count_of(other.moved), count_of(same.moved));
  EXPECT_LT(other.raw_m, 3e-4) << "the noise of means that are not the same ones";
  // The same move everywhere, out of step.
  Left still{own.held, own.refitted}, moved;
  for (std::size_t t = 0; t < own.held.size(); ++t) {
    moved.held.emplace_back();
    for (auto& [key, residual] : still.held[t]) {
      residual.setZero();
      moved.held[t][{key.first + 1, key.second}] = 1e-3 * Eigen::Vector3d::UnitY();
    }
  }
  moved.refitted = moved.held;
  still.refitted = still.held;
  const Signal constant = reference.signal(moved, still);
  EXPECT_NEAR(constant.raw_m, 1e-3, 1e-9);
  EXPECT_GT(constant.there.sum(), 0.95 * same.there.sum());
  EXPECT_LT(constant.leftover_m, constant.raw_m);
}

/// Residuals of the same with one instant of each of these trials off, at all bodies.
Left with_instants_off(const Left& own, std::size_t trials, double by_m) {
  Left off = own;
  for (std::size_t t = 0; t < trials; ++t) {
    const std::int64_t when =
        std::next(own.held[t].begin(), static_cast<std::ptrdiff_t>(own.held[t].size() / 2))->first.first;
    for (Residuals* all : {&off.held, &off.refitted})
      for (auto& [key, residual] : (*all)[t])
        if (key.first == when && key.second >= 0) residual += by_m * Eigen::Vector3d::UnitX();
  }
  return off;
}

TEST(ProveSignal, AnInstantThatStandsOutCountsAsInTheDiagnosis) {
  const RecordedCase plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0);
  Reference reference(plain.arm, plain.trials, 0);
  const Left own = reference.residuals(plain.trials);
  const auto off = [&](double by_m) { return reference.signal(with_instants_off(own, 4, by_m), own); };
  // Beyond the threshold squares grow as distances do.
  const Signal some = off(0.02), more = off(0.08);
  EXPECT_GT(some.leftover_snr, 5.0);
  EXPECT_NEAR(more.raw_snr, 2.0 * some.raw_snr, 0.1 * some.raw_snr);
  EXPECT_NEAR(more.leftover_snr, 2.0 * some.leftover_snr, 0.1 * some.leftover_snr);
  EXPECT_NEAR(more.leftover_m, 2.0 * some.leftover_m, 0.1 * some.leftover_m);
  EXPECT_NEAR(more.left.norm(), more.leftover_snr, 1e-9);
  // What is not beyond it counts in full.
  const Signal little = off(1e-4), half = off(5e-5);
  EXPECT_NEAR(little.raw_snr, 2.0 * half.raw_snr, 1e-6 * little.raw_snr);
  EXPECT_NEAR(little.leftover_snr, 2.0 * half.leftover_snr, 1e-6 * little.leftover_snr);
}

}  // namespace
}  // namespace softarm::prove
