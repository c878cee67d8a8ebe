// Trials of the virtual rig to verdicts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "effect_ids.h"
#include "recorded_case.h"
#include "rig/hidden.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using testing::drawn_case;
using testing::ids;
using testing::record;
using testing::recorded_case;
using testing::RecordedCase;

const diagnose::Shift& shift_of(const diagnose::Diagnosis& d, const std::string& name) {
  const auto found = std::find_if(d.shifts.begin(), d.shifts.end(),
                                  [&](const diagnose::Shift& s) { return s.name == name; });
  if (found == d.shifts.end()) throw std::out_of_range(name);
  return *found;
}

const diagnose::EffectValue& number_of(const diagnose::NamedEffect& effect, const std::string& symbol) {
  const auto found = std::find_if(effect.parameters.begin(), effect.parameters.end(),
                                  [&](const diagnose::EffectValue& v) { return v.symbol == symbol; });
  if (found == effect.parameters.end()) throw std::out_of_range(symbol);
  return *found;
}

TEST(Diagnose, WhereNothingIsHiddenNothingIsNamed) {
  const auto recorded = recorded_case("{count_weights: [1]}", 3);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kConsistent) << report::describe(d);
  EXPECT_TRUE(d.effects.empty());
  EXPECT_FALSE(d.discovered_law);
  EXPECT_LT(d.baseline.held_out_rms_m, 1.5 * d.noise_floor_m);
  for (const diagnose::Candidate& c : d.ranking) EXPECT_LT(c.probability, 0.5) << c.id;
  EXPECT_NEAR(shift_of(d, "segment_1.bending_stiffness.base").before,
              recorded.truth[0].arm.segments[0].stiffness_base_nm2, 3e-4);
}

/// What effects would explain of it is not the arm's.
TEST(Diagnose, LooksForNoEffectsWhereRingsHaveOneAnothersNames) {
  RecordedCase recorded = recorded_case("{count_weights: [1]}", 43, 3, 8.0);
  std::vector<arm::MeasuredBody*> rings;
  for (arm::MeasuredBody& body : recorded.arm.bodies)
    if (body.kind == arm::BodyKind::kRing) rings.push_back(&body);
  ASSERT_GE(rings.size(), 3U);
  std::swap(rings[0]->arclength_m, rings[1]->arclength_m);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  ASSERT_TRUE(d.exchanged_names);
  EXPECT_EQ(d.exchanged_names->trials.size(), recorded.trials.size());
  EXPECT_EQ(d.summary.rfind("From base to tip", 0), 0U) << d.summary;
  EXPECT_NE(d.summary.find("No effects were looked for."), std::string::npos) << d.summary;
  EXPECT_TRUE(d.effects.empty() && d.small_departures.empty() && d.stand_ins.empty());
}

TEST(Diagnose, ABaseThatYieldsIsFoundBehindALowerStiffness) {
  const auto recorded =
      recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kExplained) << report::describe(d);
  ASSERT_EQ(d.effects.size(), 1u) << report::describe(d);
  const diagnose::NamedEffect& named = d.effects[0];
  EXPECT_EQ(named.id, "base_compliance");
  EXPECT_GT(named.probability, 0.9);
  ASSERT_TRUE(named.where.s_to_m);
  EXPECT_EQ(*named.where.s_to_m, 0.0);
  const double truth = 1.0 / recorded.truth[0].hidden.at(0).values.at("stiffness_nm_per_rad");
  EXPECT_NEAR(named.parameters.at(0).value, truth, 0.03 * truth);
  EXPECT_LT(named.parameters[0].low, named.parameters[0].value);
  EXPECT_LT(d.extended.held_out_rms_m, 1.5 * d.noise_floor_m);
  EXPECT_GT(d.baseline.held_out_rms_m, 2.0 * d.extended.held_out_rms_m);
  // What hid it: the stiffness was too low, and is right now.
  const double ei = recorded.truth[0].arm.segments[0].stiffness_base_nm2;
  const diagnose::Shift& shift = shift_of(d, "segment_1.bending_stiffness.base");
  EXPECT_LT(shift.before, 0.97 * ei);
  EXPECT_NEAR(shift.after, ei, 0.01 * ei);
  const auto own = std::find_if(d.ranking.begin(), d.ranking.end(),
                                [](const diagnose::Candidate& c) { return c.id == "base_compliance"; });
  ASSERT_NE(own, d.ranking.end());
  EXPECT_GT(own->collinearity, 0.5);
  EXPECT_EQ(own->finding, diagnose::Finding::kPresent);
}

