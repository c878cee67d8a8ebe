// Where a mismatch hides: what single instants, conditions and one arm make of the same trials.
#include "ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnose/looked.h"
#include "diagnose/recorded_case.h"
#include "wander.h"

namespace softarm::diagnose {
namespace {

using ::testing::HasSubstr;
using testing::Looked;
using testing::recorded_case;

constexpr double kTelling = 0.01;

struct Climbed {
  std::vector<InstantFit> instants;
  std::vector<Rung> ladder;
  std::vector<Wander> wander;
  double noise_m = 0.0;
};

Climbed climb(const testing::RecordedCase& recorded) {
  Looked looked(recorded.arm, recorded.trials);
  Climbed out;
  out.instants = fit_instants(looked.model, looked.baseline, 0);
  out.ladder = pooling_ladder(looked.model, looked.baseline, out.instants);
  out.wander = wander_of(looked.model, looked.baseline, out.instants);
  double variance = 0.0, bodies = 0.0;
  for (const effects::TrialData& trial : looked.prepared.trials) {
    for (const effects::Block& block : trial.blocks) {
      for (const effects::Seen& seen : block.bodies) {
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
  for (const Rung& rung : c.ladder) {
    EXPECT_LT(rung.chi2_per_dof, 1.2) << rung.id;
    EXPECT_GT(rung.chi2_per_dof, 0.6) << rung.id;  // what is not known of the motion counts as noise
  }
  EXPECT_NEAR(c.ladder[0].rms_m, c.noise_m, 0.15 * c.noise_m);
  EXPECT_GT(c.ladder[0].unknowns, c.ladder[1].unknowns);
  EXPECT_GT(c.ladder[1].unknowns, c.ladder[2].unknowns);
  for (const Wander& wander : c.wander)
    EXPECT_GE(wander.p, kTelling) << wander.parameter << " against " << wander.against;
  EXPECT_THAT(where_it_hides(c.ladder, c.noise_m, c.wander), HasSubstr("nothing hides"));
}

TEST(Ladder, ABaseThatYieldsHidesInTheWanderOfTheStiffness) {
  const Climbed c = climb(
      recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 6, 16.0,
                    "attitudes: [hanging, horizontal, standing], speeds: [0.5, 1], payload_kg: [0.1, 0.15]"));
  ASSERT_EQ(c.ladder.size(), 3u);
  EXPECT_GT(c.ladder[2].chi2_per_dof, 3.0);
  EXPECT_LT(c.ladder[0].chi2_per_dof - 1.0, 0.6 * (c.ladder[2].chi2_per_dof - 1.0));
  EXPECT_LE(c.ladder[1].rms_m, 1.01 * c.ladder[2].rms_m);
  EXPECT_TRUE(std::any_of(c.wander.begin(), c.wander.end(), [](const Wander& wander) {
    return wander.parameter.rfind("EI", 0) == 0 && wander.p < kTelling && !wander.sentence.empty();
  }));
  EXPECT_THAT(where_it_hides(c.ladder, c.noise_m, c.wander), HasSubstr("the wander of their parameters"));
}

TEST(Ladder, InstantsAreComparedWithTheLawsOfTheirOwnSegment) {
  const Climbed c = climb(recorded_case("{count_weights: [1]}", 3, 2, 8.0));
  double stiffness = 0.0, length = 0.0, count = 0.0;
  for (const InstantFit& fit : c.instants) {
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
