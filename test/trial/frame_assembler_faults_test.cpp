// Frozen and jumping bodies, jumps of time, pressures and payload.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "frame_assembler_fixture.h"

namespace softarm {
namespace {

using testing_assembler::Feeder;
using testing_assembler::kRate;
using testing_assembler::three_ring_arm;
using testing_assembler::without_waiting;

std::uint64_t count(const std::map<std::string, std::uint64_t>& counts, const std::string& key) {
  const auto found = counts.find(key);
  return found == counts.end() ? 0 : found->second;
}

bool has_body(const trial::Frame& frame, int body) {
  for (const trial::BodyObservation& seen : frame.bodies) {
    if (seen.body == body) return true;
  }
  return false;
}

TEST(FrameAssemblerFrozen, RepeatedPoseIsDroppedUntilItChanges) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 720; ++k) {
    for (int body = -1; body < 3; ++body) {
      const bool frozen = body == 1 && k >= 240 && k < 480;
      feed.body_at(body, feed.stamp(k), frozen ? 240 : k);
    }
  }
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 720u);
  EXPECT_TRUE(has_body(frames[290], 1));   // not yet suspicious
  EXPECT_FALSE(has_body(frames[302], 1));  // 0.25 s later
  EXPECT_FALSE(has_body(frames[479], 1));
  EXPECT_TRUE(has_body(frames[480], 1));
  EXPECT_EQ(count(assembler.rejected(), "frozen ring_2"), 480u - 240u - 60u - 1u);
  EXPECT_EQ(assembler.rejected().size(), 1u);
}

TEST(FrameAssemblerFrozen, AFewRepeatsOrACommonRestAreNoFault) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 240; ++k) {
    for (int body = -1; body < 3; ++body) feed.body_at(body, feed.stamp(k), k - k % 8);
  }
  for (int k = 240; k < 720; ++k) {  // a simulation without noise at rest
    for (int body = -1; body < 3; ++body) feed.body_at(body, feed.stamp(k), 239);
  }
  EXPECT_EQ(assembler.take().size(), 720u);
  EXPECT_TRUE(assembler.rejected().empty());
  EXPECT_NEAR(*assembler.changed_s(), feed.stamp(240), 1e-9);
}

TEST(FrameAssemblerFrozen, AMountWithoutNoiseIsNoFaultButAFrozenTrackerIs) {
  trial::FrameAssembler still(three_ring_arm(), without_waiting());
  Feeder feed_still(still);
  trial::FrameAssembler stuck(three_ring_arm(), without_waiting());
  Feeder feed_stuck(stuck);
  for (int k = 0; k < 480; ++k) {
    for (int body = -1; body < 3; ++body) {
      feed_still.body_at(body, feed_still.stamp(k), body < 0 ? 0 : k);
      feed_stuck.body_at(body, feed_stuck.stamp(k), body < 0 ? std::min(k, 100) : k);
    }
  }
  EXPECT_TRUE(still.rejected().empty());
  EXPECT_GT(count(stuck.rejected(), "frozen base"), 300u);
}

/// Of a lone ring it is what drives the arm that says that it should move.
TEST(FrameAssemblerFrozen, ADamagedStampOfAnInputFreezesNoRingThatRests) {
  arm::Arm arm = three_ring_arm();
  arm.bodies.erase(arm.bodies.begin(), arm.bodies.begin() + 2);
  for (double ahead_s : {1e6, 5.0, 1.5, 0.9, 0.5}) {
    for (bool goes_on : {true, false}) {  // the input, as it was
      trial::FrameAssembler assembler(arm, without_waiting());
      Feeder feed(assembler);
      for (int k = 0; k < 1920; ++k) {
        const bool changed = goes_on ? k == 20 : k >= 20;
        assembler.add_input(0, feed.stamp(k) + (k == 20 ? ahead_s : 0.0), changed ? 1.3e5 : 1.2e5);
        feed.body_at(-1, feed.stamp(k), 0);
        feed.body_at(0, feed.stamp(k), std::min(k, 60));  // a simulation without noise, at rest from then on
      }
      EXPECT_EQ(count(assembler.rejected(), "frozen ring_3"), 0u) << ahead_s;
      EXPECT_EQ(assembler.take().size(), 1920u);
    }
  }
}

