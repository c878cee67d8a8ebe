// Identification with effects in the model: what they do changes with the constants.
#include "identify/identify_extended.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "effects/drive_trials.h"
#include "identify/effect_lines.h"
#include "recorded_case.h"
#include "softarm/effects/arm_effects.h"
#include "trial/static_frame.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using testing::recorded_case;
using testing::RecordedCase;

const RecordedCase& a_base_that_yields() {
  static const RecordedCase recorded =
      recorded_case("{count_weights: [0, 1], from: [base_compliance], size: [0.5, 0.5]}", 4, 2, 8.0);
  return recorded;
}

std::vector<identify::FreeConstant> free_constants(const arm::Arm& arm) {
  std::vector<identify::FreeConstant> list;
  for (const identify::ConstantRef& ref : identify::default_free(arm)) {
    identify::FreeConstant constant{ref, identify::value_of(arm, ref), 1.0,
                                    identify::allowed_range(arm, ref)};
    constant.scale = std::max(std::abs(constant.initial), 1e-9);
    list.push_back(constant);
  }
  return list;
}

std::vector<trial::StaticFrame> frames_of(const arm::Arm& arm, const trial::Trial& trial) {
  std::map<std::string, std::uint64_t> left_out;
  return trial::known_frames(arm, 0, trial, left_out);
}

arm::EffectEntry entry_of(const std::string& id) {
  if (id == "creep") return {id, {{"share", 0.2}, {"time_s", 2.0}}};
  if (id == "actuation_taper") return {id, {{"share", 0.2}}};
  return {id, {{"compliance_rad_per_nm", 0.3}}};
}

class EffectLinesOf : public ::testing::TestWithParam<std::string> {};

TEST_P(EffectLinesOf, SlopesAreDifferencesOfWholePredictions) {
  const RecordedCase& recorded = a_base_that_yields();
  const std::vector<model::Present> effects = effects::effects_of(recorded.arm, {entry_of(GetParam())});
  const std::vector<trial::Trial> trials{recorded.trials[0]};
  identify::EffectLines here(recorded.arm, effects, trials, 1);
  const std::vector<trial::StaticFrame> frames = frames_of(recorded.arm, here.without_effects()[0]);
  ASSERT_GT(frames.size(), 300u);
  const std::vector<identify::FreeConstant> constants = free_constants(recorded.arm);
  const identify::Line line = here.line(constants, frames);
  ASSERT_EQ(line.frames.size(), frames.size());
  double largest_m = 0.0, largest_turn = 0.0;
  for (std::size_t j = 0; j < constants.size(); ++j) {
    SCOPED_TRACE(identify::name_of(recorded.arm, constants[j].ref));
    const double step = 0.02 * constants[j].scale;
    arm::Arm there = recorded.arm;
    identify::set_value(there, constants[j].ref, constants[j].initial + step);
    const identify::EffectLines moved(there, effects, trials, 1);
    const std::vector<trial::StaticFrame> after = frames_of(recorded.arm, moved.without_effects()[0]);
    ASSERT_EQ(after.size(), frames.size());
    double off = 0.0, square = 0.0, turn_off = 0.0, turn_square = 0.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (std::size_t k = 0; k < frames[i].bodies.size(); ++k) {
        // What is left when the effects are taken out goes the other way.
        const Eigen::Vector3d whole = frames[i].bodies[k].p_base - after[i].bodies[k].p_base;
        const auto row = 3 * static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(j);
        off += (step * line.frames[i].p.block<3, 1>(row, column) - whole).squaredNorm();
        square += whole.squaredNorm();
        largest_m = std::max(largest_m, whole.norm());
        if (!frames[i].bodies[k].tangent_base) continue;
        const Eigen::Vector3d turned = *frames[i].bodies[k].tangent_base - *after[i].bodies[k].tangent_base;
        turn_off += (step * line.frames[i].tangent.block<3, 1>(row, column) - turned).squaredNorm();
        turn_square += turned.squaredNorm();
        largest_turn = std::max(largest_turn, turned.norm());
      }
    }
    EXPECT_LT(std::sqrt(off),
              0.05 * std::sqrt(square) + 1e-6 * std::sqrt(static_cast<double>(frames.size())));
    EXPECT_LT(std::sqrt(turn_off),
              0.1 * std::sqrt(turn_square) + 1e-5 * std::sqrt(static_cast<double>(frames.size())));
  }
  EXPECT_GT(largest_turn, 5e-4) << "no tangent was tested";
  EXPECT_GT(largest_m, 5e-5) << "nothing was tested";
}

INSTANTIATE_TEST_SUITE_P(Some, EffectLinesOf,
                         ::testing::Values("base_compliance", "creep", "actuation_taper"),
                         [](const ::testing::TestParamInfo<std::string>& one) { return one.param; });

