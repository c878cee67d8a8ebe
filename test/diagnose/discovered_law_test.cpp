// Where the catalogue ends: a law of what is left, and none where nothing is.
#include "diagnose/discovered_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arm/arm_writer.h"
#include "diagnose/law_design.h"
#include "effects/learned_moment.h"
#include "looked.h"
#include "recorded_case.h"
#include "softarm/arm/arm_file.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"
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

/// A valve of chamber 2 that sticks and whose line leads to chamber 3 as well: what is logged of that one
/// runs ahead of what acts by up to half of a width, in whichever direction chamber 2 goes. Nothing in the
/// catalogue has a memory of another chamber.
trial::Trial recorded_behind_a_valve(const arm::Arm& arm, const rig::Scenario& scenario,
                                     const std::string& name) {
  constexpr double kHalfWidth_pa = 500.0;
  std::optional<double> last_pa;
  double ahead_pa = 0.0;
  return testing::record(arm, scenario, name, [&](rig::InputSample& input) {
    if (input.number == 2) input.value += ahead_pa;
    if (input.number != 1) return true;
    ahead_pa =
        std::clamp(ahead_pa + input.value - last_pa.value_or(input.value), -kHalfWidth_pa, kHalfWidth_pa);
    last_pa = input.value;
    return true;
  });
}

/// Mean distance of all bodies of a trial from where an arm with effects has them, m.
double mean_error_m(const arm::Arm& arm, const trial::Trial& trial, const std::vector<model::Present>& known,
                    const std::optional<JointParameters>& parameters = {}) {
  const model::Prepared prepared = model::prepare(arm, {trial});
  JointModel model(arm, prepared.trials, 1, {}, {}, known);
  std::vector<std::vector<model::Predicted>> predicted;
  model.predict(parameters.value_or(model.start()), nullptr, predicted);
  model.allow_for_motion(parameters.value_or(model.start()), predicted);
  double sum_m = 0.0, count = 0.0;
  for (std::size_t k = 0; k < predicted[0].size(); ++k) {
    if (!model.uses(0, k) || !predicted[0][k].solved) continue;
    const std::vector<model::Seen>& bodies = prepared.trials[0].blocks[k].bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i, count += 1.0)
      sum_m += (bodies[i].p_base - predicted[0][k].p.col(static_cast<Eigen::Index>(i))).norm();
  }
  if (!(count > 100.0)) throw std::runtime_error("hardly anything was compared");
  return sum_m / count;
}

/// What the node would say of a trial.
void expect_runs_live(const arm::Arm& arm, const std::vector<model::Present>& effects,
                      const trial::Trial& trial) {
  estimate::Estimator estimator(arm, arm.estimator, effects);
  std::size_t good = 0;
  for (const trial::Frame& frame : trial.frames) {
    const estimate::Estimate& e = estimator.estimate(frame);
    good += e.status == estimate::Status::kOk && std::isfinite(e.rms_residual_m);
  }
  EXPECT_GT(good, trial.frames.size() * 9 / 10);
}

TEST(DiscoveredLaw, IsLearntWhereTheCatalogueEndsAndPredictsWhatNobodyGaveIt) {
  const RecordedCase drawn = drawn_case("{count_weights: [1]}", 11, 7, 12.0);
  std::vector<trial::Trial> trials;
  for (const rig::Scenario& scenario : drawn.truth)
    trials.push_back(
        recorded_behind_a_valve(drawn.arm, scenario, "trial_" + std::to_string(trials.size() + 1)));
  const trial::Trial unseen = std::move(trials.back());
  trials.pop_back();
  Options options;
  options.most_effects = 1;
  options.refits = 2;
  const Diagnosis d = diagnose::diagnose(drawn.arm, trials, options);
  EXPECT_EQ(d.verdict, Verdict::kUnknown) << report::describe(d);
  ASSERT_TRUE(d.discovered_law) << report::describe(d);
  const DiscoveredLaw& law = *d.discovered_law;
  EXPECT_THAT(law.terms.at(0).goes_with, ::testing::EndsWith("lags behind chamber_2")) << law.sentence;
  EXPECT_EQ(law.terms[0].unit, "Pa");
  EXPECT_LT(law.held_out_mean_after_m, 0.6 * law.held_out_mean_before_m) << law.sentence;
  EXPECT_GT(law.share, 0.6) << law.sentence;
  EXPECT_EQ(law.sequences, 6U);
  EXPECT_THAT(d.summary, ::testing::HasSubstr("A law was learnt from it: it goes with how far a play"));
  EXPECT_THAT(report::describe(d), ::testing::HasSubstr("A law that was learnt from what is left"));

  // Through the file, and on a trial that was not among those.
  const arm::ArmText file = arm::read_arm_text(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml", {});
  const std::string text = arm::update_arm_text(file.text, file.source, d.extended_arm.arm,
                                                d.extended_arm.effects, {law.sentence}, "test", "unknown");
  const arm::Arm extended = arm::parse_arm(text, "extended");
  const std::vector<model::Present> effects =
      effects::effects_of(extended, arm::parse_effect_entries(text, "extended"));
  EXPECT_TRUE(std::any_of(effects.begin(), effects.end(), [](const model::Present& one) {
    return one.effect == &effects::learned_moment();
  }));
  Looked looked(drawn.arm, trials);
  const double before_m = mean_error_m(drawn.arm, unseen, {}, looked.baseline.at);
  const double after_m = mean_error_m(extended, unseen, effects);
  EXPECT_LT(after_m, 0.7 * before_m) << before_m << " m";
  expect_runs_live(extended, effects, unseen);
}

}  // namespace
}  // namespace softarm::diagnose
