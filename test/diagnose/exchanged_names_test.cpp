// Bodies that have one another's names.
#include "exchanged_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace softarm::diagnose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

arm::Arm with_rings() {
  arm::Arm arm;
  for (const auto& [name, s_m] : {std::pair{"tip", 0.2}, {"low", 0.05}, {"middle", 0.12}}) {
    arm::MeasuredBody ring;
    ring.name = name;
    ring.arclength_m = s_m;
    arm.bodies.push_back(ring);
  }
  return arm;
}

/// Straight; @param places of tip, low and middle along the arm
model::TrialData trial_with(const std::string& name, const std::vector<double>& places) {
  model::TrialData trial;
  trial.name = name;
  for (int k = 0; k < 10; ++k) {
    model::Block block;
    for (int b = 0; b < static_cast<int>(places.size()); ++b) {
      model::Seen seen;
      seen.body = b;
      seen.p_base = Eigen::Vector3d(0.0, 0.0, places[static_cast<std::size_t>(b)]);
      block.bodies.push_back(seen);
    }
    trial.blocks.push_back(block);
  }
  return trial;
}

TEST(ExchangedNames, AreSaidWithTheTrialsThatHaveThem) {
  const arm::Arm arm = with_rings();
  const model::TrialData right = trial_with("right", {0.2, 0.05, 0.12});
  const model::TrialData wrong = trial_with("wrong", {0.12, 0.05, 0.2});
  EXPECT_FALSE(exchanged_names(arm, {right, right}));
  const auto some = exchanged_names(arm, {right, wrong});
  ASSERT_TRUE(some);
  EXPECT_THAT(some->seen, ElementsAre("low", "tip", "middle"));
  EXPECT_THAT(some->trials, ElementsAre("wrong"));
  EXPECT_THAT(
      sentence_of(*some, 2),
      HasSubstr("the arm file has low, middle and tip, the recording low, tip and middle, in wrong:"));
  const auto all = exchanged_names(arm, {wrong, wrong});
  ASSERT_TRUE(all);
  EXPECT_THAT(sentence_of(*all, 2), HasSubstr("in all trials"));
}

TEST(ExchangedNames, AGhostForAWhileIsNoOrder) {
  const arm::Arm arm = with_rings();
  model::TrialData trial = trial_with("trial", {0.2, 0.05, 0.12});
  const model::TrialData wrong = trial_with("wrong", {0.12, 0.05, 0.2});
  for (std::size_t k = 0; k < 4; ++k) trial.blocks[k] = wrong.blocks[k];
  EXPECT_FALSE(exchanged_names(arm, {trial}));
  for (model::Block& block : trial.blocks) block.bodies.pop_back();  // not all are seen
  EXPECT_FALSE(exchanged_names(arm, {trial}));
}

}  // namespace
}  // namespace softarm::diagnose
