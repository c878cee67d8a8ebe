// What held at a frame's stamp does not depend on the order in which messages of one instant arrive.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "trial/frame_assembler.h"

namespace softarm {
namespace {

arm::Arm one_ring_arm() {
  arm::Arm arm;
  arm::Segment segment;
  segment.length_m = 0.2;
  arm.segments.push_back(segment);
  arm::MeasuredBody ring;
  ring.name = "ring_1";
  ring.arclength_m = 0.2;
  arm.bodies.push_back(ring);
  arm::ScalarInput pressure;
  pressure.name = "chamber_1";
  arm.inputs.scalars.push_back(pressure);
  return arm;
}

std::vector<std::optional<double>> pressures(bool pressure_first) {
  const arm::Arm arm = one_ring_arm();
  trial::FrameAssembler assembler(arm);
  std::vector<std::optional<double>> values;
  for (int i = 0; i < 20; ++i) {
    const double stamp_s = 100.0 + 0.01 * i;
    const auto add_pressure = [&] {
      assembler.add_input(0, stamp_s, arm.inputs.ambient_pressure_pa + 1000.0 * i);
    };
    if (pressure_first) add_pressure();
    assembler.add_body(0, stamp_s, {0.01 * i, 0.001 * i, 0.2}, std::nullopt);
    if (!pressure_first) add_pressure();
    for (const trial::Frame& frame : assembler.take()) values.push_back(frame.inputs.at(0));
  }
  assembler.flush();
  for (const trial::Frame& frame : assembler.take()) values.push_back(frame.inputs.at(0));
  return values;
}

TEST(FrameInputs, AreTheSameWhateverArrivesFirst) {
  const auto first = pressures(true), last = pressures(false);
  ASSERT_EQ(first.size(), 20u);
  ASSERT_EQ(last.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_TRUE(first[i].has_value() && last[i].has_value()) << i;
    EXPECT_NEAR(*first[i], 1000.0 * static_cast<double>(i), 1e-6) << i;  // that of its own stamp
    EXPECT_EQ(*first[i], *last[i]) << i;
  }
}

// ... what has arrived and what is still due: frames wait for inputs as long as that makes sense.

/// Pressures of all frames, and how long they waited.
struct Waiting {
  std::vector<std::optional<double>> pressures;
  double longest_s = 0.0;  // of the frames after the first second, in which rhythms are learned
  std::uint64_t frames_that_waited = 0;
  std::map<std::string, std::uint64_t> in_vain;
};

struct Message {
  double arrival_s;
  bool pressure;
  double stamp_s, value;
};

Waiting run(const std::vector<Message>& sorted, bool when_taken = false, std::size_t batch = 1) {
  const arm::Arm arm = one_ring_arm();
  trial::FrameAssembler::Params params;
  params.close_when_taken = when_taken;
  trial::FrameAssembler assembler(arm, params);
  Waiting result;
  const auto take = [&](double now_s) {
    for (const trial::Frame& frame : assembler.take()) {
      result.pressures.push_back(frame.inputs.at(0));
      const std::int64_t waited_ns = trial::to_nanoseconds(now_s) - frame.stamp_ns;
      if (frame.stamp_s() > 101.0)
        result.longest_s = std::max(result.longest_s, 1e-9 * static_cast<double>(waited_ns));
    }
  };
  std::size_t added = 0;
  for (const Message& m : sorted) {
    if (m.pressure) {
      assembler.add_input(0, m.stamp_s, arm.inputs.ambient_pressure_pa + m.value);
    } else {
      assembler.add_body(0, m.stamp_s, {0.001 * m.value, 0.0, 0.2}, std::nullopt);
    }
    if (++added % batch == 0) take(m.arrival_s);
  }
  result.frames_that_waited = assembler.frames_that_waited();
  result.in_vain = assembler.waited_in_vain();
  assembler.flush();
  take(0.0);
  return result;
}

/// Bodies of 120 Hz and pressures of another rate that arrive `delay_s` after their stamps, by arrival.
std::vector<Message> stream(double pressure_step_s, double pressure_offset_s, double delay_s,
                            double silent_from_s = 1e9, double silent_to_s = 1e9) {
  std::vector<Message> messages;
  for (int k = 0; k < 480; ++k) {
    const double stamp_s = 100.0 + k / 120.0;
    messages.push_back({stamp_s, false, stamp_s, static_cast<double>(k)});
  }
  for (int k = 0; 100.0 + k * pressure_step_s < 104.0; ++k) {
    const double stamp_s = 100.0 + k * pressure_step_s + pressure_offset_s;
    if (stamp_s > silent_from_s && stamp_s < silent_to_s) continue;
    messages.push_back({stamp_s + delay_s, true, stamp_s, 10.0 * k});
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.arrival_s < b.arrival_s; });
  return messages;
}

TEST(FrameInputs, OneThatIsLateIsWaitedForSoThatItsArrivalDoesNotMatter) {
  for (double step_s : {1.0 / 120.0, 0.01, 0.02, 0.1, 0.0031}) {
    const Waiting prompt = run(stream(step_s, -0.002, 0.0));
    for (double delay_s : {0.001, 0.003, 0.008, 0.03}) {
      const Waiting late = run(stream(step_s, -0.002, delay_s));
      ASSERT_EQ(late.pressures.size(), prompt.pressures.size());
      for (std::size_t i = 0; i < prompt.pressures.size(); ++i)
        EXPECT_EQ(late.pressures[i], prompt.pressures[i]) << i << " " << step_s << " " << delay_s;
      EXPECT_LE(late.longest_s, delay_s + 1.0 / 120.0 + 1e-6);
      EXPECT_TRUE(late.in_vain.empty());
    }
  }
}

TEST(FrameInputs, OneOfTheFramesOwnStampIsWaitedFor) {
  for (double step_s : {1.0 / 120.0, 1.0 / 60.0, 1.0 / 12.0, 1.0 / 1200.0}) {
    const Waiting prompt = run(stream(step_s, 0.0, -1e-4));  // before the bodies
    const int steps = static_cast<int>(std::lround(120.0 * step_s));
    ASSERT_EQ(prompt.pressures.size(), 480u);
    for (std::size_t i = 0; i < 479; ++i) {
      const double newest =
          steps > 0 ? std::floor(static_cast<double>(i) / steps) : 10.0 * static_cast<double>(i);
      EXPECT_NEAR(*prompt.pressures[i], 10.0 * newest, 1e-6) << i << " " << step_s;
    }
    for (double delay_s : {1e-4, 0.002, 0.03}) {
      const Waiting late = run(stream(step_s, 0.0, delay_s));
      for (std::size_t i = 0; i < 479; ++i)
        EXPECT_EQ(late.pressures[i], prompt.pressures[i]) << i << " " << step_s << " " << delay_s;
      EXPECT_LE(late.longest_s, delay_s + 1.0 / 120.0 + 1e-6);
      EXPECT_TRUE(late.in_vain.empty());
    }
  }
}

TEST(FrameInputs, APayloadOfTheFramesOwnStampCountsForIt) {
  const arm::Arm arm = one_ring_arm();
  trial::FrameAssembler::Params params;
  params.close_when_taken = true;  // all messages of one instant are there before frames are taken
  for (bool payload_first : {true, false}) {
    trial::FrameAssembler assembler(arm, params);
    std::vector<double> payloads;
    for (int k = 0; k < 50; ++k) {
      const double stamp_s = 100.0 + 0.04 * k;
      if (payload_first) assembler.add_payload(stamp_s, 0.001 * k);
      assembler.add_input(0, stamp_s, 2e5);
      assembler.add_body(0, stamp_s, {0.001 * (k % 9), 0.0, 0.2}, std::nullopt);
      if (!payload_first) assembler.add_payload(stamp_s, 0.001 * k);
      for (const trial::Frame& frame : assembler.take()) payloads.push_back(frame.payload_kg.value());
    }
    ASSERT_EQ(payloads.size(), 50u);
    for (std::size_t k = 0; k < 50; ++k) EXPECT_DOUBLE_EQ(payloads[k], 0.001 * static_cast<double>(k));
  }
}

TEST(FrameInputs, SamplesGoWithTheFirstFrameAtOrAfterThemEachOnce) {
  const arm::Arm arm = one_ring_arm();
  trial::FrameAssembler assembler(arm);
  std::vector<trial::InputSample> samples;
  const auto take = [&] {
    for (const trial::Frame& frame : assembler.take()) {
      for (const trial::InputSample& sample : frame.samples) {
        EXPECT_LE(1e-9 * static_cast<double>(sample.stamp_ns), frame.stamp_s() + 1e-6);
        samples.push_back(sample);
      }
      if (frame.samples.empty()) continue;
      EXPECT_EQ(frame.samples.back().value, frame.inputs[0]);
    }
  };
  for (const Message& m : stream(0.0031, 0.0, 0.002)) {
    if (m.pressure) {
      assembler.add_input(0, m.stamp_s, arm.inputs.ambient_pressure_pa + m.value);
    } else {
      assembler.add_body(0, m.stamp_s, {0.001 * m.value, 0.0, 0.2}, std::nullopt);
    }
    take();
  }
  assembler.flush();
  take();
  for (const trial::InputSample& sample : assembler.take_samples()) samples.push_back(sample);
  ASSERT_EQ(samples.size(), 1291u);
  for (std::size_t k = 0; k < samples.size(); ++k)
    EXPECT_NEAR(1e-9 * static_cast<double>(samples[k].stamp_ns), 100.0 + 0.0031 * static_cast<double>(k),
                1e-7);
}

TEST(FrameInputs, OneThatIsOnTimeDelaysNothing) {
  const Waiting at_once = run(stream(1.0 / 120.0, -0.002, 0.0));
  EXPECT_EQ(at_once.longest_s, 0.0);
  EXPECT_LE(at_once.frames_that_waited, 2u);
  const Waiting slow = run(stream(0.1, -0.002, 0.0));
  EXPECT_LE(slow.frames_that_waited, 30u);  // until its rhythm is known
}

TEST(FrameInputs, OneThatFallsSilentIsWaitedForOnce) {
  const Waiting silent = run(stream(0.01, -0.002, 0.0, 101.0, 103.0));
  EXPECT_EQ(silent.pressures.size(), 480u);
  EXPECT_EQ(silent.in_vain.at("chamber_1"), 1u);
  EXPECT_LE(silent.longest_s, 0.25 + 2.0 / 120.0);
  EXPECT_LT(silent.frames_that_waited, 36u);
  const Waiting never = run(stream(0.01, -0.002, 0.0, 0.0, 1e9));
  EXPECT_EQ(never.in_vain.at("chamber_1"), 1u);
  EXPECT_LT(never.frames_that_waited, 36u);
}

TEST(FrameInputs, OneThatIsAlwaysTooLateIsNotWaitedForAgain) {
  const Waiting late = run(stream(0.01, -0.002, 0.4));
  EXPECT_LE(late.in_vain.at("chamber_1"), 2u);
  EXPECT_LT(late.frames_that_waited, 60u);
}

TEST(FrameInputs, OneThatComesWhenItPleasesIsNotWaitedFor) {
  std::vector<Message> messages = stream(0.01, 0.0, 0.0, 0.0, 1e9);
  std::mt19937 random(1);
  std::exponential_distribution<double> gap(5.0);
  for (double t = 100.0; t < 104.0; t += gap(random)) messages.push_back({t, true, t, 1e3 * t});
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.arrival_s < b.arrival_s; });
  const Waiting result = run(messages);
  EXPECT_LT(result.frames_that_waited, 120u);  // while it has not shown what it is
}

