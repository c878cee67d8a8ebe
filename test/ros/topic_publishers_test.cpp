// Losses by publisher, and two publishers on one topic.
#include "ros/topic_publishers.h"

#include <gtest/gtest.h>

namespace softarm {
namespace {

using Pair = std::pair<std::string, std::string>;

TEST(TopicPublishers, CountLossesOfEachByItself) {
  TopicPublishers publishers;
  EXPECT_EQ(publishers.add("/a", 1000), 0u);
  EXPECT_EQ(publishers.add("/b", 20), 0u);
  EXPECT_EQ(publishers.add("/a", 1001), 0u);
  EXPECT_EQ(publishers.add("/b", 21), 0u);
  EXPECT_EQ(publishers.add("/a", 1004), 2u);
  EXPECT_EQ(publishers.add("/b", 22), 0u);
  EXPECT_EQ(publishers.add("/b", 1), 0u);       // started again
  EXPECT_EQ(publishers.add("/b", 500000), 0u);  // no loss is that large
  EXPECT_EQ(publishers.add("/b", std::nullopt), 0u);
  EXPECT_EQ(publishers.add("/b", 500010), 0u);
}

TEST(TopicPublishers, TwoAreThoseWhoseMessagesAlternate) {
  TopicPublishers publishers;
  publishers.add("/b", 1);
  publishers.add("/a", 1);
  EXPECT_FALSE(publishers.two());  // one may have taken the other's place
  publishers.add("/b", 2);
  EXPECT_FALSE(publishers.two());
  publishers.add("/a", 2);
  ASSERT_TRUE(publishers.two());
  EXPECT_EQ(*publishers.two(), Pair("/a", "/b"));
  publishers.end_period();
  EXPECT_TRUE(publishers.two());
  publishers.add("/a", 3);
  publishers.end_period();
  EXPECT_FALSE(publishers.two());
}

TEST(TopicPublishers, OneAfterTheOtherAreNotTwo) {
  TopicPublishers publishers;
  for (int i = 0; i < 1000; ++i) {  // `rostopic pub`, again and again
    publishers.add("/rostopic_" + std::to_string(i), 1);
    EXPECT_FALSE(publishers.two()) << i;
  }
  for (std::uint32_t round = 0; round < 3; ++round) {  // a driver and a bag, in turns
    for (const std::string name : {"/driver", "/play"}) {
      for (std::uint32_t i = 0; i < 100; ++i) publishers.add(name, i);
      publishers.end_period();
      publishers.add(name, 100);
      publishers.end_period();
      EXPECT_FALSE(publishers.two());
    }
  }
}

}  // namespace
}  // namespace softarm
