// Where a mismatch hides: what single instants, conditions and one arm make of the same trials.
#include "diagnose/ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnose/parameter_variation.h"
#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

using ::testing::HasSubstr;
using testing::Looked;
using testing::recorded_case;

constexpr double kSignificant = 0.01;

struct Climbed {
  std::vector<diagnose::InstantFit> instants;
  std::vector<diagnose::Rung> ladder;
  std::vector<diagnose::ParameterVariation> parameter_variation;
  double noise_m = 0.0;
};

Climbed climb(const testing::RecordedCase& recorded) {
  model::Preparation how;
  how.block_s = 0.1;  // in longer means noise falls below what is not known of the motion
  Looked looked(recorded.arm, recorded.trials, how);
  Climbed out;
  out.instants = diagnose::fit_instants(looked.model, looked.baseline, 0);
  out.ladder = diagnose::pooling_ladder(looked.model, looked.baseline, out.instants);
  out.parameter_variation = diagnose::parameter_variation_of(looked.model, looked.baseline, out.instants);
  double variance = 0.0, bodies = 0.0;
  for (const model::TrialData& trial : looked.prepared.trials) {
    for (const model::Block& block : trial.blocks) {
      for (const model::Seen& seen : block.bodies) {
        variance += 3.0 * seen.white_sd_m * seen.white_sd_m;
        bodies += 1.0;
      }
    }
  }
  out.noise_m = std::sqrt(variance / bodies);
  return out;
}

TEST(Ladder, OfAnArmThatHidesNothingEveryRungIsAtTheNoise) {
  const Climbed c = climb(recorded_case("{count_weights: [1]}", 3));
  ASSERT_EQ(c.ladder.size(), 3u);
  for (const diagnose::Rung& rung : c.ladder) {
    EXPECT_LT(rung.chi2_per_dof, 1.2) << rung.id;
    EXPECT_GT(rung.chi2_per_dof, 0.6) << rung.id;  // what is not known of the motion counts as noise
  }
  EXPECT_NEAR(c.ladder[0].rms_m, c.noise_m, 0.15 * c.noise_m);
  EXPECT_GT(c.ladder[0].unknowns, c.ladder[1].unknowns);
  EXPECT_GT(c.ladder[1].unknowns, c.ladder[2].unknowns);
  for (const diagnose::ParameterVariation& variation : c.parameter_variation)
    EXPECT_GE(variation.p, kSignificant) << variation.parameter << " against " << variation.against;
  EXPECT_THAT(diagnose::where_it_hides(c.ladder, c.noise_m, c.parameter_variation),
              HasSubstr("nothing hides"));
}

TEST(Ladder, ABaseThatYieldsHidesInTheVariationOfTheStiffness) {
  const Climbed c = climb(
      recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 6, 16.0,
                    "attitudes: [hanging, horizontal, standing], speeds: [0.5, 1], payload_kg: [0.1, 0.15]"));
  ASSERT_EQ(c.ladder.size(), 3u);
  EXPECT_GT(c.ladder[2].chi2_per_dof, 3.0);
  EXPECT_LT(c.ladder[0].chi2_per_dof - 1.0, 0.6 * (c.ladder[2].chi2_per_dof - 1.0));
  EXPECT_LE(c.ladder[1].rms_m, 1.01 * c.ladder[2].rms_m);
  EXPECT_TRUE(std::any_of(c.parameter_variation.begin(), c.parameter_variation.end(),
                          [](const diagnose::ParameterVariation& variation) {
                            return variation.parameter.rfind("EI", 0) == 0 && variation.p < kSignificant &&
                                   !variation.sentence.empty();
                          }));
  EXPECT_THAT(diagnose::where_it_hides(c.ladder, c.noise_m, c.parameter_variation),
              HasSubstr("the variation of the parameters"));
}

TEST(Ladder, InstantsAreComparedWithTheLawsOfTheirOwnSegment) {
  const Climbed c = climb(recorded_case("{count_weights: [1]}", 3, 2, 8.0));
  double stiffness = 0.0, length = 0.0, count = 0.0;
  for (const diagnose::InstantFit& fit : c.instants) {
    ASSERT_EQ(fit.segments.size(), 1u);
    if (!fit.segments[0].stiffness_nm2 || !fit.segments[0].length_m) continue;
    stiffness += fit.segments[0].stiffness_nm2->value / fit.segments[0].stiffness_nm2->law;
    length += fit.segments[0].length_m->value - fit.segments[0].length_m->law;
    count += 1.0;
  }
  ASSERT_GT(count, 20.0);
  EXPECT_NEAR(stiffness / count, 1.0, 0.03);
  EXPECT_NEAR(length / count, 0.0, 2e-4);
}

}  // namespace
}  // namespace softarm::diagnose
