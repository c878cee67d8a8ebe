// What the model ends with.
#include "diagnose/ending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/floor.h"
#include "diagnose/policy.h"
#include "diagnose/ranking.h"
#include "diagnose/refits.h"
#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "looked.h"
#include "recorded_case.h"
#include "started.h"

namespace softarm::diagnose {
namespace {

/// The model with one effect more than the arm's constants, as a selection's rounds leave it.
struct Extended {
  explicit Extended(testing::Looked& looked, const std::string& id) {
    selection.baseline = looked.baseline;
    selection.baseline_unseen = refitted_unseen(looked.model, looked.baseline);
    testing::Started begun(looked);
    Refitted with = refit(looked.model, begun.alone, begun.of(id));
    current = {with.fit, with.unseen};
    begun.round.posterior = posterior_of(looked.model, current, begun.round, 0);
    begun.round.refitted.push_back(std::move(with));
    begun.round.taken = 0;
    selection.rounds.push_back(std::move(begun.round));
    selection.round_of = {0};
  }
  Selection selection;
  Standing current;
};

TEST(Ending, WhatPredictsUnseenTrialsWorseIsTakenOutAgainAndWhatIsThereStays) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  int worse = 0;
  for (const char* id : {"base_compliance", "torsion", "gravity_direction"}) {
    SCOPED_TRACE(id);
    Extended extended(looked, id);
    const double before_m = extended.selection.baseline_unseen.total_rms_m,
                 after_m = refitted_unseen(looked.model, extended.current.fit).total_rms_m;
    const Ending ending = end_with_what_predicts(looked.model, extended.current, extended.selection, {});
    EXPECT_EQ(extended.current.fit.at.effects.size(), after_m < before_m ? 1u : 0u);
    EXPECT_EQ(extended.selection.round_of.size(), extended.current.fit.at.effects.size());
    EXPECT_DOUBLE_EQ(ending.unseen.total_rms_m, std::min(before_m, after_m));
    worse += after_m >= before_m;
    EXPECT_TRUE(id != std::string("base_compliance") || worse == 0);
  }
  EXPECT_GT(worse, 0) << "nothing was tried that predicts worse";
}

/// A round upon the model, as a selection ends with.
Round last_round(testing::Looked& looked, Standing& current) {
  Round last;
  last.screened = screen(looked.model, current.fit, 0, [](double) {});
  last.posterior = posterior_of(looked.model, current, last, 0);
  return last;
}

/// Those of a ranking that are this effect.
std::vector<Candidate> entries_of(const std::vector<Candidate>& ranking, const std::string& id) {
  std::vector<Candidate> list;
  std::copy_if(ranking.begin(), ranking.end(), std::back_inserter(list),
               [&](const Candidate& c) { return c.id == id; });
  return list;
}

TEST(Ending, WhatPredictsWorseIsRankedByALookAtTheModelWithoutIt) {
  const testing::RecordedCase drawn =
      testing::recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  int gone = 0;
  for (const char* id : {"torsion", "gravity_direction"}) {
    SCOPED_TRACE(id);
    Extended extended(looked, id);
    Selection& selection = extended.selection;
    selection.rounds.push_back(last_round(looked, extended.current));
    selection.rounds.back().refitted.resize(1);
    selection.rounds.back().refitted[0].effect = selection.rounds.back().screened.front().effect;
    end_with_what_predicts(looked.model, extended.current, selection, {});
    if (!extended.current.fit.at.effects.empty()) continue;
    ++gone;
    EXPECT_EQ(selection.rounds.size(), 3u);
    EXPECT_EQ(selection.rounds.back().screened.size(), selection.rounds.front().screened.size());
    EXPECT_EQ(selection.rounds.back().refitted.size(), 1u);
    selection.extended = extended.current.fit;
    const std::vector<Candidate> ranked = entries_of(ranking_of(looked.model, selection), id);
    ASSERT_EQ(ranked.size(), 1u);
    EXPECT_NE(ranked[0].finding, Finding::kPresent);
    EXPECT_NE(ranked[0].finding, Finding::kRival);
    EXPECT_LE(ranked[0].probability, kPolicy.posterior.named);
  }
  EXPECT_GT(gone, 0) << "nothing was tried that predicts worse";
}

/// Torsion, beside what is there. By how much predictions fall without either is made up.
struct TorsionToo {
  explicit TorsionToo(testing::Looked& looked) : extended(looked, "torsion") {
    const testing::Started again(looked);
    Round second;
    second.screened = again.round.screened;
    second.screened.erase(std::remove_if(second.screened.begin(), second.screened.end(),
                                         [](const Screened& s) { return s.effect->info().id == "torsion"; }),
                          second.screened.end());
    second.refitted.push_back(refit(looked.model, extended.current, again.of("base_compliance")));
    second.taken = 0;
    extended.current = standing_on(looked.model, second.refitted[0].fit);
    extended.selection.rounds.push_back(std::move(second));
    extended.selection.rounds.push_back(last_round(looked, extended.current));
    extended.selection.round_of = {0, 1};
  }
  /// @param share of what is looked at closer: what the first order expects without base_compliance
  Extended ended(testing::Looked& looked, double share) const {
    Extended copy = extended;
    Unseen& of_both = copy.current.unseen;
    of_both.total_rms_m = 1.0;  // so that nothing predicts worse
    of_both.total_chi2 = 1.0;
    const double expected_m = share * kPolicy.selection.clearly_there * trivial_m(looked.model);
    of_both.total_chi2 = std::pow(moved_without_m(copy.current, 1) / expected_m, 2);
    EXPECT_LT(moved_without_m(copy.current, 0), 0.7 * expected_m);
    end_with_what_predicts(looked.model, copy.current, copy.selection, {});
    copy.selection.extended = copy.current.fit;
    return copy;
  }
  Extended extended;
};

TEST(Ending, WhatIsSuperfluousIsTheRivalOfWhatWouldHaveBeenInItsPlace) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 1], from: [base_compliance], size: [0.8, 1.0]}", 4, 5, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const TorsionToo both(looked);
  const model::Effect* torsion = both.extended.current.fit.at.effects.front().effect;
  for (const bool either : {true, false}) {
    SCOPED_TRACE(either ? "either is superfluous" : "torsion alone is");
    const Extended ended = both.ended(looked, either ? 0.9 : 1.2);
    ASSERT_EQ(ended.current.fit.at.effects.size(), 1u);
    EXPECT_EQ(ended.current.fit.at.effects[0].effect->info().id, "base_compliance");
    EXPECT_EQ(ended.selection.round_of, std::vector<std::size_t>{1});
    EXPECT_EQ(ended.selection.rounds[1].rivals, either ? EffectList{torsion} : EffectList{});
    const std::vector<Candidate> ranked = entries_of(ranking_of(looked.model, ended.selection), "torsion");
    ASSERT_EQ(ranked.size(), 1u);
    EXPECT_EQ(ranked[0].finding == Finding::kRival, either);
    EXPECT_NE(ranked[0].finding, Finding::kPresent);
    EXPECT_LE(ranked[0].probability, kPolicy.posterior.named);
  }
}

