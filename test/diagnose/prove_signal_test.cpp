// What of a hidden effect the arm's constants leave to be found.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

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

}  // namespace
}  // namespace softarm::prove
