// Bags that several threads open at a time, as `softarm estimate *.bag` does.
#include "ros/bag_frames.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

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

}  // namespace
}  // namespace softarm
