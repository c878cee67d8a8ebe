// Which effect of a round goes into the model.
#include "diagnose/rivals.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

class BestOf : public ::testing::Test {
 protected:
  BestOf()
      : drawn_(testing::recorded_case("{count_weights: [1]}", 43, 2, 5.0)),
        looked_(drawn_.arm, drawn_.trials) {
    for (const char* id : {"hysteresis", "payload_offset", "base_tilt"}) add(id, 0.99, 10.0);
  }
  void add(const std::string& id, double probability, double gain) {
    for (const auto& effect : effects::catalogue()) {
      if (effect->info().id != id) continue;
      Refitted r;
      r.effect = effect.get();
      r.probability = probability;
      r.gain = gain;
      r.elsewhere = 1.0;
      r.moved_m = 1e-3;
      r.physical = r.converged = true;
      round_.refitted.push_back(r);
      Screened s;
      s.effect = effect.get();
      round_.screened.push_back(s);
      round_.posterior.sets = {{{}, 0.0}};
      for (const Refitted& one : round_.refitted) round_.posterior.sets[0].effects.push_back(one.effect);
      round_.posterior.sets[0].probability = 1.0;
    }
  }
  int best() { return best_of(looked_.model, round_); }

  testing::RecordedCase drawn_;
  testing::Looked looked_;
  Round round_;
};

TEST_F(BestOf, AllThatAreAsGoodAsCertainExplainsMost) {
  round_.refitted[0].gain = 40.0;
  round_.refitted[1].probability = 1.0;
  EXPECT_EQ(best(), 0);
  // A fit that did not come to an end, too.
  round_.refitted[0].converged = false;
  EXPECT_EQ(best(), 0);
}

TEST_F(BestOf, WhatIsHardlyThereBringsNothingYet) {
  round_.refitted[0].gain = 100.0;
  round_.refitted[0].probability = 0.35;
  round_.refitted[1].gain = 12.0;
  EXPECT_EQ(best(), 1);
  for (Refitted& r : round_.refitted) r.probability *= 0.3;
  round_.refitted[2].probability = 0.4;
  EXPECT_EQ(best(), 2) << "the most probable of a class";
}

TEST_F(BestOf, NothingThatCannotBe) {
  for (Refitted& r : round_.refitted) r.physical = false;
  EXPECT_EQ(best(), -1);
  round_.refitted[2].physical = true;
  EXPECT_EQ(best(), 2);
  round_.refitted[2].elsewhere = 0.4;  // in this one trial only
  EXPECT_EQ(best(), -1);
}

TEST_F(BestOf, WhereMuchIsLeftWhatExplainsNearlyAsMuchMayBeThereInstead) {
  const double moved_m[] = {1.0e-3, 0.95e-3, 0.8e-3};
  for (std::size_t i = 0; i < 3; ++i) round_.refitted[i].moved_m = moved_m[i];
  round_.taken = 0;
  Refitted& first = round_.refitted[0];
  first.fit.rows = 1000;
  const auto found_at = [&](double rms_m, double chi2) {
    first.unseen.total_rms_m = rms_m;
    first.unseen.total_chi2 = chi2;
    std::vector<std::string> list;
    for (const model::Effect* effect : nearly_as_good(round_)) list.push_back(effect->info().id);
    return list;
  };
  // They leave more than the first by 0.31 and 0.6 mm; nothing is left, then 0.7 mm beyond the noise, then 2.
  EXPECT_EQ(found_at(0.2e-3, 1000.0), std::vector<std::string>{});
  round_.refitted[1].moved_m = 1.1e-3;  // is worse for another reason
  EXPECT_EQ(found_at(0.2e-3, 1000.0), std::vector<std::string>{});
  round_.refitted[1].moved_m = moved_m[1];
  EXPECT_EQ(found_at(0.7e-3, 1e6), std::vector<std::string>{round_.refitted[1].effect->info().id});
  EXPECT_EQ(found_at(2e-3, 1e6).size(), 2u);
  round_.refitted[2].moved_m = 0.6e-3;  // explains too little to be it
  EXPECT_EQ(found_at(2e-3, 1e6).size(), 1u);
  round_.rivals = {round_.refitted[1].effect};  // is told already
  EXPECT_EQ(found_at(2e-3, 1e6).size(), 0u);
}

/// A wall at the end of its range, which the posterior is made to believe in, beside a base that yields and
/// is there.
TEST(TakeBest, LeavesWhatPredictsUnseenTrialsNoBetterForTheNextBest) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.6, 1.0]}", 6, 3, 6.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  Standing current{looked.baseline, unseen(looked.model, looked.baseline)};
  const double before_m = current.unseen.total_rms_m;
  Round round;
  round.screened = screen(looked.model, looked.baseline, 0, [](double) {});
  EffectList both;
  for (const Screened& s : round.screened) {
    const std::string& id = s.effect->info().id;
    if (id != "contact" && id != "base_compliance") continue;
    Refitted r = refit(looked.model, current, s);
    if (id == "contact") {
      JointParameters wrong = looked.baseline.at;
      wrong.effects.push_back({s.effect, s.values});
      wrong.effects.back().values[3] = s.effect->info().parameters[3].high;  // out of reach: explains nothing
      r.fit = looked.model.linearise(wrong, &looked.baseline.predicted);
    }
    r.probability = r.elsewhere = 1.0;
    r.gain = id == "contact" ? 100.0 : 50.0;
    r.moved_m = 1e-3;
    r.physical = true;
    both.push_back(s.effect);
    round.refitted.push_back(std::move(r));
  }
  ASSERT_EQ(both.size(), 2U);
  round.posterior.sets = {{both, 1.0}};
  round.taken = best_of(looked.model, round);
  const auto taken = [&] { return round.refitted[static_cast<std::size_t>(round.taken)].effect->info().id; };
  ASSERT_EQ(taken(), "contact");
  ASSERT_TRUE(take_best(looked.model, round, current));
  EXPECT_EQ(taken(), "base_compliance");
  EXPECT_LT(current.unseen.total_rms_m, 0.9 * before_m);
}

}  // namespace
}  // namespace softarm::diagnose