TEST(FrameInputs, MessagesInBatchesGiveTheFramesOfMessagesOneByOne) {
  // After a hiccup the topics' queues are read one after the other: bodies first, then what drives them.
  const Waiting one_by_one = run(stream(0.02, -0.002, 0.0));
  std::vector<Message> reordered = stream(0.02, -0.002, 0.0);
  constexpr std::size_t kBatch = 60;
  for (std::size_t i = 0; i + kBatch <= reordered.size(); i += kBatch) {
    const auto begin = reordered.begin() + static_cast<std::ptrdiff_t>(i);
    std::stable_partition(begin, begin + kBatch, [](const Message& m) { return !m.pressure; });
  }
  const Waiting batches = run(reordered, true, kBatch);
  EXPECT_EQ(batches.pressures, one_by_one.pressures);
}

TEST(FrameInputs, LatenciesAreSubtracted) {
  arm::Arm arm = one_ring_arm();
  arm.inputs.body_latency_s = 0.02;
  arm.inputs.scalars[0].latency_s = -0.005;
  trial::FrameAssembler assembler(arm);
  assembler.add_input(0, 99.97, arm.inputs.ambient_pressure_pa + 1.0);  // meant 99.975
  assembler.add_input(0, 99.98, arm.inputs.ambient_pressure_pa + 2.0);  // meant 99.985
  assembler.add_body(0, 100.0, {0.0, 0.0, 0.2}, std::nullopt);          // was there at 99.98
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].stamp_s(), 99.98, 1e-9);
  EXPECT_NEAR(frames[0].inputs[0].value(), 1.0, 1e-9);
}

