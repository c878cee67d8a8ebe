// Bags that several threads open at a time, as `softarm estimate *.bag` does, and messages that are damaged
// or of other definitions.
#include "ros/bag_frames.h"

#include <geometry_msgs/PoseStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float64.h>
#include <tf2_msgs/TFMessage.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>

#include "drivers_support.h"
#include "ros/bag_message.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

TEST(BagFrames, ManyAreOpenedAndRefusedSideBySide) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml", {});
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("softarm_no_bag_" + std::to_string(::getpid()) + ".bag");
  std::ofstream(path) << "this is not a bag\n";
  constexpr int kThreads = 4, kTimes = 250;
  std::atomic<int> refused{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < kTimes; ++k) {
        try {
          BagFrames bag(path.string(), arm);
        } catch (const BagError&) {
          ++refused;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::filesystem::remove(path);
  EXPECT_EQ(refused, kThreads * kTimes);
}

/// A message of transforms as a bag holds it, said to be so many.
topic_tools::ShapeShifter transforms(std::size_t count, std::uint32_t said) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(count);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  std::memcpy(bytes.data(), &said, sizeof(said));
  namespace traits = ros::message_traits;
  topic_tools::ShapeShifter raw;
  raw.morph(traits::MD5Sum<tf2_msgs::TFMessage>::value(), traits::DataType<tf2_msgs::TFMessage>::value(),
            traits::Definition<tf2_msgs::TFMessage>::value(), "");
  ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  raw.read(in);
  return raw;
}

TEST(BagMessage, AFalseLengthIsRefusedBeforeThereIsRoomForIt) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("softarm_lengths_" + std::to_string(::getpid()) + ".bag"))
          .string();
  {
    const std::shared_ptr<rosbag::Bag> bag = new_bag(path);
    bag->write("/tf", ros::Time(1.0), transforms(3, 3));
    bag->write("/tf", ros::Time(2.0), transforms(3, 4));
    bag->write("/tf", ros::Time(3.0), transforms(3, 0xFFFFFFFFu));
    bag->write("/tf", ros::Time(4.0), transforms(3, 8000000));
  }
  const std::shared_ptr<rosbag::Bag> bag = open_bag(path);
  for (const rosbag::MessageInstance& instance : rosbag::View(*bag)) {
    const BagMessage message = bag_message(instance);
    if (message.time == ros::Time(1.0)) {
      EXPECT_EQ(read_message<tf2_msgs::TFMessage>(message)->transforms.size(), 3u);
    } else {
      EXPECT_THROW(read_message<tf2_msgs::TFMessage>(message), ros::Exception);
    }
  }
  std::filesystem::remove(path);
}

constexpr char kOtherMd5[] = "0123456789abcdef0123456789abcdef";

/// Eight bytes that are said to be a message with a header, which takes more.
template <class Message>
void write_damaged(drivers::TestBag& bag, const std::string& topic, double s) {
  namespace traits = ros::message_traits;
  bag.write_as(traits::datatype<Message>(), traits::md5sum<Message>(), traits::definition<Message>(), topic,
               s, std_msgs::Float64());
}

/// Ten frames of base, two rings and a pressure; what is in `redefined` was defined otherwise, and of what is
/// in `damaged` no message can be read.
void write_trial(drivers::TestBag& bag, const std::set<std::string>& redefined,
                 const std::set<std::string>& damaged = {}) {
  const auto write = [&](const std::string& name, const std::string& topic, double s, const auto& message) {
    using Message = std::decay_t<decltype(message)>;
    if (damaged.count(name) != 0) return write_damaged<Message>(bag, topic, s);
    if (redefined.count(name) == 0) return bag.write(topic, s, message);
    bag.write_as(ros::message_traits::datatype<Message>(), kOtherMd5, "float64 of_another_version\n", topic,
                 s, message);
  };
  for (int i = 0; i < 10; ++i) {
    const double s = drivers::kStart_s + drivers::kPeriod_s * i;
    geometry_msgs::PoseStamped pose;
    pose.header.stamp = ros::Time(s);
    pose.pose.orientation.w = 1.0;
    for (const std::string name : {"base", "ring_1", "ring_2"}) {
      const Eigen::Vector3d p = name == "base" ? Eigen::Vector3d(1e-4 * i, 0.0, 1.0)
                                               : drivers::ring_at(name == "ring_1" ? 0 : 1, i);
      pose.pose.position.x = p.x();
      pose.pose.position.y = p.y();
      pose.pose.position.z = p.z();
      write(name, "/mocap/" + name + "/pose", s, pose);
    }
    sensor_msgs::FluidPressure pressure;
    pressure.header.stamp = ros::Time(s);
    pressure.fluid_pressure = 120e3;
    write("chamber_1", "/pressure/chamber_1", s, pressure);
  }
}

arm::Arm arm_with_a_pressure() {
  return drivers::arm_with("inputs: {pressures: [{name: chamber_1, topic: /pressure/chamber_1}]}");
}

