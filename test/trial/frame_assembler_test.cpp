#include "trial/frame_assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "frame_assembler_fixture.h"

namespace softarm {
namespace {

using testing_assembler::Feeder;
using testing_assembler::kRate;
using testing_assembler::three_ring_arm;
using testing_assembler::without_waiting;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(FrameAssembler, FrameClosesWithItsLastBodyInAnyOrder) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  std::mt19937 random(1);
  for (int k = 0; k < 200; ++k) {
    std::vector<int> bodies{-1, 0, 1, 2};
    std::shuffle(bodies.begin(), bodies.end(), random);
    for (int i = 0; i < 4; ++i) {
      feed.body(bodies[i], k);
      EXPECT_EQ(assembler.take().size(), i == 3 ? 1u : 0u);
    }
  }
  EXPECT_TRUE(assembler.rejected().empty());
  EXPECT_EQ(assembler.frames_seen(), 200u);
}

TEST(FrameAssembler, FramesDoNotDependOnTheOrderOfTopics) {
  // Topics run ahead of one another by up to ten frames, as sockets read one after the other do.
  const auto run = [](int batch) {
    trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
    Feeder feed(assembler);
    for (int k = 0; k < 240; k += batch) {
      for (int body : {2, -1, 1, 0}) {
        for (int j = k; j < k + batch; ++j) feed.body(body, j);
      }
    }
    assembler.flush();
    EXPECT_TRUE(assembler.rejected().empty());
    return assembler.take();
  };
  const std::vector<trial::Frame> ordered = run(1), bursts = run(10);
  ASSERT_EQ(ordered.size(), 240u);
  ASSERT_EQ(bursts.size(), 240u);
  for (std::size_t k = 0; k < ordered.size(); ++k) {
    EXPECT_EQ(ordered[k].stamp_s(), bursts[k].stamp_s());
    ASSERT_EQ(bursts[k].bodies.size(), 3u);
    ASSERT_TRUE(bursts[k].base_body);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(bursts[k].bodies[i].body, i);
      EXPECT_EQ(ordered[k].bodies[i].p_mocap, bursts[k].bodies[i].p_mocap);
    }
  }
}

TEST(FrameAssembler, StampsWithinTheToleranceAreOneFrame) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 100; ++k) {
    for (int body = -1; body < 3; ++body) feed.body_at(body, feed.stamp(k) + 2e-4 * body, k);
  }
  assembler.flush();
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 100u);
  for (const trial::Frame& frame : frames) EXPECT_EQ(frame.bodies.size(), 3u);
}

TEST(FrameAssembler, LostBodyDelaysFramesOnceAndReturns) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  std::size_t emitted = 0;
  double longest_delay = 0.0;
  int delayed = 0;
  for (int k = 0; k < 720; ++k) {
    const bool lost = k >= 240 && k < 480;
    for (int body = -1; body < 3; ++body) {
      if (!(lost && body == 1)) feed.body(body, k);
    }
    for (const trial::Frame& frame : assembler.take()) {
      ++emitted;
      const double delay = 1e-9 * static_cast<double>(trial::to_nanoseconds(feed.stamp(k)) - frame.stamp_ns);
      longest_delay = std::max(longest_delay, delay);
      delayed += delay > 0.0;
      const bool without = frame.stamp_s() > feed.stamp(239.5) && frame.stamp_s() < feed.stamp(479.5);
      // The first sample after the loss may come after the others have closed its frame.
      if (std::abs(frame.stamp_s() - feed.stamp(480)) > 1e-6) {
        EXPECT_EQ(frame.bodies.size(), without ? 2u : 3u);
      }
    }
  }
  EXPECT_EQ(emitted, 720u);
  EXPECT_LT(longest_delay, 0.25 + 2.0 / kRate);
  EXPECT_LT(delayed, 65);  // only while the loss was not yet known
}

TEST(FrameAssembler, LateStartOfABodyHoldsNothingUp) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 480; ++k) {
    for (int body = -1; body < 3; ++body) {
      if (body != 2 || k > 240) feed.body(body, k);
    }
  }
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 480u);
  EXPECT_EQ(frames[100].bodies.size(), 2u);
  EXPECT_EQ(frames[400].bodies.size(), 3u);
}

TEST(FrameAssembler, BodiesOfDifferentRatesGiveEveryFrame) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 240; ++k) {
    for (int body = -1; body < 3; ++body) {
      if (body != 0 || k % 2 == 0) feed.body(body, k);
    }
  }
  assembler.flush();
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 240u);
  EXPECT_EQ(frames[100].bodies.size(), 3u);
  EXPECT_EQ(frames[101].bodies.size(), 2u);
  EXPECT_TRUE(assembler.rejected().empty());
}

TEST(FrameAssembler, LateSamplesAreCountedNotUsed) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 100);
  assembler.take();
  feed.body_at(1, feed.stamp(50) + 1e-3, 50);
  EXPECT_TRUE(assembler.take().empty());
  EXPECT_EQ(assembler.rejected().at("late ring_2"), 1u);
}