/// The trials of a case with a ring so far along the arm from where it should be.
RecordedCase with_ring_off(const std::string& effects, std::uint64_t seed, double along_m) {
  RecordedCase out = drawn_case(effects, seed, 4, 8.0);
  for (std::size_t i = 0; i < out.truth.size(); ++i) {
    rig::hide(
        {"marker_slip",
         "",
         {{"body", 3.0}, {"along_m", along_m}, {"sideways_m", 0.0}, {"direction_deg", 0.0}, {"from_s", 0.0}}},
        out.truth[i]);
    out.trials.push_back(record(out.arm, out.truth[i], "trial_" + std::to_string(i + 1)));
  }
  return out;
}

TEST(Diagnose, ARingALittleOffIsWhatEveryArmHas) {
  const RecordedCase recorded = with_ring_off("{count_weights: [1]}", 3, 0.6e-3);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kConsistent) << report::describe(d);
  EXPECT_TRUE(d.effects.empty());
  ASSERT_EQ(ids(d.small_departures), std::vector<std::string>{"marker_slip"}) << report::describe(d);
  const auto& along = d.small_departures[0].parameters.at(2);
  EXPECT_NEAR(along.value, 0.6e-3, 0.1e-3);
  EXPECT_THAT(d.summary, ::testing::HasSubstr("Small departures, as every arm has them: marker_slip."));
}

TEST(Diagnose, BesideSomethingLargeItIsNotInTheHeadline) {
  const RecordedCase recorded =
      with_ring_off("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 0.6e-3);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kExplained) << report::describe(d);
  EXPECT_EQ(ids(d.effects), std::vector<std::string>{"base_compliance"}) << report::describe(d);
  EXPECT_EQ(ids(d.small_departures), std::vector<std::string>{"marker_slip"}) << report::describe(d);
  EXPECT_GT(d.effects[0].share, 0.7);
}

TEST(Diagnose, ARingThatIsFarOffIsNamed) {
  const RecordedCase recorded = with_ring_off("{count_weights: [1]}", 3, 3e-3);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kExplained) << report::describe(d);
  ASSERT_EQ(ids(d.effects), std::vector<std::string>{"marker_slip"}) << report::describe(d);
  const diagnose::NamedEffect& named = d.effects[0];
  EXPECT_GT(named.probability, 0.9) << report::describe(d);
  EXPECT_EQ(number_of(named, "body").value, 3.0) << report::describe(d);
  ASSERT_TRUE(named.where.s_from_m);
  EXPECT_NEAR(*named.where.s_from_m, 0.15, 1e-6);
  EXPECT_NEAR(number_of(named, "z_m").value, 3e-3, 0.6e-3) << report::describe(d);
  // Nothing else is far off, and nothing else is said to be.
  for (const char* across : {"x_m", "y_m"})
    EXPECT_NEAR(number_of(named, across).value, 0.0, 0.6e-3) << report::describe(d);
  for (const diagnose::NamedEffect& small : d.small_departures)
    EXPECT_LT(small.probability, 0.9) << report::describe(d);
}

/// An arm of which nothing is quite as its file says: half a millimetre together, and perhaps one thing more.
RecordedCase untidy(const std::optional<rig::HiddenChoice>& more) {
  RecordedCase out = drawn_case("{count_weights: [1]}", 11, 6, 10.0);
  for (std::size_t i = 0; i < out.truth.size(); ++i) {
    rig::Scenario& scenario = out.truth[i];
    scenario.arm.segments[0].mass_kg *= 1.02;
    rig::hide({"base_tilt", "", {{"angle_deg", 0.15}, {"azimuth_deg", 40.0}}}, scenario);
    rig::hide({"stiffness_taper", "linear", {{"share", 0.03}}}, scenario);
    rig::hide({"marker_slip",
               "",
               {{"body", 2.0},
                {"along_m", 0.4e-3},
                {"sideways_m", 0.2e-3},
                {"direction_deg", 0.0},
                {"from_s", 0.0}}},
              scenario);
    rig::hide({"chamber_mismatch", "", {{"chamber", 2.0}, {"share", 0.01}}}, scenario);
    if (more) rig::hide(*more, scenario);
    out.trials.push_back(record(out.arm, scenario, "trial_" + std::to_string(i + 1)));
  }
  return out;
}

