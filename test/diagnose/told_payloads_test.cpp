// Payloads that are not what was told.
#include "told_payloads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "looked.h"
#include "policy.h"
#include "recorded_case.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using ::testing::HasSubstr;
using testing::Looked;
using testing::RecordedCase;

constexpr const char* kNothing = "{count_weights: [1]}";

/// The payload that is hung on during a trial.
double hung_kg(const trial::Trial& trial) {
  return trial.frames.back().payload_kg.value();
}

/// Tells another one in its place.
void tell(double kg, trial::Trial& trial) {
  for (trial::Frame& frame : trial.frames)
    if (frame.payload_kg.value() > 0.0) frame.payload_kg = kg;
}

std::size_t heaviest(const RecordedCase& recorded) {
  const auto& trials = recorded.trials;
  return static_cast<std::size_t>(
      std::max_element(trials.begin(), trials.end(),
                       [](const auto& a, const auto& b) { return hung_kg(a) < hung_kg(b); }) -
      trials.begin());
}

std::vector<OtherPayload> looked_for(const RecordedCase& recorded) {
  Looked looked(recorded.arm, recorded.trials);
  return other_payloads(looked.model, looked.baseline, {},
                        usual_payload_kg(recorded.arm, looked.model.trials()));
}

TEST(ToldPayloads, WhatWasToldRightIsNotContradicted) {
  EXPECT_TRUE(looked_for(testing::recorded_case(kNothing, 3, 4, 8.0)).empty());
}

/// A scale that is wrong in all trials is the catalogue's, however far it is off.
TEST(ToldPayloads, AScaleThatIsOffIsNoneOfThem) {
  RecordedCase recorded = testing::recorded_case(kNothing, 3, 4, 8.0);
  for (trial::Trial& trial : recorded.trials) tell(0.7 * hung_kg(trial), trial);
  const Diagnosis d = diagnose(recorded.arm, recorded.trials);
  EXPECT_FALSE(d.told_payloads) << d.summary;
  ASSERT_FALSE(d.effects.empty()) << report::describe(d);
  EXPECT_EQ(d.effects[0].id, "payload_scale") << report::describe(d);
}

/// Less than nothing hangs nowhere: what looks like it is something else.
TEST(ToldPayloads, NoneIsLighterThanNothing) {
  RecordedCase recorded = testing::recorded_case(kNothing, 3, 4, 8.0);
  for (trial::Trial& trial : recorded.trials) tell(0.0, trial);
  for (trial::Frame& frame : recorded.trials.front().frames) frame.payload_kg = 0.3;
  Looked looked(recorded.arm, recorded.trials);
  const double usual_kg = usual_payload_kg(recorded.arm, looked.model.trials());
  EXPECT_EQ(usual_kg, 0.3);
  const std::vector<OtherPayload> other = other_payloads(looked.model, looked.baseline, {}, usual_kg);
  EXPECT_FALSE(other.empty());
  for (const model::TrialData& trial : under(other, looked.model.trials()))
    EXPECT_GE(trial.series.payload_kg.minCoeff(), 0.0) << trial.name;
  for (const ToldPayload& one : told_payloads(other, looked.model.trials()).trials) {
    EXPECT_GE(one.found_kg, 0.0) << one.trial;
    EXPECT_NE(one.found_kg, one.told_kg) << one.trial;
  }
}

/// It is hung on after a quarter of the trial.
TEST(ToldPayloads, OneThatWasNotToldIsFoundWithItsWeightAndWhen) {
  RecordedCase recorded = testing::recorded_case(kNothing, 3, 4, 8.0);
  const std::size_t loaded = heaviest(recorded);
  const double kg = hung_kg(recorded.trials[loaded]);
  ASSERT_GT(kg, 0.03);
  tell(0.0, recorded.trials[loaded]);
  const std::vector<OtherPayload> other = looked_for(recorded);
  ASSERT_EQ(other.size(), 1U);
  ASSERT_EQ(other[0].where.size(), 1U);
  EXPECT_EQ(other[0].where[0].trial, loaded);
  EXPECT_NEAR(other[0].more_kg, kg, 0.25 * kg);  // to first order

  const Diagnosis d = diagnose(recorded.arm, recorded.trials);
  ASSERT_TRUE(d.told_payloads) << report::describe(d);
  ASSERT_EQ(d.told_payloads->trials.size(), 1U) << d.summary;
  const ToldPayload& one = d.told_payloads->trials[0];
  EXPECT_EQ(one.trial, recorded.trials[loaded].name);
  EXPECT_EQ(one.told_kg, 0.0);
  EXPECT_NEAR(one.found_kg, kg, 0.02 * kg) << d.summary;
  EXPECT_LT(one.low_kg, one.found_kg);
  EXPECT_GT(one.high_kg, one.found_kg);
  ASSERT_TRUE(one.from_s) << d.summary;
  EXPECT_NEAR(*one.from_s, 2.0, 1.0);
  EXPECT_FALSE(one.to_s);
  EXPECT_LT(d.told_payloads->mean_m, 0.5 * d.told_payloads->as_told_mean_m);
  EXPECT_EQ(d.summary.rfind("In " + one.trial + " from ", 0), 0U) << d.summary;
  EXPECT_THAT(d.summary, HasSubstr("and nothing was told"));
  EXPECT_THAT(report::describe(d), HasSubstr(" UNDER OTHER PAYLOADS: "));
}

