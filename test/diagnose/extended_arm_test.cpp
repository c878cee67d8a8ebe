// What a diagnosis finds, in the model of everything else: a base that yields, hidden behind a lower EI.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "identify/identify_extended.h"
#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

using testing::drawn_case;
using testing::recorded_case;
using testing::RecordedCase;

/// Median over the frames in which EI is identifiable, of EI over the laws' at its inputs with the true base
/// value.
double stiffness_ratio(const arm::Arm& arm, const std::vector<model::Present>& effects,
                       const RecordedCase& recorded) {
  const double truth_nm2 = recorded.truth[0].arm.segments[0].stiffness_base_nm2;
  std::vector<double> ratios;
  for (const trial::Trial& trial : recorded.trials) {
    estimate::Estimator estimator(arm, arm.estimator, effects);
    estimator.set_backbone_points(0);
    for (const trial::Frame& frame : trial.frames) {
      const estimate::Estimate& e = estimator.estimate(frame);
      if (e.status != estimate::Status::kOk || !e.segments[0].identifiable_stiffness) continue;
      const auto laws = predict(recorded.arm, frame.inputs);
      if (!laws) continue;
      const double by_inputs =
          (*laws)[0].bending_stiffness_nm2 - recorded.arm.segments[0].bending_stiffness.base_nm2;
      ratios.push_back(*e.segments[0].bending_stiffness_nm2 / (truth_nm2 + by_inputs));
    }
  }
  if (ratios.size() < 200) throw std::runtime_error("too few frames with identifiable EI");
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  return ratios[ratios.size() / 2];
}

/// The rig's wall lags by far more than is usual, and the laboratory's file says nothing of it.
TEST(ExtendedArm, HasTheLagOfTheWallThoughTheFileHadNone) {
  RecordedCase recorded = drawn_case("{count_weights: [1]}", 4, 3, 10.0);
  for (std::size_t t = 0; t < recorded.truth.size(); ++t) {
    for (auto& segment : recorded.truth[t].arm.segments) segment.retardation_s = 0.08;
    recorded.trials.push_back(testing::record(recorded.arm, recorded.truth[t], "trial_" + std::to_string(t)));
  }
  ASSERT_FALSE(recorded.arm.segments[0].wall.lag_s);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  const arm::Arm& found = d.extended_arm.arm;
  ASSERT_TRUE(found.segments[0].wall.lag_s);
  EXPECT_GT(*found.segments[0].wall.lag_s, 0.03) << report::describe(d);
  const std::string said = "(" + std::to_string(std::lround(1e3 * *found.segments[0].wall.lag_s)) + " ms)";
  EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [&](const std::string& note) {
    return note.find(said) != std::string::npos;
  })) << said;
}

TEST(ExtendedArm, CarriesWhatWasFoundIntoEverythingElse) {
  const RecordedCase recorded =
      recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4, 4, 10.0);
  const diagnose::Diagnosis d = diagnose::diagnose(recorded.arm, recorded.trials);
  ASSERT_EQ(d.extended_arm.effects.size(), 1u) << report::describe(d);
  const arm::EffectEntry& entry = d.extended_arm.effects[0];
  EXPECT_EQ(entry.id, "base_compliance");
  ASSERT_EQ(entry.numbers.size(), 1u);
  EXPECT_EQ(entry.numbers[0].value, d.effects.at(0).parameters.at(0).value);
  ASSERT_TRUE(entry.numbers[0].sd);
  EXPECT_NEAR(2.0 * 1.6449 * *entry.numbers[0].sd,
              d.effects[0].parameters[0].high - d.effects[0].parameters[0].low, 1e-9);
  const double truth_nm2 = recorded.truth[0].arm.segments[0].stiffness_base_nm2;
  EXPECT_NEAR(d.extended_arm.arm.segments[0].bending_stiffness.base_nm2, truth_nm2, 0.01 * truth_nm2);
  const std::vector<model::Present> effects = effects::effects_of(d.extended_arm.arm, d.extended_arm.effects);

  // Single frames: EI was too low, and is right.
  const double before = stiffness_ratio(recorded.arm, {}, recorded);
  const double after = stiffness_ratio(d.extended_arm.arm, effects, recorded);
  RecordProperty("ei_before", std::to_string(before));
  RecordProperty("ei_after", std::to_string(after));
  EXPECT_LT(before, 0.95);
  EXPECT_NEAR(after, 1.0, 0.015);

  // A second diagnosis finds nothing more.
  diagnose::Options options;
  options.known = effects;
  const diagnose::Diagnosis again = diagnose::diagnose(d.extended_arm.arm, recorded.trials, options);
  EXPECT_EQ(again.verdict, diagnose::Verdict::kConsistent) << report::describe(again);
  EXPECT_NEAR(again.baseline.held_out_rms_m, d.extended.held_out_rms_m, 0.1 * d.extended.held_out_rms_m);
  ASSERT_EQ(again.extended_arm.effects.size(), 1u);
  EXPECT_EQ(again.extended_arm.effects[0].numbers[0].value, entry.numbers[0].value);

  // Identification from the arm file that the laboratory had: wrong without the effect, right with it.
  identify::Options all;
  all.held_out_share = 0.0;
  all.frames.prefer_static = false;
  const double plain_nm2 =
      identify::identify(recorded.arm, recorded.trials, all).arm.segments[0].bending_stiffness.base_nm2;
  const double extended_nm2 = identify::identify_extended(recorded.arm, effects, recorded.trials, all)
                                  .arm.segments[0]
                                  .bending_stiffness.base_nm2;
  EXPECT_LT(plain_nm2, 0.97 * truth_nm2);
  EXPECT_NEAR(extended_nm2, truth_nm2, 0.02 * truth_nm2);
}

}  // namespace
}  // namespace softarm::diagnose
