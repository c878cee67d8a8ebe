// What stands first, and what may be mistaken for what.
#include "findings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "effect_ids.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "policy.h"
#include "recorded_case.h"
#include "refits.h"
#include "softarm/arm/arm_file.h"

namespace softarm::diagnose {
namespace {

using testing::ids;

NamedEffect effect(const std::string& id, double probability, double share) {
  NamedEffect one;
  one.id = id;
  one.probability = probability;
  one.share = share;
  return one;
}

TEST(Findings, InertiaThatCountsAsNoiseIsUsual) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.5, 0.6]}", 6, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  looked.model.find_modes(looked.baseline.at, looked.baseline.predicted);
  const double share = looked.model.unknown_inertia(), lag_s = looked.baseline.at.viscoelastic_lag_s;
  ASSERT_GT(share, 0.0);
  ASSERT_GT(lag_s, 0.0);
  const model::Effect* inertia = nullptr;
  for (const std::unique_ptr<model::Effect>& one : effects::catalogue())
    if (one->info().id == "inertia") inertia = one.get();
  const auto usual = [&](double mass_share, double delay_s) {
    return is_usual(looked.model, looked.baseline, {inertia, Eigen::Vector2d(mass_share, delay_s)});
  };
  EXPECT_TRUE(usual(0.9 * share, 0.0));
  EXPECT_TRUE(usual(-0.5 * share, -0.9 * share * lag_s));
  EXPECT_FALSE(usual(1.1 * share, 0.0));
  EXPECT_FALSE(usual(0.5 * share, 1.1 * share * lag_s));
}

TEST(Findings, MayBeMistakenForEachOther) {
  std::vector<NamedEffect> effects{effect("a", 1.0, 0.6), effect("b", 1.0, 0.3), effect("c", 1.0, 0.1)};
  effects[0].confusable_with = {"b", "not_in_the_model"};
  mistake_mutually(effects);
  mistake_mutually(effects);
  EXPECT_EQ(effects[0].confusable_with, (std::vector<std::string>{"b", "not_in_the_model"}));
  EXPECT_EQ(effects[1].confusable_with, std::vector<std::string>{"a"});
  EXPECT_TRUE(effects[2].confusable_with.empty());
}

TEST(Findings, AShortDelayMayBeAnother) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const auto of = [&](const std::string& id, double delay_s) {
    for (const std::unique_ptr<model::Effect>& one : effects::catalogue())
      if (one->info().id == id) {
        model::Present present{one.get(),
                               model::Values::Zero(static_cast<Eigen::Index>(one->info().parameters.size()))};
        present.values[0] = delay_s;
        return present;
      }
    throw std::invalid_argument(id);
  };
  std::vector<NamedEffect> effects{effect("clock_offset", 1.0, 0.5), effect("pressure_lag", 1.0, 0.3),
                                   effect("creep", 1.0, 0.2)};
  for (NamedEffect& one : effects) {
    one.parameters.resize(1);
    one.parameters.front().value = one.id == "clock_offset" ? -0.02 : one.id == "creep" ? 0.01 : 0.3;
    one.parameters.front().low = one.parameters.front().value - 1e-3;
    one.parameters.front().high = one.parameters.front().value + 1e-3;
  }
  mistake_short_delays(arm, {of("clock_offset", -0.02), of("pressure_lag", 0.3), of("creep", 0.01)}, effects);
  EXPECT_EQ(effects[0].confusable_with, std::vector<std::string>{"pressure_lag"});
  EXPECT_TRUE(effects[1].confusable_with.empty());
  EXPECT_TRUE(effects[2].confusable_with.empty());
  // A lag of 20 ms may make all of it, and more.
  EXPECT_LT(effects[0].parameters.front().low, -0.05);
  EXPECT_GT(effects[0].parameters.front().high, 0.01);
  EXPECT_LT(effects[0].parameters.front().high, 0.02);
  EXPECT_DOUBLE_EQ(effects[1].parameters.front().high, 0.301);
  EXPECT_DOUBLE_EQ(effects[2].parameters.front().low, 0.009);
}

