// Inputs by their own stamps: between samples, over gaps, and how a trial gets them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frame_assembler_fixture.h"
#include "softarm/trial/trial.h"
#include "trial/static_frame.h"
#include "trial/trial_recorder.h"

namespace softarm::trial {
namespace {

constexpr double kBegin_s = 1.7e9;

InputSeries series_of(const std::vector<double>& t_s, const std::function<double(double)>& value) {
  InputSeries series;
  for (const double t : t_s) series.add(std::llround(1e9 * (kBegin_s + t)), value(t));
  return series;
}

std::vector<double> steady(double step_s, int count) {
  std::vector<double> t;
  for (int i = 0; i < count; ++i) t.push_back(step_s * i);
  return t;
}

TEST(InputSeries, OfASensorIsStraightBetweenSamples) {
  InputSeries series = series_of(steady(0.04, 50), [](double t) { return 1000.0 * t; });
  series.decide(std::nullopt);
  EXPECT_EQ(series.between, arm::Between::kSampled);
  EXPECT_FALSE(series.at(kBegin_s - 0.001).has_value());
  EXPECT_NEAR(*series.at(kBegin_s), 0.0, 1e-9);
  EXPECT_NEAR(*series.at(kBegin_s + 0.5), 500.0, 1e-3);
  EXPECT_NEAR(*series.at(kBegin_s + 0.513), 513.0, 1e-3);
  EXPECT_NEAR(*series.at(kBegin_s + 10.0), 1960.0, 1e-9);  // after the last
}

TEST(InputSeries, OfACommandIsTheLastOneAtOrBefore) {
  InputSeries series = series_of(steady(0.04, 50), [](double t) { return 1000.0 * t; });
  series.decide(arm::Between::kHeld);
  EXPECT_NEAR(*series.at(kBegin_s + 0.08), 80.0, 1e-9);
  EXPECT_NEAR(*series.at(kBegin_s + 0.119), 80.0, 1e-9);
  EXPECT_NEAR(*series.at(kBegin_s + 0.079), 40.0, 1e-9);
}

TEST(InputSeries, IsHeldOverAGap) {
  std::vector<double> t = steady(0.02, 50);
  for (int i = 0; i < 50; ++i) t.push_back(2.0 + 0.02 * i);
  InputSeries series = series_of(t, [](double at) { return 100.0 * at; });
  series.decide(std::nullopt);
  EXPECT_NEAR(*series.at(kBegin_s + 1.5), 98.0, 1e-9);
  EXPECT_NEAR(*series.at(kBegin_s + 1.999), 98.0, 1e-9);
  EXPECT_NEAR(*series.at(kBegin_s + 2.01), 201.0, 1e-3);
}

TEST(InputSeries, IsWhatItsRhythmSaysUnlessItIsStated) {
  std::mt19937 random(1);
  std::exponential_distribution<double> gap(5.0);
  std::vector<double> on_change{0.0};
  while (on_change.size() < 60) on_change.push_back(on_change.back() + gap(random));
  const auto decided = [](const std::vector<double>& t, std::optional<arm::Between> stated) {
    InputSeries series = series_of(t, [](double at) { return at; });
    series.decide(stated);
    return series.between;
  };
  EXPECT_EQ(decided(on_change, {}), arm::Between::kHeld);
  EXPECT_EQ(decided(on_change, arm::Between::kSampled), arm::Between::kSampled);
  EXPECT_EQ(decided(steady(0.4, 20), {}), arm::Between::kSampled);
  EXPECT_EQ(decided(steady(2.0, 20), {}), arm::Between::kHeld);  // a programme's steps
  EXPECT_EQ(decided({0.0}, {}), arm::Between::kHeld);
  EXPECT_EQ(decided({}, {}), arm::Between::kHeld);
}

TEST(InputSeries, SortsSamplesAndKeepsOnePerStamp) {
  InputSeries series;
  for (const auto& [at_ns, value] : std::vector<std::pair<std::int64_t, double>>{
           {3'000'000'000, 3.0}, {1'000'000'000, 1.0}, {2'000'000'000, 9.0}, {2'000'000'000, 2.0}})
    series.add(at_ns, value);
  EXPECT_EQ(series.stamp_ns, (std::vector<std::int64_t>{1'000'000'000, 2'000'000'000, 3'000'000'000}));
  EXPECT_EQ(series.value, (std::vector<double>{1.0, 2.0, 3.0}));
  series.forget_before(2.5, 5);
  EXPECT_EQ(series.value.size(), 3u);
  series.forget_before(2.5, 0);
  EXPECT_EQ(series.value, (std::vector<double>{2.0, 3.0}));
}

/// A straight arm on a fixed base, its inputs sampled at 30 Hz, its one ring seen at 25 Hz.
class Recorded : public ::testing::Test {
 protected:
  Recorded() : arm_(testing_assembler::three_ring_arm()) {
    arm_.base = {};
    arm_.bodies.resize(1);
    arm_.payload.default_kg = 0.0;
    arm_.inputs.scalars[0].latency_s = 0.01;
    for (arm::ScalarInput& input : arm_.inputs.scalars) input.reference = arm::PressureReference::kGauge;
  }

  void run(FrameAssembler& assembler, double begin_s, int samples = 300) {
    for (int k = 0; k < samples; ++k) {
      const double t_s = k / 30.0;
      assembler.add_input(0, begin_s + t_s + 0.01, 1000.0 * t_s);
      assembler.add_input(1, begin_s + t_s, -2000.0 * t_s);
    }
    for (int k = 0; k < 240; ++k)
      assembler.add_body(0, begin_s + k / 25.0, {0.001 * (k % 7), 0.0, 0.06}, std::nullopt);
    assembler.flush();
  }

  arm::Arm arm_;
};

TEST_F(Recorded, InputsKeepTheirStampsAndServeKnownFrames) {
  FrameAssembler assembler(arm_, testing_assembler::without_waiting());
  run(assembler, 1000.0);
  TrialRecorder recorder(arm_, "one");
  for (Frame& frame : assembler.take()) {
    for (const InputSample& sample : frame.samples) EXPECT_LE(1e-9 * sample.stamp_ns, frame.stamp_s() + 1e-6);
    recorder.add(std::move(frame));
  }
  recorder.add(assembler.take_samples());
  const Trial trial = recorder.take();
  ASSERT_EQ(trial.inputs.size(), 2u);
  ASSERT_EQ(trial.inputs[0].value.size(), 300u);
  for (std::size_t k = 0; k < 300; ++k) {
    const double at_s = 1000.0 + static_cast<double>(k) / 30.0;
    EXPECT_NEAR(1e-9 * static_cast<double>(trial.inputs[0].stamp_ns[k]), at_s, 2e-7);
    EXPECT_NEAR(trial.inputs[1].value[k], 2000.0 * (at_s - 1000.0), 1e-6);
  }
  std::map<std::string, std::uint64_t> left_out;
  const std::vector<StaticFrame> known = known_frames(arm_, 0, trial, left_out);
  ASSERT_EQ(known.size(), 240u);
  for (const StaticFrame& frame : known) {
    EXPECT_NEAR(*frame.inputs[0], 1000.0 * (frame.stamp_s - 1000.0), 1e-2);
    EXPECT_NEAR(*frame.inputs[1], 2000.0 * (frame.stamp_s - 1000.0), 1e-2);
  }
}

TEST_F(Recorded, WhatIsTooOldStaysMissing) {
  FrameAssembler assembler(arm_, testing_assembler::without_waiting());
  run(assembler, 1000.0, 150);
  TrialRecorder recorder(arm_, "one");
  for (Frame& frame : assembler.take()) recorder.add(std::move(frame));
  std::map<std::string, std::uint64_t> left_out;
  const std::vector<StaticFrame> known = known_frames(arm_, 0, recorder.take(), left_out);
  ASSERT_EQ(known.size(), 240u);  // the arm does without inputs
  for (const StaticFrame& frame : known)
    EXPECT_EQ(frame.inputs[0].has_value(), frame.stamp_s < 1005.0 - 1.0 / 30.0 + arm_.inputs.input_max_age_s);
}

/// As where the clocks of bodies and inputs are apart by more than an input may be old.
TEST_F(Recorded, WhatCameTooLateForItsFrameIsKnownByItsStamp) {
  FrameAssembler assembler(arm_, testing_assembler::without_waiting());
  run(assembler, 1000.0);
  TrialRecorder recorder(arm_, "late");
  for (Frame& frame : assembler.take()) recorder.add(std::move(frame));
  recorder.add(assembler.take_samples());
  Trial trial = recorder.take();
  for (Frame& frame : trial.frames) frame.inputs.assign(frame.inputs.size(), std::nullopt);
  constexpr std::size_t kKept = 150;  // of the second input
  trial.inputs[1].stamp_ns.resize(kKept);
  trial.inputs[1].value.resize(kKept);
  std::map<std::string, std::uint64_t> left_out;
  const std::vector<StaticFrame> known = known_frames(arm_, 0, trial, left_out);
  ASSERT_EQ(known.size(), 240u);
  for (const StaticFrame& frame : known) {
    ASSERT_TRUE(frame.inputs[0].has_value()) << frame.stamp_s;
    EXPECT_NEAR(*frame.inputs[0], 1000.0 * (frame.stamp_s - 1000.0), 1e-2);
    EXPECT_EQ(frame.inputs[1].has_value(),
              frame.stamp_s < 1000.0 + (kKept - 1) / 30.0 + arm_.inputs.input_max_age_s);
  }
}

TEST_F(Recorded, ATrialThatGoesBackInTimeHasWhatItsFramesHold) {
  FrameAssembler assembler(arm_, testing_assembler::without_waiting());
  run(assembler, 1000.0);
  TrialRecorder recorder(arm_, "twice");
  for (Frame& frame : assembler.take()) recorder.add(std::move(frame));
  run(assembler, 900.0);
  for (Frame& frame : assembler.take()) recorder.add(std::move(frame));
  const Trial trial = recorder.take();
  EXPECT_GT(trial.frames.size(), 470u);
  EXPECT_TRUE(trial.inputs.empty());
}

}  // namespace
}  // namespace softarm::trial