TEST(BagFrames, AnotherDefinitionOfATypeIsSaidAndWhatIsLeftIsRead) {
  using ::testing::AllOf;
  using ::testing::ElementsAre;
  using ::testing::HasSubstr;
  drivers::TestBag bag;
  write_trial(bag, {"ring_1", "chamber_1"});
  const drivers::TestBag::Result result = bag.read(arm_with_a_pressure());
  const auto said = [](const std::string& topic, const std::string& type) {
    return AllOf(
        HasSubstr("topic " + topic),
        HasSubstr("is " + type + " by another definition (MD5 " + kOtherMd5 + ") than the one known here"),
        HasSubstr("rosbag fix"));
  };
  EXPECT_THAT(result.warnings,
              ElementsAre(said("/mocap/ring_1/pose (ring_1)", "geometry_msgs/PoseStamped"),
                          said("/pressure/chamber_1 (chamber_1)", "sensor_msgs/FluidPressure")));
  EXPECT_EQ(result.frames.size(), 10u);
  EXPECT_EQ(drivers::observed(result.frames.front(), 0), nullptr);
  EXPECT_NE(drivers::observed(result.frames.front(), 1), nullptr);
}

TEST(BagFrames, WithoutABaseOrABodyThatCanBeReadTheReasonIsSaid) {
  const auto refused = [](const std::set<std::string>& redefined) -> std::string {
    drivers::TestBag bag;
    write_trial(bag, redefined);
    try {
      bag.read(arm_with_a_pressure());
    } catch (const BagError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(refused({"base"}),
              ::testing::HasSubstr("the base cannot be read: topic /mocap/base/pose (base) is "
                                   "geometry_msgs/PoseStamped by another definition"));
  EXPECT_THAT(refused({"ring_1", "ring_2"}),
              ::testing::HasSubstr("no measured body can be read: topic /mocap/ring_1/pose (ring_1) is"));
}

TEST(BagFrames, OfTwoPublishersWithTwoDefinitionsOneIsReadAndTheOtherCounted) {
  drivers::TestBag bag;
  write_trial(bag, {});
  for (int i = 0; i < 3; ++i) {
    bag.write_as("geometry_msgs/PoseStamped", kOtherMd5, "float64 of_another_version\n", "/mocap/ring_1/pose",
                 drivers::kStart_s + 1.0 + i, geometry_msgs::PoseStamped());
  }
  const drivers::TestBag::Result result = bag.read(arm_with_a_pressure());
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_EQ(result.frames.size(), 10u);
  EXPECT_THAT(result.rejected, ::testing::Contains(::testing::Pair("other_definition ring_1", 3u)));
}

TEST(BagFrames, DamagedMessagesAreLeftOutCountedAndSaidInOneLine) {
  drivers::TestBag bag;
  write_trial(bag, {});
  for (const double s : {0.035, 0.045, 1.26})  // two of them between the frames
    write_damaged<geometry_msgs::PoseStamped>(bag, "/mocap/ring_1/pose", drivers::kStart_s + s);
  write_damaged<sensor_msgs::FluidPressure>(bag, "/pressure/chamber_1", drivers::kStart_s + 1.26);
  const drivers::TestBag::Result result = bag.read(arm_with_a_pressure());
  EXPECT_THAT(
      result.warnings,
      ::testing::ElementsAre(
          ::testing::HasSubstr(".bag: 3 of 13 messages of topic /mocap/ring_1/pose (ring_1) cannot be read "
                               "and are left out, the first at 0.0 s: damaged, or of another version of "
                               "their driver"),
          ::testing::HasSubstr(
              ".bag: 1 of 11 messages of topic /pressure/chamber_1 (chamber_1) cannot be read and are left "
              "out, the first at 1.3 s: ")));
  EXPECT_THAT(result.rejected, ::testing::Contains(::testing::Pair("undecodable ring_1", 3u)));
  EXPECT_THAT(result.rejected, ::testing::Contains(::testing::Pair("undecodable chamber_1", 1u)));
  ASSERT_EQ(result.frames.size(), 10u);
  for (const trial::Frame& frame : result.frames) {
    EXPECT_NE(drivers::observed(frame, 0), nullptr);
    EXPECT_NE(drivers::observed(frame, 1), nullptr);
    EXPECT_TRUE(frame.inputs.at(0));
  }
}

TEST(BagFrames, ATopicOfWhichEveryMessageIsDamagedIsAnErrorInOneLine) {
  for (const std::string name : {"base", "ring_1", "chamber_1"}) {
    SCOPED_TRACE(name);
    drivers::TestBag bag;
    write_trial(bag, {}, {name});
    try {
      bag.read(arm_with_a_pressure());
      ADD_FAILURE() << "it was read";
    } catch (const BagError& e) {
      EXPECT_THAT(e.what(), ::testing::HasSubstr(".bag: damaged: not one of 10 messages of topic /"));
      EXPECT_THAT(e.what(), ::testing::HasSubstr("(" + name + ") can be read: copy the bag again"));
      EXPECT_THAT(e.what(), ::testing::Not(::testing::HasSubstr("\n")));
    }
  }
}

}  // namespace
}  // namespace softarm
