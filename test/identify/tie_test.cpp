// Constants that several segments share.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synthetic.h"

namespace softarm::identify {
namespace {

using ::testing::HasSubstr;

/// An arm of two segments of one make, each bent by a cable of its own in both directions.
arm::Arm twins() {
  arm::Arm arm = testing::shipped("cable_235mm");
  arm.segments[0].cables[0].curvature_gain_per_m_rad = 6.0;
  arm.segments[0].length_m = 0.12;
  arm.segments[0].length_range_m = {0.1, 0.14};
  arm.segments.push_back(arm.segments[0]);
  arm.segments[1].name = "segment_2";
  arm.segments[1].cables[0].input = "servo_2";
  arm.segments[1].cables[0].bending_direction_rad = 0.5 * M_PI;
  arm.inputs.scalars.push_back(arm.inputs.scalars[0]);
  arm.inputs.scalars[1].name = "servo_2";
  arm.bodies.resize(2);
  arm.bodies[0].arclength_m = 0.12;
  arm.bodies[1].arclength_m = 0.24;
  arm.payload.arclength_m = 0.24;
  return arm;
}

TEST(Tie, OneValueForAllSegmentsIsFoundMoreSurelyThanOneForEach) {
  const arm::Arm nominal = twins();
  arm::Arm truth = nominal;
  for (arm::Segment& segment : truth.segments) segment.bending_stiffness.base_nm2 = 0.0095;
  truth.segments[1].cables[0].curvature_gain_per_m_rad = 7.0;
  std::mt19937_64 random(3);
  testing::Protocol protocol;
  protocol.trials = 20;
  protocol.payloads_kg = {0.0, 0.03};
  protocol.draw = [](std::mt19937_64& r) {
    return arm::InputValues{testing::uniform(r, -0.6, 0.6), testing::uniform(r, -0.6, 0.6)};
  };
  const std::vector<trial::Trial> trials = testing::make_trials(truth, protocol, random);
  identify::Options options;
  options.held_out_share = 0.0;
  const identify::Result each = identify::identify(nominal, trials, options);
  options.tied = {"*.bending_stiffness.base"};
  const identify::Result tied = identify::identify(nominal, trials, options);
  ASSERT_EQ(each.constants.size(), 4u);
  ASSERT_EQ(tied.constants.size(), 3u);
  const auto stiffness = [](const identify::Constant& c) {
    return c.ref.kind == identify::ConstantKind::kBendingStiffness;
  };
  const auto one = std::find_if(tied.constants.begin(), tied.constants.end(), stiffness);
  ASSERT_NE(one, tied.constants.end());
  EXPECT_EQ(one->name, nominal.segments[0].name + "=segment_2.bending_stiffness.base");
  EXPECT_NEAR(one->value, 0.0095, 4.0 * one->sd);
  EXPECT_NEAR(one->value, 0.0095, 0.0005);
  for (const identify::Constant& c : each.constants) {
    if (stiffness(c)) {
      EXPECT_LT(one->sd, c.sd) << c.name;
    }
  }
  for (const arm::Segment& segment : tied.arm.segments)
    EXPECT_EQ(segment.bending_stiffness.base_nm2, one->value);
  EXPECT_NEAR(tied.arm.segments[1].cables[0].curvature_gain_per_m_rad, 7.0, 0.2);
}

TEST(Tie, APatternThatTiesNothingIsRefused) {
  const arm::Arm arm = twins();
  const std::vector<identify::ConstantRef> list = identify::default_free(arm);
  EXPECT_EQ(identify::tie_constants(arm, list, {"*.bending_stiffness.base"}).size(), list.size() - 1);
  for (const std::string pattern : {"segment_2.bending_stiffness.base", "*.length"}) {
    try {
      identify::tie_constants(arm, list, {pattern});
      ADD_FAILURE() << pattern;
    } catch (const std::invalid_argument& e) {
      EXPECT_THAT(e.what(), HasSubstr(pattern));
    }
  }
  EXPECT_THROW(identify::tie_constants(arm, list, {"*.no_such"}), std::invalid_argument);
}

}  // namespace
}  // namespace softarm::identify
