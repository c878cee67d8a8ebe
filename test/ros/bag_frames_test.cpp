// Bags that several threads open at a time, as `softarm estimate *.bag` does, and messages with false
// lengths.
#include "ros/bag_frames.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

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

}  // namespace
}  // namespace softarm
