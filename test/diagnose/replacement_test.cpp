// What may be there in place of an effect of the model, once all else is known.
#include "diagnose/replacement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/rivals.h"
#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

/// A model that took one effect and then another, of which both were screened without either.
struct TakenInTurn {
  TakenInTurn(testing::Looked& looked, const std::vector<std::string>& ids) {
    Standing standing{looked.baseline, unseen(looked.model, looked.baseline)};
    for (const std::string& id : ids) {
      Round round;
      round.screened = screen(looked.model, standing.fit, 0, [](double) {});
      const auto s = std::find_if(round.screened.begin(), round.screened.end(),
                                  [&](const Screened& one) { return one.effect->info().id == id; });
      round.refitted.push_back(refit(looked.model, standing, *s));
      round.taken = 0;
      standing = standing_on(looked.model, round.refitted.front().fit);
      selection.round_of.push_back(selection.rounds.size());
      selection.rounds.push_back(std::move(round));
    }
    Round last;
    last.screened = screen(looked.model, standing.fit, 0, [](double) {});
    selection.rounds.push_back(std::move(last));
    current = std::move(standing);
  }
  std::vector<std::string> ids() const {
    std::vector<std::string> list;
    for (const model::Present& present : current.fit.at.effects) list.push_back(present.effect->info().id);
    return list;
  }
  Standing current;
  Selection selection;
};

TEST(Replacement, AWeightTakesThePlaceOfAHoseThatOnlyWeighs) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 0, 1], from: [tip_mass, base_tilt], size: [0.6, 1.0]}", 5, 4, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  TakenInTurn taken(looked, {"tether", "base_tilt"});
  ASSERT_EQ(taken.ids(), (std::vector<std::string>{"tether", "base_tilt"}));
  const double square = taken.current.fit.square;
  std::vector<double> left;
  ASSERT_TRUE(put_likelier_in_place(looked.model, taken.current, taken.selection, {},
                                    [&](double comparisons, const std::string& what) {
                                      left.push_back(comparisons);
                                      EXPECT_NE(what.find("tether"), std::string::npos);
                                    }));
  EXPECT_EQ(left, std::vector<double>{1.0});
  EXPECT_EQ(taken.ids(), (std::vector<std::string>{"tip_mass", "base_tilt"})) << "in the same place";
  EXPECT_LT(taken.current.fit.square, 1.1 * square);
  const Round& round = taken.selection.rounds[0];
  ASSERT_EQ(round.refitted.at(static_cast<std::size_t>(round.taken)).effect->info().id, "tip_mass");
  EXPECT_GT(round.refitted.at(static_cast<std::size_t>(round.taken)).probability, 0.5);
  const Refitted* hose = refit_of(round, effects::find("tether"));
  ASSERT_NE(hose, nullptr);
  EXPECT_EQ(hose->fit.at.effects.back().effect, hose->effect) << "where it would be, upon all else";
  EXPECT_TRUE(hose->fit.predicted.empty()) << "fits are large";
}

/// A round that compared a hose with a weight: how probable each is alone, and both at once.
Round hose_and_weight(double hose, double weight, double both) {
  const model::Effect *one = effects::find("tether"), *other = effects::find("tip_mass");
  Round round;
  round.posterior.sets = {
      {{one}, hose}, {{other}, weight}, {{one, other}, both}, {{}, 1.0 - hose - weight - both}};
  for (const model::Effect* effect : {one, other}) {
    Refitted r;
    r.effect = effect;
    r.probability = round.posterior.of(effect);
    round.refitted.push_back(std::move(r));
  }
  return round;
}

/// The model's own is compared as it is.
TEST(Replacement, AnEffectOfAFitIsItsLastWithoutBeingFittedAgain) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 0, 1], from: [tip_mass, base_tilt], size: [0.6, 1.0]}", 5, 4, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const TakenInTurn taken(looked, {"tip_mass", "base_tilt"});
  const Linearised& fit = taken.current.fit;
  const Refitted last = refitted_last(looked.model, fit, 0);
  EXPECT_EQ(last.effect->info().id, "tip_mass");
  ASSERT_EQ(last.fit.at.effects.size(), 2U);
  EXPECT_EQ(last.fit.at.effects[0].effect, fit.at.effects[1].effect);
  EXPECT_EQ(last.fit.at.effects[1].effect, fit.at.effects[0].effect);
  EXPECT_LT(last.fit.square, 1.001 * fit.square);
  for (int e = 0; e < 2; ++e) {
    const model::Present& before = fit.at.effects[static_cast<std::size_t>(e)];
    const model::Present& now = last.fit.at.effects[static_cast<std::size_t>(1 - e)];
    EXPECT_TRUE(now.values.isApprox(before.values, 0.05)) << now.values << " for " << before.values;
  }
  EXPECT_TRUE(last.converged);
}

TEST(Replacement, OneIsLikelierThatIsThereWithoutTheOther) {
  const model::Effect* hose = effects::find("tether");
  const Round weight = hose_and_weight(0.1, 0.8, 0.05);
  EXPECT_EQ(likelier_than(hose, weight), &weight.refitted[1]);
  EXPECT_EQ(likelier_than(effects::find("tip_mass"), weight), nullptr);
  EXPECT_EQ(likelier_than(hose, hose_and_weight(0.5, 0.4, 0.0)), nullptr);
  EXPECT_EQ(likelier_than(hose, hose_and_weight(0.002, 0.008, 0.99)), nullptr) << "both are there";
  Round other = weight;
  other.refitted[1].physical = false;
  EXPECT_EQ(likelier_than(hose, other), nullptr) << "no arm has so much of it";
  other = weight;
  other.refitted[1].fit.given_up = true;
  EXPECT_EQ(likelier_than(hose, other), nullptr) << "it explains far less";
  other = weight;
  other.refitted[1].probability = 0.05;
  EXPECT_EQ(likelier_than(hose, other), nullptr) << "it does not predict unseen trials";
}

TEST(Replacement, AHoseThatPullsStays) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 0, 1], from: [tether, base_tilt], size: [0.6, 1.0]}", 5, 4, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  TakenInTurn taken(looked, {"tether", "base_tilt"});
  EXPECT_FALSE(put_likelier_in_place(looked.model, taken.current, taken.selection, {}));
  EXPECT_EQ(taken.ids(), (std::vector<std::string>{"tether", "base_tilt"}));
}

TEST(Replacement, WhatCameLastWasComparedUponAllOthers) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [tip_mass], size: [0.6, 1.0]}", 5, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  TakenInTurn taken(looked, {"tether"});
  EXPECT_FALSE(put_likelier_in_place(looked.model, taken.current, taken.selection, {}));
  EXPECT_EQ(taken.ids(), std::vector<std::string>{"tether"});
}

}  // namespace
}  // namespace softarm::diagnose
