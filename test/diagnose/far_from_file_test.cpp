// Trials that may not be of what the arm file names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

/// A chamber that is not connected leaves no residual: its gain, which is fitted, takes it up.
TEST(FarFromFile, AChamberThatDoesNextToNothingIsSaid) {
  testing::RecordedCase recorded = testing::drawn_case("{count_weights: [1]}", 3, 3, 8.0);
  const auto summary = [&] {
    recorded.trials.clear();
    for (std::size_t t = 0; t < recorded.truth.size(); ++t)
      recorded.trials.push_back(
          testing::record(recorded.arm, recorded.truth[t], "trial_" + std::to_string(t + 1)));
    Options options;
    options.most_effects = 0;
    return diagnose(recorded.arm, recorded.trials, options).summary;
  };
  EXPECT_THAT(summary(), Not(HasSubstr("far from the arm file")));

  for (rig::Scenario& scenario : recorded.truth)
    scenario.arm.segments[0].chambers[1].moment_gain_nm_per_pa *= 0.05;
  const std::string said = summary();
  EXPECT_THAT(said, HasSubstr("Constants that fit these trials are far from the arm file's: "));
  EXPECT_THAT(said, ContainsRegex("chamber_2.moment_gain is [4-6]([.][0-9])? % of the file's value"));
}

}  // namespace
}  // namespace softarm::diagnose