TEST(ToldPayloads, ThoseOfTwoTrialsThatWereExchangedAreFound) {
  RecordedCase recorded = testing::recorded_case(kNothing, 3, 4, 8.0);
  const std::size_t heavy = heaviest(recorded);
  std::size_t light = 0;
  for (std::size_t t = 0; t < recorded.trials.size(); ++t)
    if (hung_kg(recorded.trials[t]) < hung_kg(recorded.trials[light])) light = t;
  const double kg[2] = {hung_kg(recorded.trials[light]), hung_kg(recorded.trials[heavy])};
  ASSERT_GT(kg[1], 2.0 * kg[0]);
  tell(kg[0], recorded.trials[heavy]);
  tell(kg[1], recorded.trials[light]);
  const Diagnosis d = diagnose(recorded.arm, recorded.trials);
  ASSERT_TRUE(d.told_payloads) << report::describe(d);
  ASSERT_EQ(d.told_payloads->trials.size(), 2U) << d.summary;
  for (const ToldPayload& one : d.told_payloads->trials) {
    const bool is_heavy = one.trial == recorded.trials[heavy].name;
    EXPECT_TRUE(is_heavy || one.trial == recorded.trials[light].name) << one.trial;
    EXPECT_NEAR(one.found_kg, kg[is_heavy], 0.05 * kg[1]) << d.summary;
  }
}

/// Of trials that were told one payload all along, half of them another one: no trial alone is at odds with
/// the others of its kind.
TEST(ToldPayloads, ThoseOfAllTrialsThatWereExchangedAreFound) {
  RecordedCase recorded = testing::drawn_case(kNothing, 3, 4, 8.0);
  constexpr double kHeavy_kg = 0.1;
  for (std::size_t t = 0; t < recorded.truth.size(); ++t) {
    recorded.truth[t].payload.schedule = {{0.0, {t % 2 == 0 ? 0.0 : kHeavy_kg}, {}}};
    recorded.trials.push_back(
        testing::record(recorded.arm, recorded.truth[t], "trial_" + std::to_string(t + 1)));
    for (trial::Frame& frame : recorded.trials.back().frames) frame.payload_kg = t % 2 == 0 ? kHeavy_kg : 0.0;
  }
  const Diagnosis d = diagnose(recorded.arm, recorded.trials);
  ASSERT_TRUE(d.told_payloads) << report::describe(d);
  ASSERT_EQ(d.told_payloads->trials.size(), 4U) << d.summary;
  for (const ToldPayload& one : d.told_payloads->trials) {
    EXPECT_NEAR(one.found_kg, kHeavy_kg - one.told_kg, 0.05 * kHeavy_kg) << d.summary;
    EXPECT_FALSE(one.from_s || one.to_s);
  }
}

TEST(ToldPayloads, WithoutAnyPayloadTheArmsWeightIsTheMeasure) {
  RecordedCase recorded = testing::recorded_case(kNothing, 3, 2, 5.0);
  for (trial::Trial& trial : recorded.trials) tell(0.0, trial);
  const model::Prepared prepared = model::prepare(recorded.arm, recorded.trials);
  const double kg = usual_payload_kg(recorded.arm, prepared.trials);
  EXPECT_NEAR(kg, kPolicy.experiment.payload_share * mass_kg(recorded.arm), 1e-12);
  EXPECT_GT(kg, 0.0);
}

}  // namespace
}  // namespace softarm::diagnose
