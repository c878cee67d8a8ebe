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

TEST(ProveSignal, WhatSignaturesDoNotTellApartIsOneClass) {
  using Names = std::vector<std::string>;
  // With 100 standard deviations: a sine of 0.03 is three of them.
  const std::vector<Ideal> list{
      {"first", 0.95, 1.0, 0.99},      // explains more, and can be told from it
      {"hidden", 0.9, 0.99, 1.0},      // all others are measured by this one
      {"same", 0.9, 0.99, 0.9999},     // a sine of 0.014
      {"apart", 0.9, 0.99, 0.9990},    // 0.045
      {"other way", 0.0, 0.99, 1.0}};  // the same signature, with a sign it cannot have
  EXPECT_EQ(not_told_apart(list, "hidden", 100.0), Names{"same"});
  EXPECT_EQ(not_told_apart(list, "hidden", 20.0), (Names{"first", "same", "apart"})) << "weaker";
  EXPECT_EQ(not_told_apart(list, "hidden", 1e4), Names{}) << "stronger";
  EXPECT_EQ(not_told_apart(list, "other way", 1.0), Names{}) << "its own law explains nothing";
  EXPECT_EQ(not_told_apart(list, "", 1.0), Names{});
  EXPECT_EQ(not_told_apart({{"hidden", 0.9, 1.0, 1.0}, {"some", 0.9, 0.9, 0.9}}, "hidden", 1.0), Names{})
      << "whatever is weak: signatures as different as that are no class";
}

TEST(ProveSignal, CosinesAreWithTheHiddenEffect) {
  const RecordedCase plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0);
  Reference reference(plain.arm, plain.trials, 0);
  const Left own = reference.residuals(plain.trials);
  const Signal signal = reference.signal(with_instants_off(own, 4, 0.02), own);
  const std::vector<Ideal> list = reference.ideal(signal, "shear");
  for (const Ideal& ideal : list) {
    EXPECT_LE(ideal.own_cosine, 1.0 + 1e-9) << ideal.effect;
    if (ideal.effect == "shear") {
      EXPECT_NEAR(ideal.own_cosine, 1.0, 1e-9);
      EXPECT_NEAR(ideal.cosine, list.front().own_cosine, 1e-9);
    }
  }
  EXPECT_TRUE(std::all_of(list.begin(), list.end(), [](const Ideal& i) { return i.explains <= 1.0 + 1e-9; }));
}

}  // namespace
}  // namespace softarm::prove
