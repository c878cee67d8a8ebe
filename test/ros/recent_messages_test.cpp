// What diagnose_node keeps: within its memory, and written as it came.
#include "ros/recent_messages.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <boost/make_shared.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "ros/bag_message.h"
#include "ros/open_bag.h"

namespace softarm {
namespace {

namespace fs = std::filesystem;

using Connection = boost::shared_ptr<ros::M_string>;

template <class Message>
topic_tools::ShapeShifter shape_of(const Message& message) {
  namespace traits = ros::message_traits;
  const ros::SerializedMessage bytes = ros::serialization::serializeMessage(message);
  topic_tools::ShapeShifter shape;
  shape.morph(traits::md5sum<Message>(), traits::datatype<Message>(), traits::definition<Message>(), "");
  ros::serialization::IStream stream(bytes.message_start, static_cast<std::uint32_t>(bytes.num_bytes - 4));
  shape.read(stream);
  return shape;
}

topic_tools::ShapeShifter number(double value) {
  std_msgs::Float64 message;
  message.data = value;
  return shape_of(message);
}

topic_tools::ShapeShifter text(std::size_t length) {
  std_msgs::String message;
  message.data.assign(length, 'x');
  return shape_of(message);
}

/// As roscpp gives it: the bag is read by it.
Connection connection_of(bool latched) {
  namespace traits = ros::message_traits;
  return boost::make_shared<ros::M_string>(
      ros::M_string{{"callerid", "/driver"},
                    {"type", traits::datatype<std_msgs::Float64>()},
                    {"md5sum", traits::md5sum<std_msgs::Float64>()},
                    {"message_definition", traits::definition<std_msgs::Float64>()},
                    {"latching", latched ? "1" : "0"}});
}

std::size_t resident_bytes() {
  std::size_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(RecentMessages, KeepTheNewestWithinTheMemory) {
  RecentMessages recent(1e6, 100000);
  const Connection connection = connection_of(false);
  for (int i = 0; i < 10000; ++i) recent.add("/number", ros::Time(1000.0 + 0.01 * i), number(i), connection);
  EXPECT_LE(recent.bytes(), 100000u);
  EXPECT_GE(recent.bytes(), 99000u);
  const std::size_t source = recent.messages().front().source->footprint();
  EXPECT_EQ(recent.bytes(), recent.messages().size() * RecentMessage::footprint(8) + source);
  EXPECT_EQ(recent.dropped_for_size(), 10000u - recent.messages().size());
  EXPECT_NEAR(recent.messages().back().receipt.toSec(), 1099.99, 1e-6);
}

TEST(RecentMessages, TakeNoMoreMemoryThanIsCounted) {
  if (std::getenv("SOFTARM_SANITIZE") != nullptr) return;  // a sanitizer has memory of its own
  RecentMessages recent(1e6, std::size_t{1} << 40);
  const Connection connection = connection_of(false);
  const topic_tools::ShapeShifter message = text(100);
  const auto before = static_cast<double>(resident_bytes());
  for (int i = 0; i < 200000; ++i) recent.add("/text", ros::Time(1000.0 + 1e-3 * i), message, connection);
  const auto grown = static_cast<double>(resident_bytes()) - before;
  EXPECT_GT(recent.bytes(), 200000u * 150u);
  EXPECT_LT(grown, 1.1 * static_cast<double>(recent.bytes()) + 2e6);
}

/// As of `rostopic pub -1`, again and again: each message comes by a connection of its own.
TEST(RecentMessages, WhatConnectionsTakeIsCountedAndGoesWithTheirMessages) {
  RecentMessages recent(1e6, 100000);
  for (int i = 0; i < 1000; ++i)
    recent.add("/number", ros::Time(1000.0 + i), number(i), connection_of(i % 2 == 0));
  std::size_t bytes =
      recent.before().at("/number").footprint() + recent.before().at("/number").source->footprint();
  for (const RecentMessage& message : recent.messages())
    bytes += message.footprint() + message.source->footprint();
  EXPECT_EQ(recent.bytes(), bytes);
  EXPECT_LE(recent.bytes(), 100000u);
  EXPECT_LT(recent.messages().size(), 100000u / 500u);  // each source has the definition and the header
  EXPECT_GT(recent.messages().size(), 10u);
}

TEST(RecentMessages, ConnectionsTakeNoMoreMemoryThanIsCounted) {
  if (std::getenv("SOFTARM_SANITIZE") != nullptr) return;  // a sanitizer has memory of its own
  RecentMessages recent(1e6, std::size_t{1} << 40);
  const topic_tools::ShapeShifter message = number(0.0);
  const auto before = static_cast<double>(resident_bytes());
  for (int i = 0; i < 8000; ++i)
    recent.add("/number", ros::Time(1000.0 + 1e-3 * i), message, connection_of(false));
  const auto grown = static_cast<double>(resident_bytes()) - before;
  EXPECT_LT(grown, 1.1 * static_cast<double>(recent.bytes()) + 2e6);
}

TEST(RecentMessages, ADefinitionThatIsLargerThanAllIsNotKept) {
  RecentMessages recent(1e6, 100000);
  const Connection connection = connection_of(false);
  for (int i = 0; i < 100; ++i) recent.add("/number", ros::Time(1000.0 + i), number(i), connection);
  const std::size_t bytes = recent.bytes();
  topic_tools::ShapeShifter large = number(1.0);
  large.morph(large.getMD5Sum(), "test/Large", std::string(100000, '#'), "");
  recent.add("/large", ros::Time(1100.0), large, connection_of(false));
  EXPECT_EQ(recent.messages().size(), 100u);
  EXPECT_EQ(recent.bytes(), bytes);
  EXPECT_EQ(recent.dropped_for_size(), 1u);
}

TEST(RecentMessages, OneThatIsLargerThanAllIsNotKept) {
  RecentMessages recent(1e6, 100000);
  const Connection connection = connection_of(false);
  for (int i = 0; i < 100; ++i) recent.add("/number", ros::Time(1000.0 + i), number(i), connection);
  recent.add("/text", ros::Time(1100.0), text(100000), connection);
  EXPECT_EQ(recent.messages().size(), 100u);
  EXPECT_EQ(recent.dropped_for_size(), 1u);
}

TEST(RecentMessages, LatchedOnesStayWhereTimeGoesBackAndAreCounted) {
  RecentMessages recent(5.0, 100000);
  const Connection latched = connection_of(true), plain = connection_of(false);
  recent.add("/payload", ros::Time(1000.0), number(0.1), latched);
  for (int i = 0; i < 100; ++i) recent.add("/number", ros::Time(1001.0 + 0.1 * i), number(i), plain);
  recent.add("/payload", ros::Time(1011.0), number(0.2), latched);
  EXPECT_EQ(recent.before().size(), 1u);
  recent.add("/number", ros::Time(500.0), number(0.0), plain);
  ASSERT_EQ(recent.messages().size(), 1u);
  ASSERT_EQ(recent.before().size(), 1u);
  EXPECT_EQ(*recent.before().at("/payload").bytes, bytes_of(number(0.2)));
  EXPECT_EQ(recent.bytes(), 2u * RecentMessage::footprint(8) + recent.messages().front().source->footprint() +
                                recent.before().at("/payload").source->footprint());
}

TEST(RecentMessages, AClockThatLeapsByDecadesIsFollowed) {
  RecentMessages recent(100.0, 100000);
  const Connection connection = connection_of(false);
  for (double receipt_s : {4e9, 4e9 + 1.0, 1.0, 2.0, 4e9, 4e9 + 1.0})
    EXPECT_NO_THROW(recent.add("/number", ros::Time(receipt_s), number(0.0), connection));
  EXPECT_EQ(recent.messages().size(), 2u);
  EXPECT_NEAR(recent.duration_s(), 1.0, 1e-6);
}

/// Before the first /clock of a simulation that begins at zero.
TEST(RecentMessages, OfBeforeASimulatedTimeAreWritten) {
  RecentMessages recent(100.0, 100000);
  recent.add("/number", ros::Time(), number(0.0), connection_of(false));
  recent.add("/payload", ros::Time(), number(0.1), connection_of(true));
  recent.add("/number", ros::Time(3.0), number(1.0), connection_of(false));
  const fs::path folder = fs::temp_directory_path() / ("softarm_recent_zero_" + std::to_string(::getpid()));
  const std::vector<std::string> paths = write_trials(recent, folder.string(), 3.0);
  ASSERT_EQ(paths.size(), 1u);
  const std::shared_ptr<rosbag::Bag> bag = open_bag(paths.front());
  EXPECT_EQ(rosbag::View(*bag).size(), 3u);
  bag->close();
  fs::remove_all(folder);
}

TEST(RecentMessages, AreWrittenAsTheyCame) {
  RecentMessages recent(100.0, 1000000);
  const Connection latched = connection_of(true), plain = connection_of(false);
  recent.add("/payload", ros::Time(1000.0), number(0.1), latched);
  for (int i = 0; i < 40; ++i) {
    recent.add("/number", ros::Time(1001.0 + 0.1 * i), number(i), plain);
    recent.add("/text", ros::Time(1001.0 + 0.1 * i), text(static_cast<std::size_t>(i)), nullptr);
  }
  const fs::path folder = fs::temp_directory_path() / ("softarm_recent_" + std::to_string(::getpid()));
  const std::vector<std::string> paths = write_trials(recent, folder.string(), 2.5);
  EXPECT_EQ(paths.size(), 2u);
  int numbers = 0, texts = 0, payloads = 0;
  for (const std::string& path : paths) {
    const std::shared_ptr<rosbag::Bag> bag = open_bag(path);
    rosbag::View view(*bag);
    for (const rosbag::MessageInstance& message : view) {
      if (message.getTopic() == "/text") {
        ASSERT_TRUE(message.isType<std_msgs::String>());
        EXPECT_EQ(message.instantiate<std_msgs::String>()->data.size(), static_cast<std::size_t>(texts++));
        continue;
      }
      ASSERT_TRUE(message.isType<std_msgs::Float64>());
      const double value = message.instantiate<std_msgs::Float64>()->data;
      if (message.getTopic() == "/payload") {
        EXPECT_EQ(value, 0.1);
        ++payloads;
      } else {
        EXPECT_EQ(value, numbers++);
      }
    }
    bag->close();
  }
  EXPECT_EQ(numbers, 40);
  EXPECT_EQ(texts, 40);
  EXPECT_EQ(payloads, 2);  // each trial begins with it
  fs::remove_all(folder);
}

}  // namespace
}  // namespace softarm