TEST(FrameAssembler, DuplicatesAreCountedWhateverTheirStamp) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 100; ++k) {
    for (int body = -1; body < 3; ++body) {
      feed.body(body, k);
      feed.body(body, k);                           // same stamp
      feed.body_at(body, feed.stamp(k) + 3e-5, k);  // sent twice, stamped at sending
    }
  }
  EXPECT_EQ(assembler.take().size(), 100u);
  for (const char* body : {"base", "ring_1", "ring_2", "ring_3"}) {
    EXPECT_EQ(assembler.rejected().at(std::string("duplicate ") + body), 200u);
  }
}

TEST(FrameAssembler, BadNumbersAreRejectedByName) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 10);
  assembler.take();
  const Eigen::Quaterniond unit = Eigen::Quaterniond::Identity();
  const double t = feed.stamp(10);
  assembler.add_body(-1, t, {0.1, 0.0, kNan}, unit);
  assembler.add_body(0, t, {0.0, 0.0, 0.0}, unit);
  assembler.add_body(1, t, {0.1, 0.0, std::numeric_limits<double>::infinity()}, unit);
  assembler.add_body(2, t, feed.position(2, 10), Eigen::Quaterniond(0, 0, 0, 0));  // orientation is needed
  EXPECT_TRUE(assembler.take().empty());
  EXPECT_EQ(assembler.dropped_frames().at("no_valid_body"), 1u);
  assembler.add_body(0, feed.stamp(11), feed.position(0, 11), Eigen::Quaterniond(0, 0, 0, 0));  // not needed
  assembler.add_body(1, feed.stamp(11), feed.position(1, 11), Eigen::Quaterniond(kNan, 0, 0, 0));
  assembler.add_body(2, feed.stamp(11), feed.position(2, 11), Eigen::Quaterniond(2, 0, 0, 0));
  assembler.add_body(-1, feed.stamp(11), {1e5, 0, 0}, unit);
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 1u);
  ASSERT_EQ(frames[0].bodies.size(), 2u);
  EXPECT_FALSE(frames[0].bodies[0].q_mocap);
  EXPECT_FALSE(frames[0].base_body);
  const std::map<std::string, std::uint64_t> expected{
      {"nan base", 1},    {"all_zero ring_1", 1},        {"nan ring_2", 1},
      {"absurd base", 1}, {"zero_quaternion ring_3", 1}, {"bad_quaternion ring_3", 1}};
  EXPECT_EQ(assembler.rejected(), expected);
}

TEST(FrameAssembler, SignOfAQuaternionDoesNotMatter) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 100; ++k) {
    for (int body = -1; body < 3; ++body) feed.body(body, k, k % 2 ? -1.0 : 1.0);
  }
  for (const trial::Frame& frame : assembler.take()) EXPECT_GT(frame.bodies[2].q_mocap->w(), 0.9);
  EXPECT_TRUE(assembler.rejected().empty());
}

TEST(FrameAssembler, BadStampsAreRejected) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 10);
  for (double stamp : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    feed.body_at(1, stamp, 10);
  }
  EXPECT_EQ(assembler.rejected().at("bad_stamp ring_2"), 4u);
  feed.frames(10, 20);
  EXPECT_EQ(assembler.take().size(), 20u);
}

TEST(FrameAssembler, UnknownBodyOrInputThrows) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  EXPECT_THROW(assembler.add_body(3, 1.0, {0, 0, 1}, {}), std::out_of_range);
  EXPECT_THROW(assembler.add_input(2, 1.0, 1e5), std::out_of_range);
  arm::Arm fixed = three_ring_arm();
  fixed.base.body.reset();
  trial::FrameAssembler without_base(fixed, without_waiting());
  EXPECT_THROW(without_base.add_body(trial::FrameAssembler::kBaseBody, 1.0, {0, 0, 1}, {}),
               std::out_of_range);
}

TEST(FrameAssembler, EveryInstantIsEmittedDroppedOrOpen) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::uint64_t emitted = 0;
  for (int k = 0; k < 5000; ++k) {
    for (int body = -1; body < 3; ++body) {
      const double dice = unit(random);
      if (dice < 0.05) continue;
      if (dice < 0.10) {
        assembler.add_body(body, feed.stamp(k), {kNan, 0, 0}, {});
      } else if (dice < 0.12) {
        feed.body_at(body, feed.stamp(k) * unit(random) * 2.0, k);
      } else {
        feed.body(body, k);
      }
    }
    const auto frames = assembler.take();
    emitted += frames.size();
    std::uint64_t dropped = 0;
    for (const auto& [reason, count] : assembler.dropped_frames()) dropped += count;
    ASSERT_EQ(assembler.frames_seen(), emitted + dropped + assembler.frames_open());
  }
  EXPECT_GT(emitted, 4000u);
}

}  // namespace
}  // namespace softarm