TEST(Ending, TheSearchIsLostWithTwoEffectsThatAreNotThere) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 1], from: [base_compliance], size: [0.8, 1.0]}", 4, 5, 10.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  const auto is_lost_with = [&](const std::vector<const char*>& effects) {
    Extended extended(looked, effects.front());
    Selection& selection = extended.selection;
    selection.rounds[0].taken = -1;
    selection.round_of.clear();
    testing::Started again(looked);
    for (const char* id : effects) {
      if (id != effects.front()) {
        const Refitted more = refit(looked.model, extended.current, again.of(id));
        extended.current = standing_on(looked.model, more.fit);
      }
      Round round;
      round.refitted.resize(1);
      round.refitted[0].moved_m = id == std::string("base_compliance") ? 4e-3 : 1e-6;
      round.taken = 0;
      selection.round_of.push_back(selection.rounds.size());
      selection.rounds.push_back(std::move(round));
    }
    again.round.screened.clear();  // nothing else may be there in their place
    again.round.posterior = posterior_of(looked.model, extended.current, again.round, 0);
    extended.current.unseen.total_rms_m = std::hypot(std::sqrt(floor_of(looked.model).white_m2), 2e-3);
    return is_lost(looked.model, extended.current, again.round, selection, {});
  };
  EXPECT_FALSE(is_lost_with({"base_compliance", "gravity_direction"}));
  EXPECT_TRUE(is_lost_with({"torsion", "gravity_direction"}));
  EXPECT_TRUE(is_lost_with({"base_compliance", "torsion", "gravity_direction"}))
      << "what was found before is believed, and nothing since";
}