TEST(Findings, WhatIsKnownLeadsWhereNothingElseIs) {
  std::vector<NamedEffect> effects{effect("hardly", 0.15, 0.7)};
  std::vector<NamedEffect> small{effect("usual", 1.0, 0.2), effect("clock", 0.99, 0.08),
                                 effect("bow", 1.0, 0.02)};
  lead_with_what_is_known({true, false, false}, effects, small);
  EXPECT_EQ(ids(effects), (std::vector<std::string>{"clock", "hardly"}));
  EXPECT_DOUBLE_EQ(effects.front().probability, 0.99);
  EXPECT_EQ(ids(small), (std::vector<std::string>{"usual", "bow"}));
}

TEST(Findings, ASmallDepartureStaysOneBesideWhatIsKnown) {
  std::vector<NamedEffect> effects{effect("known", 0.6, 0.9)}, small{effect("clock", 1.0, 0.1)};
  lead_with_what_is_known({false}, effects, small);
  EXPECT_EQ(ids(effects), std::vector<std::string>{"known"});
  std::vector<NamedEffect> hardly{effect("hardly", 0.3, 0.9)};
  std::vector<NamedEffect> likely{effect("likely", 0.4, 0.1)};
  lead_with_what_is_known({false}, hardly, likely);  // as little known as the others
  EXPECT_EQ(ids(hardly), std::vector<std::string>{"hardly"});
  std::vector<NamedEffect> none;
  lead_with_what_is_known({false}, none, small);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(ids(small), std::vector<std::string>{"clock"});
}

TEST(Findings, WhatIsLittleBesideWhatIsLeftStandsInForIt) {
  constexpr double length_m = 0.2;
  EXPECT_DOUBLE_EQ(is_no_stand_in(1e-4, 0.0, length_m, false), 1.0);
  EXPECT_DOUBLE_EQ(is_no_stand_in(0.0, 1e-4, length_m, false), 0.0);
  EXPECT_DOUBLE_EQ(is_no_stand_in(0.0, 0.0, length_m, true), 1.0);
  // On an arm of which 3 mm are not understood nothing that explains 0.3 mm is believed, and 3 mm are
  // about as likely there as not.
  EXPECT_LT(is_no_stand_in(0.3e-3, 3e-3, length_m, false), 0.15);
  EXPECT_LT(is_no_stand_in(3e-3, 3e-3, length_m, false), 0.6);
  EXPECT_GT(is_no_stand_in(30e-3, 3e-3, length_m, false), 0.9);
  // Beside no more than departures that every arm has, what explains a fifth of them is.
  EXPECT_GT(is_no_stand_in(0.05e-3, 0.25e-3, length_m, false), 0.75);
  // Another length, all else alike.
  EXPECT_DOUBLE_EQ(is_no_stand_in(2e-3, 3e-3, 2 * length_m, false),
                   is_no_stand_in(1e-3, 1.5e-3, length_m, false));
  // One body that sits elsewhere, no physics of the arm looks like.
  const double of_arm = is_no_stand_in(1e-3, 2e-3, length_m, false),
               of_sensor = is_no_stand_in(1e-3, 2e-3, length_m, true);
  EXPECT_NEAR(of_sensor / (1 - of_sensor), kPolicy.posterior.sensors * of_arm / (1 - of_arm), 1e-9);
}

