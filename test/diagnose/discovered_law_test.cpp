// Where the catalogue ends: a law of what is left, and none where nothing is.
#include "diagnose/discovered_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "diagnose/law_design.h"
#include "effects/learned_moment.h"
#include "looked.h"
#include "recorded_case.h"
#include "rig/hidden.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using effects::LearnedMoment;
using testing::drawn_case;
using testing::Looked;
using testing::RecordedCase;

/// What moments do to the bodies by the sums of the law against what the model itself makes of the effect.
TEST(LawDesign, SignaturesAreThoseOfTheEffect) {
  const RecordedCase recorded = testing::recorded_case("{count_weights: [1]}", 3, 2, 8.0);
  Looked looked(recorded.arm, recorded.trials);
  const LawDesign design = law_design(looked.model, looked.baseline, 1);
  const double usual_nm = effects::learned_moment().info().parameters[LearnedMoment::kX].usual;
  int compared = 0;
  for (std::size_t j = 0; j < design.terms.size(); j += 7) {
    for (const int size : {LearnedMoment::kX, LearnedMoment::kY}) {
      JointParameters changed = looked.baseline.at;
      model::Values values = design.terms[j];
      values[size] = 0.05 * usual_nm;
      changed.effects.push_back({&effects::learned_moment(), values});
      const Eigen::VectorXd exact = looked.baseline.root_weight[0].asDiagonal() *
                                    looked.model.signatures(looked.baseline, 0, {changed}, {0.05}).col(0);
      const Eigen::VectorXd own =
          design.columns[0].col(design.sums.first(static_cast<Eigen::Index>(j)) + size);
      // The rest is how the arm swings.
      EXPECT_LT((own - exact).norm(), 0.25 * exact.norm()) << j << " " << size;
      compared += exact.norm() > 0.0;
    }
  }
  EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace softarm::diagnose