TEST(FrameAssemblerFrozen, ADamagedStampOfABodyFreezesNoOtherThatRests) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 960; ++k) {
    for (int body = -1; body < 3; ++body) {
      const bool damaged = body == 1 && k == 60;  // of its last change, and less ahead than a gap in time
      feed.body_at(body, feed.stamp(k) + (damaged ? 0.9 : 0.0), body < 0 ? 0 : std::min(k, 60));
    }
  }
  for (const std::string ring : {"ring_1", "ring_2", "ring_3"})
    EXPECT_EQ(count(assembler.rejected(), "frozen " + ring), 0u) << ring;
  EXPECT_EQ(assembler.take().back().bodies.size(), 3u);
}

/// What is driven on while its tracker repeats itself is frozen, whatever the clock of the input.
TEST(FrameAssemblerFrozen, ALoneRingWhoseInputGoesOnIsFrozen) {
  arm::Arm arm = three_ring_arm();
  arm.bodies.erase(arm.bodies.begin(), arm.bodies.begin() + 2);
  for (double ahead_s : {0.0, 0.05, 5.0}) {
    trial::FrameAssembler assembler(arm, without_waiting());
    Feeder feed(assembler);
    for (int k = 0; k < 480; ++k) {
      assembler.add_input(0, feed.stamp(k) + ahead_s, 1.2e5 + k);
      feed.body_at(-1, feed.stamp(k), 0);
      feed.body_at(0, feed.stamp(k), std::min(k, 60));
    }
    EXPECT_GT(count(assembler.rejected(), "frozen ring_3"), 300u) << ahead_s;
  }
}

TEST(FrameAssemblerJump, ShortJumpIsDroppedAndARealMoveFollowed) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  const auto add = [&](int body, int k, double offset) {
    assembler.add_body(body, feed.stamp(k), feed.position(body, k) + Eigen::Vector3d(offset, 0, 0),
                       Eigen::Quaterniond::Identity());
  };
  for (int k = 0; k < 480; ++k) {
    for (int body = -1; body < 3; ++body) {
      double offset = 0.0;
      if (body == 2 && k >= 100 && k < 105) offset = 0.3;    // a ghost for 20 ms
      if (body == 1 && k % 2 == 1 && k < 300) offset = 0.2;  // labels exchanged in every other frame
      if (body == 0 && k >= 240) offset = -0.15;             // put elsewhere for good
      add(body, k, offset);
    }
  }
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 480u);
  EXPECT_EQ(count(assembler.rejected(), "jump ring_3"), 5u);
  EXPECT_EQ(count(assembler.rejected(), "jump ring_2"), 150u);
  for (int k = 0; k < 480; ++k) EXPECT_EQ(has_body(frames[k], 2), k < 100 || k >= 105) << k;
  EXPECT_FALSE(has_body(frames[241], 0));
  EXPECT_TRUE(has_body(frames[260], 0));
  // Followed as soon as it could have moved there at the greatest speed: 0.15 m at 5 m/s are 7 frames.
  EXPECT_EQ(count(assembler.rejected(), "jump ring_1"), 6u);
}

TEST(FrameAssemblerJump, OrientationThatFlipsIsAJumpWhereItIsNeeded) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  const Eigen::Quaterniond flipped(0, 1, 0, 0);
  for (int k = 0; k < 100; ++k) {
    for (int body = -1; body < 3; ++body) {
      const bool flip = body > 0 && k == 50;
      assembler.add_body(body, feed.stamp(k), feed.position(body, k),
                         flip ? flipped : Eigen::Quaterniond::Identity());
    }
  }
  EXPECT_EQ(count(assembler.rejected(), "jump ring_3"), 1u);
  EXPECT_EQ(assembler.rejected().size(), 1u);
}

TEST(FrameAssemblerTime, LoopOfABagIsOneJump) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  assembler.add_payload(feed.stamp(0), 0.2);
  std::size_t frames = 0;
  int jumps = 0;
  for (int loop = 0; loop < 3; ++loop) {
    for (int k = 0; k < 480; ++k) {
      for (int body = -1; body < 3; ++body) feed.body(body, k);
      for (const trial::Frame& frame : assembler.take()) {
        ++frames;
        ASSERT_TRUE(frame.payload_kg);  // a latched payload is not sent again
        EXPECT_EQ(*frame.payload_kg, 0.2);
      }
      jumps += assembler.take_time_jump();
    }
  }
  EXPECT_EQ(jumps, 2);
  EXPECT_EQ(assembler.time_jumps(), 2u);
  EXPECT_GE(frames, 3u * 480u - 4u);
}

