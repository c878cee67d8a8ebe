// Identification with effects in the model: what they do changes with the constants.
#include "identify/identify_extended.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

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

}  // namespace
}  // namespace softarm::diagnose
