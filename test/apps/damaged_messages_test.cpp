// Bags that are whole, with messages in them that are not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <topic_tools/shape_shifter.h>

#include "program.h"
#include "ros/bag_message.h"

namespace softarm {
namespace {

/// A trial in which one of so many messages of a topic ends too early, the first one among them.
std::string damaged_bag(const TestFolder& dir, const std::string& topic, int every) {
  const std::string trial = dir / "trial.bag", damaged = dir / "damaged.bag";
  EXPECT_EQ(softarm_program("simulate demo --seconds 5 --seed 3 --force --out " + trial).status, 0);
  rosbag::Bag in(trial, rosbag::bagmode::Read), out(damaged, rosbag::bagmode::Write);
  int count = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(in)) {
    std::vector<std::uint8_t> bytes = bytes_of(message);
    if (message.getTopic() == topic && count++ % every == 0) bytes.resize(bytes.size() / 2);
    topic_tools::ShapeShifter shape;
    shape.morph(message.getMD5Sum(), message.getDataType(), message.getMessageDefinition(), "");
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    shape.read(stream);
    out.write(message.getTopic(), message.getTime(), shape);
  }
  return damaged;
}

TEST(SoftarmDamagedMessages, AFewAreLeftOutAndSaidInOneLine) {
  const TestFolder dir;
  const std::string bag = damaged_bag(dir, "/mocap/ring_2/pose", 100);
  const Outcome o = softarm_program("estimate --arm online_200mm " + bag + " --out " + dir / "out");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.err, ::testing::ContainsRegex("softarm: warning: .*damaged.bag: [0-9]+ of [0-9]+ messages of "
                                              "topic /mocap/ring_2/pose [(]ring_2[)] cannot be read"));
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_THAT(o.out, ::testing::HasSubstr("rejected, undecodable ring_2"));
  EXPECT_EQ(softarm_program("check --arm online_200mm " + bag + " --json " + dir / "f.json").status, 0);
  EXPECT_THAT(text_of(dir / "f.json"), ::testing::HasSubstr("\"undecodable\""));
}

TEST(SoftarmDamagedMessages, ATopicWithoutAWholeOneIsRefusedInOneLine) {
  const TestFolder dir;
  const std::string bag = damaged_bag(dir, "/mocap/ring_2/pose", 1);
  const std::size_t before = dir.entries();
  for (const std::string command : {"estimate", "identify", "diagnose"}) {
    SCOPED_TRACE(command);
    const Outcome o = softarm_program(command + " --arm online_200mm " + bag + " --out " + dir / "out");
    EXPECT_GT(o.status, 0);
    EXPECT_THAT(o.err, ::testing::HasSubstr("damaged.bag: damaged: not one of "));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(dir.entries(), before) << "something was left behind";
  }
  EXPECT_EQ(softarm_program("check --arm online_200mm " + bag).status, 1);
}

}  // namespace
}  // namespace softarm