/// Who fetches frames now and then, with a jump in between, must reset between the right two of them.
TEST(FrameAssemblerTime, FramesOfBeforeAJumpAreFetchedBeforeIt) {
  for (bool when_taken : {false, true}) {
    for (bool apart : {false, true}) {
      trial::FrameAssembler::Params params = without_waiting();
      params.close_when_taken = when_taken;
      trial::FrameAssembler assembler(three_ring_arm(), params);
      Feeder feed(assembler);
      feed.frames(0, 480);
      EXPECT_TRUE(assembler.take_before_jump().empty());
      feed.frames(0, 240);
      const auto before = apart ? assembler.take_before_jump() : std::vector<trial::Frame>();
      EXPECT_TRUE(assembler.take_time_jump());
      const auto frames = assembler.take();
      if (!apart) {
        ASSERT_GE(frames.size(), 479u + 238u);
        EXPECT_EQ(frames.front().stamp_ns, trial::to_nanoseconds(feed.stamp(0)));
        continue;
      }
      ASSERT_GE(before.size(), 479u);
      ASSERT_GE(frames.size(), 238u);
      EXPECT_EQ(before.front().stamp_ns, trial::to_nanoseconds(feed.stamp(0)));
      EXPECT_GE(before.back().stamp_s(), feed.stamp(478) - 1e-9);
      EXPECT_LE(frames.front().stamp_s(), feed.stamp(2) + 1e-9);
      EXPECT_NEAR(frames.back().stamp_s(), feed.stamp(239), 1e-9);
      EXPECT_TRUE(assembler.take().empty());
    }
  }
}

TEST(FrameAssemblerTime, LeftoversOfTheOldTimeAreNotANewTime) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 480);
  for (int k = 480; k < 485; ++k) feed.body(0, k);  // this topic is ahead of the others when the bag ends ...
  for (int k = 0; k < 5; ++k) feed.body(0, k);      // ... and first in the next round
  for (int k = 480; k < 485; ++k) {
    for (int body : {-1, 1, 2}) feed.body(body, k);
  }
  for (int k = 0; k < 5; ++k) {
    for (int body : {-1, 1, 2}) feed.body(body, k);
  }
  feed.frames(5, 240);
  EXPECT_EQ(assembler.time_jumps(), 1u);
  EXPECT_TRUE(assembler.take_time_jump());
  EXPECT_FALSE(assembler.take_time_jump());
  const auto frames = assembler.take();
  EXPECT_EQ(frames.back().bodies.size(), 3u);
  EXPECT_NEAR(frames.back().stamp_s(), feed.stamp(239), 1e-9);
  EXPECT_GE(frames.size(), 480u + 235u);
}

TEST(FrameAssemblerTime, LoneDamagedStampsAndLaggingClocksAreNoJump) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 480; ++k) {
    for (int body = -1; body < 3; ++body) {
      double shift = 0.0;
      if (body == 1 && k == 100) shift = 1e6;
      if (body == 1 && k == 200) shift = -500.0;
      if (body == 0) shift = -5.0;  // the clock of this one lags
      feed.body_at(body, feed.stamp(k) + shift, k);
    }
  }
  EXPECT_EQ(assembler.time_jumps(), 0u);
  EXPECT_EQ(count(assembler.rejected(), "time_gap ring_2"), 1u);
  EXPECT_EQ(count(assembler.rejected(), "time_jump ring_2"), 1u);
  EXPECT_GT(count(assembler.rejected(), "late ring_1"), 400u);
  EXPECT_GE(assembler.take().size(), 479u);
}

