// Stamps, receipt, gaps and duplicates.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/hidden_sensors.h"

namespace softarm::rig {
namespace {

TEST(HiddenSensorsTiming, WithoutFaultsEverythingIsReceivedAtItsStamp) {
  const std::vector<Sample> samples = samples_of(quiet(3.0));
  double last_s = 0.0;
  for (const Received& one : received_of(samples)) {
    EXPECT_GE(one.receipt_s, last_s);
    last_s = one.receipt_s;
    std::visit([&](const auto& message) { EXPECT_EQ(message.stamp_s, one.receipt_s); }, one.message);
  }
  for (const Sample& sample : samples) EXPECT_EQ(sample.mocap_stamp_s, sample.stamp_s);
}

TEST(HiddenSensorsTiming, TheMocapClockIsAheadAndDrifts) {
  Scenario s = quiet(5.0);
  hide("clock_offset", {{"offset_s", -0.08}, {"drift_ppm", 40.0}}, s);
  for (const Sample& sample : samples_of(s)) {
    EXPECT_NEAR(sample.mocap_stamp_s - sample.stamp_s, -0.08 + 40e-6 * sample.stamp_s, 1e-12);
    EXPECT_EQ(sample.mocap_receipt_s, sample.stamp_s);  // by the clock of the inputs
    for (const InputSample& input : sample.inputs) EXPECT_EQ(input.receipt_s, input.stamp_s);
  }
}

TEST(HiddenSensorsTiming, TheMocapClockGetsAheadOverTheWholeSession) {
  Scenario s = quiet(3.0);
  hide("clock_drift", {{"drift_ppm", -500.0}}, s);
  s.session_s = 200.0;
  for (const Sample& sample : samples_of(s)) {
    EXPECT_NEAR(sample.mocap_stamp_s - sample.stamp_s, -500e-6 * (200.0 + sample.stamp_s), 1e-12);
    EXPECT_EQ(sample.mocap_receipt_s, sample.stamp_s);
    for (const InputSample& input : sample.inputs) EXPECT_EQ(input.receipt_s, input.stamp_s);
  }
}

TEST(HiddenSensorsTiming, TheClockOfOneInputIsAhead) {
  Scenario s = quiet(2.0);
  hide("input_clock", {{"number", 2}, {"offset_s", 0.05}}, s, "pressure");
  std::size_t ahead = 0;
  for (const Sample& sample : samples_of(s)) {
    EXPECT_EQ(sample.mocap_stamp_s, sample.stamp_s);
    for (const InputSample& input : sample.inputs) {
      const bool it = input.kind == InputKind::kChamber && input.number == 1;
      EXPECT_NEAR(input.stamp_s - input.receipt_s, it ? 0.05 : 0.0, 1e-12);
      ahead += it;
    }
  }
  EXPECT_GT(ahead, 50u);
}

TEST(HiddenSensorsTiming, LatencyDelaysReceiptAloneAndKeepsTheOrder) {
  Scenario s = resting(200.0);
  s.mocap.rate_hz = 50.0;
  s.numerics.max_step_s = 0.05;
  hide("latency", {{"delay_s", 0.03}, {"jitter_s", 0.004}}, s, "mocap");
  hide("latency", {{"delay_s", 0.1}}, s, "inputs");
  double sum = 0.0, last_s = -1.0;
  std::size_t inputs = 0;
  const std::vector<Sample> samples = samples_of(s);
  for (const Sample& sample : samples) {
    EXPECT_EQ(sample.mocap_stamp_s, sample.stamp_s);
    const double delay_s = sample.mocap_receipt_s - sample.stamp_s;
    EXPECT_GE(delay_s, 0.03 - 1e-12);
    EXPECT_GE(sample.mocap_receipt_s, last_s);
    last_s = sample.mocap_receipt_s;
    sum += delay_s - 0.03;
    for (const InputSample& input : sample.inputs) {
      EXPECT_NEAR(input.receipt_s - input.stamp_s, 0.1, 1e-12);
      ++inputs;
    }
  }
  EXPECT_GT(inputs, 1000u);
  // Exponential: the standard deviation is the mean. Queueing behind a late one adds a little.
  const double n = static_cast<double>(samples.size());
  EXPECT_NEAR(sum / n, 0.004, 4.0 * 0.004 / std::sqrt(n) + 2e-5);

  // In the bag and on the wire: by receipt, every message once.
  std::size_t messages = 0, poses = 0;
  double before_s = -1.0;
  for (const Received& one : received_of(samples)) {
    EXPECT_GE(one.receipt_s, before_s);
    before_s = one.receipt_s;
    ++messages;
    if (std::holds_alternative<PoseSample>(one.message)) ++poses;
  }
  EXPECT_EQ(poses, 4 * samples.size());
  EXPECT_EQ(messages, poses + inputs + 1);  // one payload
}

TEST(HiddenSensorsTiming, NothingReceivedLaterCanOvertakeWhatTheQueueGave) {
  Scenario s = quiet(2.0);
  hide("latency", {{"delay_s", 0.015}, {"jitter_s", 0.02}}, s, "mocap");
  ReceiptQueue queue;
  double last_s = -1.0;
  Simulator simulator(s);
  while (const std::optional<Sample> sample = simulator.next()) {
    queue.add(*sample);
    while (const std::optional<Received> one = queue.take(sample->stamp_s)) {
      EXPECT_GE(one->receipt_s, last_s);
      EXPECT_LE(one->receipt_s, sample->stamp_s);
      last_s = one->receipt_s;
    }
  }
}

TEST(HiddenSensorsTiming, StampsWanderAndNeverGoBack) {
  for (const char* stream : {"mocap", "inputs"}) {
    Scenario s = resting(100.0);
    s.mocap.rate_hz = 50.0;
    s.numerics.max_step_s = 0.05;
    hide("stamp_jitter", {{"sd_s", 0.002}}, s, stream);
    const bool of_mocap = std::string(stream) == "mocap";
    std::vector<double> stamps, sent;
    std::size_t tick = 0;
    for (const Sample& sample : samples_of(s)) {
      if (of_mocap) {
        stamps.push_back(sample.mocap_stamp_s);
        sent.push_back(sample.stamp_s);
        EXPECT_GE(sample.mocap_receipt_s, sample.mocap_stamp_s);
      } else {
        EXPECT_EQ(sample.mocap_stamp_s, sample.stamp_s);
        for (const InputSample& input : sample.inputs)
          if (input.number == 0) {
            stamps.push_back(input.stamp_s);
            sent.push_back(static_cast<double>(tick++) / 50.0);
          }
      }
    }
    double sum = 0.0, square = 0.0;
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const double error = stamps[k] - sent[k];
      if (k > 0) {
        EXPECT_GT(stamps[k], stamps[k - 1]);
      }
      EXPECT_LE(std::abs(error), 0.006 + 1e-9);
      sum += error;
      square += error * error;
    }
    const double n = static_cast<double>(stamps.size());
    ASSERT_GT(n, 4900.0);
    EXPECT_NEAR(sum / n, 0.0, 5.0 * 0.002 / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(square / n), 0.002, 1e-4);
  }
}

TEST(HiddenSensorsTiming, DuplicatedFramesAreSentTwiceWithTheSameStamp) {
  Scenario s = resting(60.0);
  s.mocap.rate_hz = 50.0;
  s.numerics.max_step_s = 0.05;
  hide("duplicated_frames", {{"probability", 0.1}}, s);
  const std::vector<Sample> samples = samples_of(s);
  std::vector<double> stamps;
  for (const Received& one : received_of(samples))
    if (const auto* pose = std::get_if<PoseSample>(&one.message); pose && pose->body == 1)
      stamps.push_back(pose->stamp_s);
  int twice = 0;
  for (std::size_t k = 1; k < stamps.size(); ++k) twice += stamps[k] == stamps[k - 1];
  EXPECT_EQ(stamps.size(), samples.size() + static_cast<std::size_t>(twice));
  EXPECT_NEAR(twice, 300.0, 4.0 * std::sqrt(270.0));
}

TEST(HiddenSensorsTiming, GapsSilenceOneStream) {
  Scenario s = quiet(6.0);
  hide("gaps", {{"from_s", 1.0}, {"for_s", 0.5}, {"repeat_s", 2.0}}, s, "mocap");
  hide("gaps", {{"from_s", 4.0}, {"for_s", 0.25}}, s, "inputs");
  std::size_t inputs = 0;
  for (const Sample& sample : samples_of(s)) {
    const double t = sample.stamp_s;
    const bool gap = (t >= 1.0 && t < 1.5) || (t >= 3.0 && t < 3.5) || (t >= 5.0 && t < 5.5);
    for (const auto& body : sample.bodies) EXPECT_EQ(!body, gap) << t;
    for (const InputSample& input : sample.inputs) {
      EXPECT_FALSE(input.stamp_s >= 4.0 && input.stamp_s < 4.25);
      ++inputs;
    }
  }
  // 301 ticks of three chambers, of which 4.00 ... 4.24 are missing.
  EXPECT_EQ(inputs, 3u * (301u - 13u));
}

}  // namespace
}  // namespace softarm::rig