// The weight of the arm shows as that of the payloads: EI and the gains go with the former.
TEST(Diagnose, OfAnUntidyArmTheDeparturesAreFoundAndNothingElse) {
  const RecordedCase recorded = untidy({});
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  // The largest is at the size from which on a departure is no small one.
  EXPECT_THAT(ids(d.effects), ::testing::IsSubsetOf({"stiffness_taper"})) << report::describe(d);
  std::vector<std::string> sure;
  for (const auto* list : {&d.effects, &d.small_departures}) {
    EXPECT_THAT(ids(*list),
                ::testing::IsSubsetOf({"stiffness_taper", "base_tilt", "marker_slip", "payload_scale"}))
        << report::describe(d);
    for (const diagnose::NamedEffect& one : *list)
      if (one.probability > 0.8) sure.push_back(one.id);
  }
  EXPECT_THAT(sure, ::testing::IsSupersetOf({"stiffness_taper", "base_tilt", "marker_slip"}))
      << report::describe(d);
  EXPECT_NE(d.verdict, diagnose::Verdict::kUnknown) << report::describe(d);
}

TEST(Diagnose, InAnUntidyArmWhatStandsOutIsNamedAlone) {
  const RecordedCase recorded = untidy(
      rig::HiddenChoice{"gain_nonlinearity", "saturating", {{"share", -0.12}, {"reference_pa", 50e3}}});
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(ids(d.effects), std::vector<std::string>{"gain_nonlinearity"}) << report::describe(d);
  EXPECT_GT(d.effects.at(0).probability, 0.9) << report::describe(d);
  EXPECT_NEAR(d.effects.at(0).parameters.at(0).value, -0.12, 0.05) << report::describe(d);
  EXPECT_NE(d.verdict, diagnose::Verdict::kUnknown) << report::describe(d);
}

struct OneChamber {
  rig::HiddenChoice hidden;
  double chamber;
};

class OfOneChamber : public ::testing::TestWithParam<OneChamber> {};

TEST_P(OfOneChamber, InAnUntidyArmItIsNamedWithTheChamber) {
  const auto& [hidden, chamber] = GetParam();
  const RecordedCase recorded = untidy(hidden);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  ASSERT_FALSE(d.effects.empty()) << report::describe(d);
  EXPECT_EQ(d.effects[0].id, hidden.effect) << report::describe(d);
  EXPECT_GT(d.effects[0].probability, 0.9) << report::describe(d);
  EXPECT_EQ(number_of(d.effects[0], "chamber").value, chamber) << report::describe(d);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, OfOneChamber,
    ::testing::Values(
        OneChamber{{"pressure_dead_zone", "smooth", {{"pressure_pa", 4e3}, {"chamber", 2.0}}}, 2.0},
        OneChamber{{"pressure_lag",
                    "choked",
                    {{"time_constant_s", 0.3}, {"vent_time_constant_s", 0.4}, {"chamber", 3.0}}},
                   3.0},
        OneChamber{{"hysteresis", "bouc_wen", {{"loop_pa", 4e3}, {"chamber", 1.0}}}, 1.0}),
    [](const auto& fault) { return fault.param.hidden.effect; });

/// A fit to poses that come late finds a lag; that is no motion for the sake of which trials are left out.
TEST(Diagnose, ClocksAQuarterOfASecondApartAreNamedAndNoSwing) {
  RecordedCase late = recorded_case("{count_weights: [1]}", 8, 4, 10.0);
  const diagnose::Diagnosis calm = diagnose::diagnose(late.arm, late.trials);
  for (trial::Trial& trial : late.trials) {
    for (trial::Frame& frame : trial.frames) frame.stamp_ns += 250'000'000;
  }
  const diagnose::Diagnosis d = diagnose::diagnose(late.arm, late.trials);
  EXPECT_LT(d.left_out_share, calm.left_out_share + 0.05) << report::describe(d);
  EXPECT_THAT(d.verdict, ::testing::AnyOf(diagnose::Verdict::kExplained, diagnose::Verdict::kPartlyExplained))
      << report::describe(d);
  ASSERT_FALSE(d.effects.empty()) << report::describe(d);
  const diagnose::NamedEffect& named = d.effects.front();
  EXPECT_EQ(named.id, "clock_offset") << report::describe(d);
  EXPECT_GT(named.probability, 0.9) << report::describe(d);
  EXPECT_NEAR(number_of(named, "offset_s").value, 0.25, 0.02) << report::describe(d);
  EXPECT_EQ(number_of(named, "input").value, 0.0) << "all inputs are late, not one: " << report::describe(d);
}