/// Two bodies are lost, each with a damaged stamp. Only soon after one another are they a new time.
TEST(FrameAssemblerTime, AStepBackIsForgottenWhereTimeGoesOn) {
  for (int second : {200, 400}) {
    trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
    Feeder feed(assembler);
    for (int k = 0; k < 480; ++k) {
      feed.body(-1, k);
      feed.body(0, k);
      if (k <= 100) feed.body_at(1, feed.stamp(k) - (k == 100 ? 500.0 : 0.0), k);
      if (k <= second) feed.body_at(2, feed.stamp(k) - (k == second ? 500.0 : 0.0), k);
    }
    EXPECT_EQ(assembler.time_jumps(), second == 200 ? 1u : 0u);
    EXPECT_EQ(count(assembler.rejected(), "time_jump ring_2"), 1u);
    if (second == 400) {
      EXPECT_EQ(count(assembler.rejected(), "time_jump ring_3"), 1u);
      EXPECT_EQ(assembler.take().size(), 480u);
    }
  }
}

/// Sends all bodies in one message.
void one_message(trial::FrameAssembler& assembler, Feeder& feed, double stamp_s, int k) {
  assembler.begin_message("/tf", "all");
  for (int body = -1; body < 3; ++body) feed.body_at(body, stamp_s, k);
}

TEST(FrameAssemblerTime, AMessageOfSeveralBodiesDoesNotConfirmItself) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 480; ++k) {
    const double shift = k == 100 ? 1e6 : k == 200 ? -500.0 : 0.0;
    one_message(assembler, feed, feed.stamp(k) + shift, k);
  }
  EXPECT_EQ(assembler.time_jumps(), 0u);
  for (const std::string body : {"base", "ring_1", "ring_2", "ring_3"}) {
    EXPECT_EQ(count(assembler.rejected(), "time_gap " + body), 1u);
    EXPECT_EQ(count(assembler.rejected(), "time_jump " + body), 1u);
  }
  EXPECT_EQ(assembler.take().size(), 478u);
}

TEST(FrameAssemblerTime, TwoMessagesThatAgreeAreANewTime) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  for (int k = 0; k < 240; ++k) one_message(assembler, feed, feed.stamp(k) + (k < 120 ? 0.0 : 3600.0), k);
  EXPECT_EQ(assembler.time_jumps(), 0u);
  for (int k = 240; k < 480; ++k) one_message(assembler, feed, feed.stamp(k), k);
  EXPECT_EQ(assembler.time_jumps(), 1u);
  EXPECT_EQ(assembler.take().size(), 480u - 2u);  // the first message of each new time
}

TEST(FrameAssemblerTime, TwoReadersOfAMessageDoNotConfirmOneAnotherButTwoTopicsDo) {
  for (const std::string base_topic : {"/tf", "/base"}) {
    trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
    Feeder feed(assembler);
    for (int k = 0; k < 240; ++k) {
      const double stamp_s = feed.stamp(k) - (k == 100 ? 500.0 : 0.0);
      assembler.begin_message(base_topic, "base");
      feed.body_at(-1, stamp_s, k);
      assembler.begin_message("/tf", "rings");
      for (int body = 0; body < 3; ++body) feed.body_at(body, stamp_s, k);
    }
    EXPECT_EQ(assembler.time_jumps(), base_topic == "/tf" ? 0u : 1u);
  }
}

TEST(FrameAssemblerTime, MessagesThatComeRarelyAreFollowed) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  const auto rarely = [](int k) { return 4000.0 + 2.0 * k; };
  for (int k = 0; k < 20; ++k) one_message(assembler, feed, rarely(k), k);
  EXPECT_EQ(assembler.take().size(), 19u);  // the second may have been damaged: two make a pace
  one_message(assembler, feed, rarely(20) + 1e6, 20);
  for (int k = 21; k < 40; ++k) one_message(assembler, feed, rarely(k), k);
  EXPECT_EQ(assembler.take().size(), 19u);
  EXPECT_EQ(assembler.time_jumps(), 0u);
  for (int k = 0; k < 20; ++k) one_message(assembler, feed, rarely(k) - 3600.0, k);
  EXPECT_EQ(assembler.time_jumps(), 1u);
  EXPECT_EQ(assembler.take().size(), 19u);
  EXPECT_EQ(count(assembler.rejected(), "time_gap base"), 2u);
}

