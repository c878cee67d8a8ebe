// How the catalogue is listed.
#include "diagnose/ranking.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "diagnose/policy.h"
#include "effects/catalogue.h"
#include "softarm/arm/arm_file.h"

namespace softarm::diagnose {
namespace {

/// A round that looked at some effects and took the first.
Round round_that_took(const std::vector<const model::Effect*>& screened, double probability) {
  Round round;
  for (const model::Effect* effect : screened) {
    Screened s;
    s.effect = effect;
    s.values = model::Values::Zero(static_cast<Eigen::Index>(effect->info().parameters.size()));
    s.sd = Eigen::VectorXd::Ones(effect->info().sizes);
    round.screened.push_back(s);
  }
  round.refitted.resize(1);
  round.refitted[0].effect = screened.front();
  round.refitted[0].z = 7.0;
  round.refitted[0].moved_m = 1.0;
  round.refitted[0].probability = probability;
  round.posterior.sets = {{{screened.front()}, probability}, {{}, 1.0 - probability}};
  round.taken = 0;
  return round;
}

TEST(Ranking, HasWhatWasTakenOutAgainForAnotherAndNoneSurerThanWhatIsNamed) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/cable_235mm.yaml");
  const std::vector<model::TrialData> none;
  const JointModel model(arm, none, 1);
  const model::Effect *gone = effects::find("gravity_direction"), *stays = effects::find("base_tilt"),
                      *left = effects::find("torsion");
  Selection selection;
  // Where the one that stays was taken the other one was in the model, and not looked at.
  selection.rounds.push_back(round_that_took({gone, stays, left}, 0.9));
  selection.rounds.push_back(round_that_took({stays, left}, 0.8));
  selection.rounds.push_back(round_that_took({left}, 0.95));
  selection.rounds[1].rivals = {gone};
  selection.rounds[2].taken = -1;
  selection.round_of = {1};
  selection.extended.at.effects.push_back({stays, selection.rounds[1].screened[0].values});
  const std::vector<Candidate> list = ranking_of(model, selection);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].id, "base_tilt");
  EXPECT_DOUBLE_EQ(list[0].probability, 0.8);
  EXPECT_EQ(list[1].id, "gravity_direction");
  EXPECT_EQ(list[1].finding, Finding::kRival);
  EXPECT_DOUBLE_EQ(list[1].z, 7.0);
  EXPECT_DOUBLE_EQ(list[1].probability, kPolicy.posterior.named);
  EXPECT_EQ(list[2].id, "torsion");
  EXPECT_DOUBLE_EQ(list[2].probability, kPolicy.posterior.named);
}

/// Both upon one look, in which both were as good as certain.
TEST(Ranking, HasWhatWasTakenBesideAnotherAndOutAgainNoSurerThanWhatIsNamed) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/cable_235mm.yaml");
  const std::vector<model::TrialData> none;
  const JointModel model(arm, none, 1);
  const model::Effect *gone = effects::find("gravity_direction"), *stays = effects::find("base_tilt"),
                      *left = effects::find("torsion");
  Selection selection;
  selection.rounds.push_back(round_that_took({gone, stays, left}, 0.99));
  selection.rounds.push_back(round_that_took({stays, gone, left}, 0.99));
  selection.rounds[1].posterior.sets = {{{gone, stays}, 0.99}, {{}, 0.01}};
  selection.rounds[1].rivals = {gone, left};
  selection.round_of = {1};
  selection.extended.at.effects.push_back({stays, selection.rounds[1].screened[0].values});
  const std::vector<Candidate> list = ranking_of(model, selection);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[1].id, "gravity_direction");
  EXPECT_EQ(list[1].finding, Finding::kRival);
  EXPECT_DOUBLE_EQ(list[1].probability, kPolicy.posterior.named);
}

}  // namespace
}  // namespace softarm::diagnose