/// Recorded one after the other, by cameras whose clock gets ahead of the inputs' all the while.
TEST(Diagnose, ClocksThatDriftApartOverTheSessionAreNamedWithTheirRate) {
  constexpr double kRate = 0.003, kEvery_s = 40.0;
  RecordedCase drifting = recorded_case("{count_weights: [1]}", 8, 4, 10.0);
  const std::int64_t begin_ns = drifting.trials.front().frames.front().stamp_ns;
  for (std::size_t k = 0; k < drifting.trials.size(); ++k) {
    const std::int64_t later_ns = trial::to_nanoseconds(kEvery_s * static_cast<double>(k));
    for (trial::InputSeries& input : drifting.trials[k].inputs) {
      for (std::int64_t& stamp_ns : input.stamp_ns) stamp_ns += later_ns;
    }
    for (trial::Frame& frame : drifting.trials[k].frames) {
      frame.stamp_ns += later_ns;
      frame.stamp_ns += std::llround(kRate * static_cast<double>(frame.stamp_ns - begin_ns));
    }
  }
  const diagnose::Diagnosis d = diagnose::diagnose(drifting.arm, drifting.trials);
  ASSERT_FALSE(d.effects.empty()) << report::describe(d);
  const diagnose::NamedEffect& named = d.effects.front();
  EXPECT_EQ(named.id, "clock_drift") << report::describe(d);
  EXPECT_GT(named.probability, 0.9) << report::describe(d);
  EXPECT_NEAR(number_of(named, "rate").value, kRate, 2e-4) << report::describe(d);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kExplained) << report::describe(d);
}

TEST(Diagnose, WhatIsNotInTheCatalogueIsNotNamedWithConfidence) {
  const auto recorded =
      recorded_case("{count_weights: [0, 1], from: [supply_ripple], size: [0.9, 1]}", 5, 4, 8.0);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  EXPECT_EQ(d.verdict, diagnose::Verdict::kUnknown) << report::describe(d);
  EXPECT_GT(d.baseline.held_out_rms_m, 1.5 * d.noise_floor_m) << "nothing is there that could be named";
  for (const auto* list : {&d.effects, &d.small_departures, &d.stand_ins})
    for (const diagnose::NamedEffect& effect : *list)
      EXPECT_LT(effect.probability, 0.9) << effect.id << '\n' << report::describe(d);
  // The lists may be empty; the ranking has the whole catalogue.
  ASSERT_FALSE(d.ranking.empty());
  for (const diagnose::Candidate& c : d.ranking)
    EXPECT_LT(c.probability, 0.9) << c.id << '\n' << report::describe(d);
  EXPECT_LE(d.explained_share, 1.0);
  EXPECT_LE(d.ceiling_rms_m, d.baseline.held_out_rms_m);
}

TEST(Diagnose, TheSameTrialsGiveTheSameReportOnAnyNumberOfThreadsInAnyOrder) {
  auto recorded =
      recorded_case("{count_weights: [0, 1], from: [base_tilt, tether], size: [0.5, 0.5]}", 6, 3, 8.0);
  diagnose::Options one, three;
  one.jobs = 1;
  three.jobs = 3;
  const auto by_one = report::to_json(diagnose::diagnose(recorded.arm, recorded.trials, one));
  std::rotate(recorded.trials.begin(), recorded.trials.begin() + 2, recorded.trials.end());
  std::swap(recorded.trials[1], recorded.trials[2]);
  EXPECT_EQ(by_one, report::to_json(diagnose::diagnose(recorded.arm, recorded.trials, three)));
}

TEST(Diagnose, ProgressRunsFromNothingToAll) {
  const auto recorded = recorded_case("{count_weights: [1]}", 7, 2, 6.0);
  std::vector<double> shares;
  const diagnose::Diagnosis d = diagnose::diagnose(
      recorded.arm, recorded.trials, {}, [&](double share, const std::string&) { shares.push_back(share); });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_DOUBLE_EQ(shares.back(), 1.0);
  EXPECT_THAT(d.notes, ::testing::Contains(::testing::HasSubstr("Fewer than three trials")));
}

TEST(Diagnose, TrialsThatCannotBeUsedAreRefusedInOneLine) {
  const arm::Arm arm = recorded_case("{count_weights: [1]}", 8, 1, 5.0).arm;
  try {
    diagnose::diagnose(arm, {{"empty", {}}});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::Not(::testing::HasSubstr("\n")));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("no frame"));
  }
}

}  // namespace
}  // namespace softarm::diagnose