TEST(FrameAssemblerTime, WhoMakesBodiesOfPointsCanAskFirst) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  EXPECT_FALSE(assembler.is_alone_in_time(feed.stamp(0)));
  for (int k = 0; k < 10; ++k) one_message(assembler, feed, feed.stamp(k), k);
  EXPECT_FALSE(assembler.is_alone_in_time(feed.stamp(10)));
  for (double shift : {1e6, -500.0}) {
    EXPECT_TRUE(assembler.is_alone_in_time(feed.stamp(10) + shift));
    one_message(assembler, feed, feed.stamp(10) + shift, 10);
    EXPECT_TRUE(assembler.is_alone_in_time(feed.stamp(10) + shift));  // it is the same message
    assembler.begin_message("/tf", "all");
    EXPECT_FALSE(assembler.is_alone_in_time(feed.stamp(11) + shift));
    one_message(assembler, feed, feed.stamp(10), 10);
  }
}

TEST(FrameAssemblerTime, PauseIsFollowed) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 100);
  feed.frames(2500, 2600);
  EXPECT_EQ(assembler.time_jumps(), 0u);
  const auto frames = assembler.take();
  EXPECT_GE(frames.size(), 199u);
  EXPECT_EQ(frames.back().bodies.size(), 3u);
}

TEST(FrameAssemblerInputs, NewestAtOrBeforeTheFrameHolds) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 1);  // before any pressure
  assembler.add_input(0, feed.stamp(0.5), 101325.0 + 2e4);
  assembler.add_input(1, feed.stamp(0.5), 101325.0 - 6e4);
  assembler.add_input(0, feed.stamp(2.5), 101325.0 + 3e4);  // newer than the frame to come
  feed.frames(1, 4);
  feed.frames(240, 241);  // no pressure for a second
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 5u);
  ASSERT_EQ(frames[0].inputs.size(), 2u);
  EXPECT_FALSE(frames[0].inputs[0]);
  EXPECT_NEAR(frames[1].inputs[0].value(), 2e4, 1e-6);
  EXPECT_NEAR(frames[1].inputs[1].value(), 6e4, 1e-6);  // vacuum below ambient
  EXPECT_NEAR(frames[3].inputs[0].value(), 3e4, 1e-6);
  EXPECT_FALSE(frames[4].inputs[0]);
  assembler.add_input(0, feed.stamp(241), std::numeric_limits<double>::quiet_NaN());
  assembler.add_input(0, 0.0, 1e5);
  EXPECT_EQ(count(assembler.rejected(), "input_nan chamber_1"), 1u);
  EXPECT_EQ(count(assembler.rejected(), "bad_stamp chamber_1"), 1u);
}

TEST(FrameAssemblerInputs, GaugeInputsAreUsedAsTheyAre) {
  arm::Arm arm = three_ring_arm();
  for (arm::ScalarInput& input : arm.inputs.scalars) input.reference = arm::PressureReference::kGauge;
  trial::FrameAssembler assembler(arm, without_waiting());
  Feeder feed(assembler);
  assembler.add_input(0, feed.stamp(0), 2e4);
  assembler.add_input(1, feed.stamp(0), -6e4);
  feed.frames(1, 2);
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].inputs[0].value(), 2e4, 1e-6);
  EXPECT_NEAR(frames[0].inputs[1].value(), 6e4, 1e-6);
}

TEST(FrameAssemblerPayload, HoldsFromItsStampAndRejectsNonsense) {
  trial::FrameAssembler assembler(three_ring_arm(), without_waiting());
  Feeder feed(assembler);
  feed.frames(0, 2);
  assembler.add_payload(feed.stamp(1.5), 0.2);
  feed.frames(2, 4);
  assembler.add_payload(feed.stamp(3.5), std::nullopt);
  feed.frames(4, 5);
  assembler.add_payload(feed.stamp(4.5), -1.0);
  assembler.add_payload(feed.stamp(4.5), std::numeric_limits<double>::quiet_NaN());
  assembler.add_payload(0.0, 0.1);  // before any clock: it has always held
  feed.frames(5, 6);
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_FALSE(frames[1].payload_kg);
  EXPECT_EQ(frames[2].payload_kg.value(), 0.2);
  EXPECT_FALSE(frames[4].payload_kg);
  EXPECT_EQ(frames[5].payload_kg.value(), 0.1);
  EXPECT_EQ(count(assembler.rejected(), "payload_out_of_range payload"), 1u);
  EXPECT_EQ(count(assembler.rejected(), "payload_nan payload"), 1u);
}

}  // namespace
}  // namespace softarm