TEST(FrameInputs, StampsOfADateKeepTheirNanoseconds) {
  arm::Arm arm = one_ring_arm();
  arm.inputs.body_latency_s = 0.002;
  arm.inputs.scalars[0].latency_s = 0.001;
  trial::FrameAssembler assembler(arm);
  constexpr std::int64_t kDate_ns = 1'700'000'000'123'456'789;
  assembler.add_input(0, trial::Stamp::from_ns(kDate_ns - 3'000'000), arm.inputs.ambient_pressure_pa + 1.0);
  assembler.add_body(0, trial::Stamp::from_ns(kDate_ns), {0.0, 0.0, 0.2}, std::nullopt);
  assembler.flush();
  const auto frames = assembler.take();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].stamp_ns, kDate_ns - 2'000'000);
  ASSERT_EQ(frames[0].samples.size(), 1u);
  EXPECT_EQ(frames[0].samples[0].stamp_ns, kDate_ns - 4'000'000);
  EXPECT_EQ(trial::to_seconds(1'500'000'000), 1.5);
  EXPECT_EQ(trial::to_seconds(-1'500'000'000), -1.5);
  EXPECT_EQ(trial::to_nanoseconds(-0.25), -250'000'000);
  EXPECT_EQ(trial::Stamp(1.6e9).later(0.123456789).ns, 1'600'000'000'123'456'789);
  EXPECT_FALSE(std::isfinite(trial::Stamp(std::numeric_limits<double>::quiet_NaN()).s));
  EXPECT_FALSE(std::isfinite(trial::Stamp(1e13).s));
}

TEST(FrameInputs, ABodyThatTheDriverDoesNotSeeIsNotWaitedFor) {
  arm::Arm arm = one_ring_arm();
  arm::MeasuredBody second = arm.bodies[0];
  second.name = "ring_2";
  arm.bodies.push_back(second);
  trial::FrameAssembler::Params params;
  params.input_wait_s = 0.0;
  trial::FrameAssembler assembler(arm, params);
  for (int k = 0; k < 10; ++k) {
    assembler.add_body(0, 100.0 + 0.01 * k, {0.01 * k, 0.0, 0.2}, std::nullopt);
    assembler.add_missing_body(1, 100.0 + 0.01 * k, "occluded");
    EXPECT_EQ(assembler.take().size(), 1u);
  }
  EXPECT_EQ(assembler.rejected().at("occluded ring_2"), 10u);
  assembler.count_rejected("ghost", "mocap", 3);
  EXPECT_EQ(assembler.rejected().at("ghost mocap"), 3u);
}

TEST(FrameInputs, ALoneBodyThatFreezesWhileItIsDrivenIsFound) {
  for (bool driven : {true, false}) {
    const arm::Arm arm = one_ring_arm();
    trial::FrameAssembler assembler(arm);
    for (int k = 0; k < 240; ++k) {
      const double stamp_s = 100.0 + k / 120.0;
      assembler.add_input(0, stamp_s - 0.002, arm.inputs.ambient_pressure_pa + (driven ? 10.0 * k : 0.0));
      assembler.add_body(0, stamp_s, {0.001 * std::min(k, 60), 0.0, 0.2}, std::nullopt);
    }
    assembler.flush();
    const std::uint64_t frozen = driven ? assembler.rejected().at("frozen ring_1") : 0;
    EXPECT_EQ(frozen > 100, driven);
    EXPECT_EQ(assembler.rejected().empty(), !driven);
  }
}

}  // namespace
}  // namespace softarm
