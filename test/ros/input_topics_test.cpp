// Which messages an arm's inputs may come by.
#include "ros/input_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arm/input_kind.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

arm::Arm shipped(const std::string& name) {
  return arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/" + name + ".yaml", {});
}

std::map<std::string, InputTopic> topics_of(const arm::Arm& arm) {
  std::map<std::string, InputTopic> topics;
  for (const InputTopic& topic : input_topics(arm)) topics[topic.topic] = topic;
  return topics;
}

TEST(InputTopics, OfEveryKindAreThoseOfTheArm) {
  const auto hybrid = topics_of(shipped("hybrid_85mm"));
  EXPECT_EQ(hybrid.at("/pressure/chamber_1").type, "sensor_msgs/FluidPressure");
  EXPECT_EQ(hybrid.at("/tendon/3/tension").type, "std_msgs/Float64");
  EXPECT_EQ(hybrid.at("/tendon/3/tension").feeds, "tendon_3");
  EXPECT_EQ(topics_of(shipped("cable_235mm")).at("/servo/1/angle").type, "std_msgs/Float64");
}

TEST(InputTopics, OneArrayFeedsInputsOfSeveralKinds) {
  arm::Arm arm = shipped("two_segment");
  int element = 0;
  for (arm::ScalarInput& input : arm.inputs.scalars) {
    input.topic = "/rig/state";
    input.type = "std_msgs/Float64MultiArray";
    input.element = element++;
  }
  const auto topics = topics_of(arm);
  EXPECT_EQ(topics.at("/rig/state").feeds, "chamber_1, chamber_2, chamber_3, tendon_1, tendon_2");
}

TEST(InputTopics, APressureMessageIsRefusedForATensionOrAnAngle) {
  for (const std::string name : {"hybrid_85mm", "cable_235mm"}) {
    arm::Arm arm = shipped(name);
    arm::ScalarInput& input = arm.inputs.scalars.back();
    input.type = "sensor_msgs/FluidPressure";
    try {
      input_topics(arm);
      ADD_FAILURE() << name << " was accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_THAT(e.what(), AllOf(HasSubstr(name), HasSubstr(input.name),
                                  HasSubstr(arm::to_string(input.kind)), HasSubstr("std_msgs/Float64")));
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(InputTopics, AnUnknownTypeNamesTheKnownOnes) {
  arm::Arm arm = shipped("hybrid_85mm");
  arm.inputs.scalars.back().type = "std_msgs/Int32";
  EXPECT_THAT(
      [&] { input_topics(arm); },
      ::testing::Throws<std::invalid_argument>(::testing::Property(
          &std::invalid_argument::what, AllOf(HasSubstr("tension 'tendon_3'"), HasSubstr("std_msgs/Int32"),
                                              HasSubstr("std_msgs/Float64")))));
}

}  // namespace
}  // namespace softarm