TEST(IdentifyExtended, EndsAtTheSameConstantsWhereverItBegins) {
  const RecordedCase& recorded = a_base_that_yields();
  const std::vector<model::Present> effects =
      effects::effects_of(recorded.arm, {entry_of("base_compliance")});
  identify::Options all;
  all.held_out_share = 0.0;
  all.frames.prefer_static = false;
  const identify::Result right = identify::identify_extended(recorded.arm, effects, recorded.trials, all);
  arm::Arm off = recorded.arm;
  off.segments[0].bending_stiffness.base_nm2 *= 1.3;
  const identify::Result again = identify::identify_extended(off, effects, recorded.trials, all);
  ASSERT_EQ(again.constants.size(), right.constants.size());
  for (std::size_t k = 0; k < right.constants.size(); ++k) {
    const identify::Constant &a = right.constants[k], &b = again.constants[k];
    EXPECT_NEAR(a.value, b.value, 0.2 * a.sd) << a.name;
    EXPECT_NEAR(b.sd, a.sd, 0.1 * a.sd) << a.name;
    EXPECT_EQ(b.initial, identify::value_of(off, b.ref)) << a.name;
  }
  EXPECT_GT(again.fitted_before.mean_m, 1.5 * again.fitted.mean_m);
}

/// What cameras would see of the arm with these effects, each body within 0.2 mm.
trial::Trial trial_of(const arm::Arm& arm, const std::vector<model::Present>& effects,
                      const std::string& name, std::uint64_t seed) {
  constexpr double kNoise_m = 2e-4, kDuration_s = 12.0, kRate_hz = 20.0;
  const auto inputs = [&](double t_s) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    for (Eigen::Index i = 0; i < 3; ++i)
      u[i] = 12e3 * (1.0 - std::cos(0.5 * t_s + static_cast<double>(seed) + 2.1 * static_cast<double>(i)));
    return u;
  };
  const model::TrialData data =
      effects::testing::made_up(arm, kDuration_s, inputs, 0.05, kRate_hz, 1.0 / kRate_hz);
  model::ExtendedModel model(arm);
  const auto path = effects::testing::predict(model, arm, effects, data);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  trial::Trial trial;
  trial.name = name;
  for (std::size_t k = 0; k < path.size(); ++k) {
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(100.0 + data.series.t_s[static_cast<Eigen::Index>(k)]);
    frame.base_body = arm.base.rod_in_body.inverse();
    frame.payload_kg = 0.05;
    const Eigen::VectorXd u = data.series.inputs.col(static_cast<Eigen::Index>(k));
    frame.inputs.assign(u.data(), u.data() + u.size());
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      const Eigen::Vector3d off(noise(random), noise(random), noise(random));
      frame.bodies.push_back(
          {static_cast<int>(b), path[k].p.col(static_cast<Eigen::Index>(b)) + off, std::nullopt});
    }
    trial.frames.push_back(std::move(frame));
  }
  return trial;
}

TEST(IdentifyExtended, HowTrialsFoundWhatEffectsRememberIsFitted) {
  arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  arm.gravity_m_s2 = {0.0, 0.0, 9.80665};  // as the trials have it: the base is mocap's frame
  std::vector<model::Present> effects =
      effects::effects_of(arm, {{"creep", {{"share", 0.4}, {"time_s", 3.0}}}});
  const double found[3][2] = {{1.2, -0.5}, {-0.8, 1.0}, {0.3, 1.5}};  // in standard deviations
  std::vector<trial::Trial> trials;
  for (std::uint64_t t = 0; t < 3; ++t) {
    effects[0].start = Eigen::Vector2d(found[t][0], found[t][1]);
    trials.push_back(trial_of(arm, effects, "trial " + std::to_string(t), t + 1));
  }
  effects[0].start.resize(0);
  arm::Arm off = arm;
  for (arm::Chamber& chamber : off.segments[0].chambers) chamber.moment_gain_nm_per_pa *= 1.1;
  identify::Options options;
  options.held_out_share = 0.0;
  options.frames.prefer_static = false;
  options.free = {"*.moment_gain", "*.length"};
  const identify::Result result = identify::identify_extended(off, effects, trials, options);
  for (const identify::Constant& constant : result.constants)
    EXPECT_NEAR(constant.value, identify::value_of(arm, constant.ref), 4.0 * constant.sd) << constant.name;
  EXPECT_LT(result.misfit, 1.3);
  const std::vector<model::StartNumber> numbers = effects[0].effect->starts(arm, effects[0].values);
  ASSERT_EQ(numbers.size(), 2u);
  ASSERT_EQ(result.effect_starts.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    const identify::EffectStart& start = result.effect_starts[k];
    SCOPED_TRACE(start.trial + " " + start.of);
    EXPECT_EQ(start.effect, "creep");
    EXPECT_EQ(start.trial, trials[k / 2].name);
    EXPECT_NEAR(start.value, numbers[k % 2].sd * found[k / 2][k % 2], 4.0 * start.sd);
    EXPECT_LT(start.sd, 0.1 * numbers[k % 2].sd);
  }
  EXPECT_NE(identify::describe(result).find("effects when the trials began"), std::string::npos);
}

}  // namespace
}  // namespace softarm::diagnose