TEST(Findings, WhatIsInNoModelStandsInForWhatIsLeftAsMuchAsWhatIsInOne) {
  constexpr double length_m = 0.3, left_m = 5e-3;
  std::vector<Screened> screened;
  std::vector<Candidate> ranking;
  for (const char* id : {"hysteresis", "creep", "tether", "marker_slip"}) {
    screened.emplace_back();
    screened.back().effect = effects::find(id);
    screened.back().leftover_m = 1e-3;
    ranking.emplace_back();
    ranking.back().id = id;
    ranking.back().probability = 0.5;
    ranking.back().finding = Finding::kAbsent;
  }
  screened[1].leftover_m = 4.9e-3;       // nearly all of it
  ranking[2].finding = Finding::kRival;  // those are weighed with what they are rivals of
  weigh_left_aside(screened, left_m, length_m, ranking);
  EXPECT_LT(ranking[0].probability, 0.15);
  EXPECT_GT(ranking[1].probability, 0.45);
  EXPECT_EQ(ranking[2].probability, 0.5);
  EXPECT_GT(ranking[3].probability, 1.5 * ranking[0].probability) << "one body that sits elsewhere";
  EXPECT_LT(ranking[3].probability, 0.5);
  Diagnosis d;
  d.ranking = ranking;
  rank_as_said(d);
  EXPECT_EQ(d.ranking.front().id, "tether");
  EXPECT_EQ(d.ranking.back().id, "hysteresis");
}

TEST(Findings, ASmallDepartureIsALittleShareAndAFewTenthsOfAMillimetre) {
  constexpr double length_m = 0.2;  // on which such come to half a millimetre
  EXPECT_TRUE(is_small_share(0.09, 1e-3, length_m));
  EXPECT_FALSE(is_small_share(0.11, 1e-3, length_m));
  EXPECT_FALSE(is_small_share(0.09, 3e-3, length_m)) << "0.9 mm of 3";
  EXPECT_TRUE(is_small_share(0.01, 3e-3, length_m));
}

TEST(Findings, AShortDelayOfClocksMayStandInForPhysics) {
  const auto clock_with = [](double offset_s) {
    for (const std::unique_ptr<model::Effect>& effect : effects::catalogue())
      if (effect->info().of_clocks) return model::Present{effect.get(), Eigen::Vector2d(offset_s, 0.0)};
    throw std::logic_error("no clocks");
  };
  for (const double offset_s : {-0.7, -0.03, 0.004, 0.2}) {
    const model::Present clock = clock_with(offset_s);
    const bool is_short = std::abs(offset_s) < 0.05;
    EXPECT_EQ(is_short_delay(clock), is_short) << offset_s;
    EXPECT_EQ(is_of_sensors_alone(clock.effect->info(), is_short_delay(clock)), !is_short) << offset_s;
  }
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    if (!effect->info().of_clock_rates) continue;
    // A rate is no delay, however small a number it is.
    EXPECT_FALSE(is_short_delay({effect.get(), Eigen::Vector2d(0.002, 0.0)}));
    EXPECT_FALSE(is_of_sensors_alone(effect->info(), false));
  }
  model::Info slipped;
  slipped.family = model::Family::kSensor;
  EXPECT_FALSE(is_of_sensors_alone(slipped, false));  // cameras that bow
  slipped.of_placement = true;
  EXPECT_TRUE(is_of_sensors_alone(slipped, true));  // what is no delay is of sensors whatever else is short
  slipped.family = model::Family::kActuation;
  EXPECT_FALSE(is_of_sensors_alone(slipped, false));
}

TEST(Findings, WhatIsHardlyThereStandsApart) {
  Diagnosis d;
  d.effects = {effect("there", 0.9, 0.6), effect("hardly", 0.02, 0.3), effect("likely", 0.3, 0.1)};
  d.small_departures = {effect("no", 0.001, 0.0), effect("small", 1.0, 0.0)};
  for (NamedEffect& one : d.effects) one.confusable_with = {"another"};
  d.verdict = Verdict::kExplained;  // the whole is known, whatever of its parts is not
  Diagnosis whole = d;
  set_stand_ins_apart(whole);
  EXPECT_EQ(ids(whole.effects), (std::vector<std::string>{"there", "hardly", "likely"}));
  EXPECT_EQ(ids(whole.stand_ins), std::vector<std::string>{"no"});
  d.verdict = Verdict::kUnknown;
  set_stand_ins_apart(d);
  EXPECT_EQ(ids(d.effects), (std::vector<std::string>{"there", "likely"}));
  EXPECT_EQ(ids(d.small_departures), std::vector<std::string>{"small"});
  EXPECT_EQ(ids(d.stand_ins), (std::vector<std::string>{"hardly", "no"}));
  EXPECT_EQ(d.effects.front().confusable_with, std::vector<std::string>{"another"});
  EXPECT_TRUE(d.stand_ins.front().confusable_with.empty());
}

