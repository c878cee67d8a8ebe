// Bags whose types have the right names, but were defined otherwise where they were recorded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <topic_tools/shape_shifter.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "program.h"
#include "ros/bag_message.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

/// A trial of which these topics were published by another version of their type.
std::string redefined_bag(const TestFolder& dir, const std::set<std::string>& topics) {
  const std::string trial = dir / "trial.bag", redefined = dir / "redefined.bag";
  EXPECT_EQ(softarm_program("simulate demo --seconds 5 --seed 3 --force --out " + trial).status, 0);
  rosbag::Bag in(trial, rosbag::bagmode::Read), out(redefined, rosbag::bagmode::Write);
  for (const rosbag::MessageInstance& message : rosbag::View(in)) {
    if (topics.count(message.getTopic()) == 0) {
      out.write(message.getTopic(), message.getTime(), message);
      continue;
    }
    std::vector<std::uint8_t> bytes = bytes_of(message);
    topic_tools::ShapeShifter shape;
    shape.morph("0123456789abcdef0123456789abcdef", message.getDataType(),
                message.getMessageDefinition() + "\nfloat64 quality\n", "");
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    shape.read(stream);
    out.write(message.getTopic(), message.getTime(), shape);
  }
  return redefined;
}

TEST(SoftarmOtherDefinition, CheckNamesTheTopicsAndSaysWhatToDo) {
  const TestFolder dir;
  const std::string bag = redefined_bag(dir, {"/mocap/ring_2/pose", "/pressure/chamber_1"});
  const Outcome o = softarm_program("check --arm online_200mm " + bag + " --json " + dir / "f.json");
  EXPECT_THAT(o.out, HasSubstr("0123456789abcdef0123456789abcdef"));  // its lines are filled: one word
  std::map<std::string, std::string> said;
  const nlohmann::json written = nlohmann::json::parse(text_of(dir / "f.json"));
  for (const auto& finding : written.at("recordings").at(0).at("findings")) {
    EXPECT_NE(finding.at("id"), "empty_topic") << finding;
    if (finding.at("id") != "other_definition") continue;
    said[finding.at("where")] = finding.at("what");
    EXPECT_THAT(finding.at("remedy").get<std::string>(), HasSubstr("rosbag fix"));
  }
  ASSERT_EQ(said.size(), 2u) << o.out;
  EXPECT_THAT(said.at("/mocap/ring_2/pose"), HasSubstr("is geometry_msgs/PoseStamped by another definition"));
  EXPECT_THAT(said.at("/pressure/chamber_1"),
              HasSubstr("is sensor_msgs/FluidPressure by another definition"));
  EXPECT_EQ(softarm_program("check --arm online_200mm " + redefined_bag(dir, {"/mocap/base/pose"})).status,
            1);
}

TEST(SoftarmOtherDefinition, WhatIsLeftIsEstimatedWithAWarningForEachTopic) {
  const TestFolder dir;
  const std::string bag = redefined_bag(dir, {"/mocap/ring_2/pose", "/pressure/chamber_1"});
  const Outcome o = softarm_program("estimate --arm online_200mm " + bag + " --out " + dir / "out");
  EXPECT_EQ(o.status, 0) << o.err;
  for (const std::string topic : {"/mocap/ring_2/pose (ring_2)", "/pressure/chamber_1 (chamber_1)"})
    EXPECT_THAT(o.err, HasSubstr("warning: " + bag + ": topic " + topic + " is "));
}

TEST(SoftarmOtherDefinition, WithoutTheBaseTheReasonIsOneLine) {
  const TestFolder dir;
  const std::string bag = redefined_bag(dir, {"/mocap/base/pose"});
  const std::size_t before = dir.entries();
  for (const std::string command : {"estimate", "identify", "diagnose"}) {
    SCOPED_TRACE(command);
    const Outcome o = softarm_program(command + " --arm online_200mm " + bag + " --out " + dir / "out");
    EXPECT_GT(o.status, 0);
    EXPECT_THAT(o.err, HasSubstr("redefined.bag: the base cannot be read: topic /mocap/base/pose (base) is "
                                 "geometry_msgs/PoseStamped by another definition"));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(dir.entries(), before) << "something was left behind";
  }
}

}  // namespace
}  // namespace softarm
