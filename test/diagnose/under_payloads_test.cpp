// Nobody is accused of a payload where what was told does as well from better constants.
#include "under_payloads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

using testing::RecordedCase;

struct Concluded {
  std::unique_ptr<Begun> begun;
  Conclusion conclusion;
};

struct AsTold {
  explicit AsTold(const RecordedCase& recorded)
      : arm(recorded.arm), prepared(model::prepare(arm, recorded.trials, {})) {}

  Concluded under(const std::vector<model::TrialData>& trials, std::size_t most_effects) {
    Options some = options;
    some.most_effects = most_effects;
    Concluded all{std::make_unique<Begun>(arm, trials, some, schedule), {}};
    schedule.end_first_part();
    all.conclusion = concluded(prepared, *all.begun, std::nullopt, some, schedule);
    return all;
  }

  const arm::Arm arm;
  const model::Prepared prepared;
  const Options options;
  Schedule schedule{{}, [] { return 0.0; }};
};

/// The trials with another payload in the one that bears most.
std::vector<model::TrialData> with_scaled(double factor, std::vector<model::TrialData> trials) {
  const auto heaviest = std::max_element(trials.begin(), trials.end(), [](const auto& a, const auto& b) {
    return a.series.payload_kg.maxCoeff() < b.series.payload_kg.maxCoeff();
  });
  heaviest->series.payload_kg *= factor;
  return trials;
}

UnderOthers others_of(Concluded concluded) {
  return {std::move(concluded.begun), std::move(concluded.conclusion)};
}

AsToldAnew from_there(AsTold& trials, const UnderOthers& others, Concluded& as_told) {
  return as_told_from(others, trials.prepared, as_told.conclusion, *as_told.begun, trials.options,
                      trials.schedule);
}

/// The fit as told is a poor one here, as it knows no effects, nor the best constants; the one under a
/// payload 2 % off has found them.
TEST(UnderPayloads, WhatWasToldRightDoesAsWellFromThere) {
  AsTold trials(testing::recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.5, 0.5]}",
                                       3, 4, 8.0));
  Concluded as_told = trials.under(trials.prepared.trials, 0);
  const double poor_m = as_told.conclusion.diagnosis.extended.held_out_mean_m;
  const std::vector<model::TrialData> nearly = with_scaled(1.02, trials.prepared.trials);
  const UnderOthers others = others_of(trials.under(nearly, 8));
  ASSERT_LT(others.conclusion.diagnosis.extended.held_out_mean_m, 0.8 * poor_m);
  as_told.conclusion.selection.baseline.square *= 1.1;  // as if it had ended elsewhere
  const AsToldAnew anew = from_there(trials, others, as_told);
  EXPECT_TRUE(anew.does_as_well);
  ASSERT_TRUE(anew.conclusion);
  EXPECT_LT(anew.mean_m, 0.8 * poor_m);
  EXPECT_LT(anew.conclusion->diagnosis.extended.held_out_mean_m, 0.8 * poor_m);
  ASSERT_FALSE(anew.conclusion->diagnosis.effects.empty());
  EXPECT_EQ(anew.conclusion->diagnosis.effects.front().id, "base_compliance");
}

/// From the same constants all that follows is the same.
TEST(UnderPayloads, NothingIsConcludedTwice) {
  AsTold trials(testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0));
  Concluded as_told = trials.under(trials.prepared.trials, 0);
  const UnderOthers others = others_of(trials.under(with_scaled(1.02, trials.prepared.trials), 0));
  const AsToldAnew anew = from_there(trials, others, as_told);
  EXPECT_TRUE(anew.does_as_well);
  EXPECT_FALSE(anew.conclusion);
}

/// Half of what hung was told in one trial: no better beginning makes that right.
TEST(UnderPayloads, WhatWasToldWrongDoesNot) {
  AsTold trials(testing::recorded_case("{count_weights: [1]}", 3, 4, 8.0));
  const std::vector<model::TrialData> told = with_scaled(0.5, trials.prepared.trials);
  Concluded as_told = trials.under(told, 8);
  const UnderOthers others = others_of(trials.under(trials.prepared.trials, 8));
  const AsToldAnew anew = from_there(trials, others, as_told);
  EXPECT_FALSE(anew.does_as_well);
  EXPECT_FALSE(anew.conclusion);
  EXPECT_GT(anew.mean_m, 1.25 * others.conclusion.diagnosis.extended.held_out_mean_m);
}

}  // namespace
}  // namespace softarm::diagnose