TEST(Findings, NothingIsExplainedByWhatIsHardlyThere) {
  Diagnosis d;
  d.explained_share = 0.97;
  d.effects = {effect("bow", 0.02, 1.0)};
  EXPECT_EQ(verdict_of(d, true), Verdict::kCannotTell);
  Candidate rival;
  rival.id = "scale";
  rival.probability = 0.9;
  d.ranking = {rival};
  EXPECT_EQ(verdict_of(d, true), Verdict::kCannotTell) << "not what it may be mistaken for";
  d.effects.front().confusable_with = {"scale"};
  EXPECT_EQ(verdict_of(d, true), Verdict::kExplained) << "one of the two is there";
  EXPECT_EQ(verdict_of(d, false), Verdict::kUnknown) << "something else is left, and which is there is open";
  d.effects = {effect("bow", 0.6, 1.0)};
  EXPECT_EQ(verdict_of(d, true), Verdict::kExplained);
  EXPECT_EQ(verdict_of(d, false), Verdict::kPartlyExplained);
}

TEST(Findings, CandidatesStandAsTheyAreSaid) {
  Diagnosis d;
  d.effects = {effect("second", 0.7, 0.6), effect("first", 1.0, 0.4)};
  d.effects.front().confusable_with = {"rival", "first"};
  d.small_departures = {effect("small", 1.0, 0.0)};
  for (const char* id : {"probable", "first", "small", "absent", "rival", "second"}) {
    Candidate c;
    c.id = id;
    d.ranking.push_back(c);
  }
  rank_as_said(d);
  std::vector<std::string> order;
  for (const Candidate& c : d.ranking) order.push_back(c.id);
  EXPECT_EQ(order, (std::vector<std::string>{"second", "first", "rival", "small", "probable", "absent"}));
}

/// A fit with one effect, its first size free, known to 1 of its scale.
Linearised with_size(const std::string& id, double value) {
  Linearised at;
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    if (info.id != id) continue;
    model::Values values = model::Values::Zero(static_cast<Eigen::Index>(info.parameters.size()));
    values[0] = value;
    at.at.effects.push_back({effect.get(), values});
    JointUnknown c;
    c.kind = JointUnknown::Kind::kEffect;
    c.scale = info.parameters[0].usual;
    c.low = info.parameters[0].low;
    c.high = info.parameters[0].high;
    at.columns.push_back(c);
  }
  at.information = Eigen::MatrixXd::Identity(1, 1);
  at.gradient = Eigen::VectorXd::Zero(1);
  return at;
}

TEST(Findings, ASizeAtTheEndOfItsRangeIsNone) {
  const Linearised inside = with_size("curvature_gain", 0.4);
  const JointUnknown& c = inside.columns.at(0);
  EXPECT_FALSE(at_limit(inside, 0));
  EXPECT_TRUE(at_limit(with_size("curvature_gain", c.low), 0));
  EXPECT_TRUE(at_limit(with_size("curvature_gain", c.high), 0));
  EXPECT_FALSE(at_limit(with_size("pressure_dead_zone", 0.0), 0)) << "an end that is absent";
  Linearised unknown = with_size("curvature_gain", c.high);
  unknown.information *= std::pow(c.scale / c.high, 2);
  EXPECT_FALSE(at_limit(unknown, 0)) << "it may be anywhere";
}

}  // namespace
}  // namespace softarm::diagnose