/// A model with two effects that are as good as nothing, of an arm with 2 mm left beyond the noise.
struct OfTwoStandIns {
  explicit OfTwoStandIns(testing::Looked& l) : looked(l), extended(l, "torsion") {
    const testing::Started again(looked);
    const Refitted both = refit(looked.model, extended.current, again.of("gravity_direction"));
    extended.current = standing_on(looked.model, both.fit);
    extended.current.unseen.total_rms_m = std::hypot(std::sqrt(floor_of(looked.model).white_m2), 2e-3);
    Round taken;
    taken.refitted.resize(1);
    taken.refitted[0].moved_m = 1e-6;
    taken.taken = 0;
    for (int i = 0; i < 2; ++i) extended.selection.rounds.push_back(taken);
    extended.selection.round_of = {1, 2};
  }
  /// What a round says of them that found nothing more.
  /// @param correlation of the one's size with the other's
  Round round(double correlation) const {
    const Linearised& fit = extended.current.fit;
    const auto n = static_cast<Eigen::Index>(fit.columns.size());
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
    Round found;
    found.posterior.unknowns = {Eigen::VectorXd::Zero(n), one};
    Eigen::MatrixXd& covariance = found.posterior.unknowns.covariance;
    const Eigen::Index i = rows_of_sizes(fit, 0).front(), j = rows_of_sizes(fit, 1).front();
    covariance(i, j) = covariance(j, i) = correlation;
    found.posterior.on_its_law.assign(2, Gaussian{-fit.unknowns(), 1e-4 * one});  // at nothing, and surely so
    return found;
  }
  bool is_lost(const Round& round) {
    return diagnose::is_lost(looked.model, extended.current, round, extended.selection, {});
  }
  testing::Looked& looked;
  Extended extended;
};

TEST(Ending, TheSearchIsNotLostWhereWhatIsNextMayBeThere) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  OfTwoStandIns two(looked);
  EXPECT_TRUE(two.is_lost(two.round(0.0)));
  const auto is_lost_with = [&](double probability, double moved_m) {
    Round round = two.round(0.0);
    round.refitted.resize(1);
    round.refitted[0].fit.at = two.extended.current.fit.at;
    round.refitted[0].probability = probability;
    round.refitted[0].moved_m = moved_m;
    round.taken = 0;
    return two.is_lost(round);
  };
  EXPECT_FALSE(is_lost_with(1.0, 1.5e-3));
  EXPECT_TRUE(is_lost_with(1.0, 1e-6)) << "beside so much it stands in, too";
  EXPECT_TRUE(is_lost_with(0.4, 2.5e-3)) << "it is probably not there";
  EXPECT_FALSE(is_lost_with(0.6, 2.5e-3)) << "what it takes itself is not left";
}

TEST(Ending, OfTwoStandInsThatDoTheSameTheSearchCountsOne) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 3, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  OfTwoStandIns two(looked);
  EXPECT_TRUE(two.is_lost(two.round(0.9)));
  EXPECT_FALSE(two.is_lost(two.round(0.99)));
  EXPECT_FALSE(two.is_lost(two.round(-0.99)));
}

TEST(Ending, OfTwoEffectsThatDoTheSameOneStaysWithTheOtherAsItsRival) {
  const testing::RecordedCase drawn = testing::recorded_case(
      "{count_weights: [0, 1], from: [pressure_stiffening], size: [0.8, 1.0]}", 5, 4, 8.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  Extended extended(looked, "pressure_stiffening");
  testing::Started again(looked);
  Refitted both = refit(looked.model, extended.current, again.of("radial_expansion"));
  ASSERT_EQ(both.fit.at.effects.size(), 2u);
  const Standing standing = standing_on(looked.model, both.fit);
  const auto ended = [&](double correlation, double probability) {
    extended.current = standing;
    Selection& selection = extended.selection;
    selection.rounds.resize(1);
    selection.rounds.push_back(Round());
    selection.rounds[0].rivals.clear();
    selection.round_of = {0, 1};
    selection.doubt.still_there = {0.01, probability};
    const auto n = static_cast<Eigen::Index>(standing.fit.columns.size());
    selection.doubt.covariance = Eigen::MatrixXd::Identity(n, n);
    const Eigen::Index i = rows_of_sizes(standing.fit, 0).front(), j = rows_of_sizes(standing.fit, 1).front();
    selection.doubt.covariance(i, j) = selection.doubt.covariance(j, i) = correlation;
    return keep_one_of_two_alike(looked.model, extended.current, selection);
  };
  EXPECT_FALSE(ended(-0.99, 0.9)) << "one of them is certain";
  EXPECT_FALSE(ended(0.5, 0.01)) << "neither can do what the other does";
  EXPECT_EQ(extended.current.fit.at.effects.size(), 2u);
  ASSERT_TRUE(ended(-0.99, 0.01));
  ASSERT_EQ(extended.current.fit.at.effects.size(), 1u);
  ASSERT_EQ(extended.selection.round_of.size(), 1u);
  const bool first_stays = extended.current.fit.at.effects[0].effect == standing.fit.at.effects[0].effect;
  EXPECT_EQ(extended.selection.round_of[0], first_stays ? 0u : 1u);
  EXPECT_EQ(extended.selection.rounds[extended.selection.round_of[0]].rivals,
            (std::vector<const model::Effect*>{standing.fit.at.effects[first_stays ? 1 : 0].effect}));
}

}  // namespace
}  // namespace softarm::diagnose
