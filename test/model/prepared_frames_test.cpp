// What prepare() makes of frames: means over a fifth of a second, or over as much as a slow recording needs.
#include <gtest/gtest.h>

#include <random>

#include "effects/drive_trials.h"
#include "model/prepared_trial.h"

namespace softarm::model {
namespace {

constexpr double kNoise_m = 5e-4, kDuration_s = 40.0;

/// A marker that moves along a line to and fro.
trial::Trial recorded(const arm::Arm& arm, double rate_hz, double amplitude_m = 0.02,
                      double omega_rad_s = 1.0) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  trial::TrialRecorder recorder(arm, "trial");
  for (int i = 0; i < static_cast<int>(rate_hz * kDuration_s); ++i) {
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(1.6e9 + i / rate_hz);
    frame.inputs.assign(arm.inputs.scalars.size(), arm.inputs.ambient_pressure_pa);
    frame.payload_kg = 0.0;
    frame.base_body = Eigen::Isometry3d::Identity();
    const double t_s = i / rate_hz;
    frame.bodies.push_back(
        {0,
         {amplitude_m * std::sin(omega_rad_s * t_s) + noise(random), noise(random), 0.05 + noise(random)},
         std::nullopt});
    recorder.add(frame);
  }
  return recorder.take();
}

class PreparedFrames : public ::testing::TestWithParam<double> {};

TEST_P(PreparedFrames, AreUsedAtAnyRateAndTellTheirNoise) {
  arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  arm.bodies.resize(1);
  arm.bodies[0].orientation_usable = false;
  const trial::Trial trial = recorded(arm, GetParam());
  Preparation how;
  how.most_blocks = 1;
  const Prepared prepared = prepare(arm, {trial}, how);
  ASSERT_EQ(prepared.trials.size(), 1u);
  const TrialData& data = prepared.trials[0];
  std::size_t used = 0;
  for (const Block& block : data.blocks) used += block.last - block.first;
  EXPECT_GE(used + 3, trial.frames.size());  // a few may be left at the end
  const double mean_s = kDuration_s / static_cast<double>(data.blocks.size());
  EXPECT_NEAR(mean_s, std::max(0.2, 3.0 / GetParam()), 0.55 / GetParam());
  // The noise of a body, not its motion.
  EXPECT_NEAR(prepared.white_sd_m[0], kNoise_m, 0.2 * kNoise_m);
}

/// A line through a fifth of a second of this is 0.7 mm off.
TEST(PreparedBends, AreNoNoise) {
  arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  arm.bodies.resize(1);
  arm.bodies[0].orientation_usable = false;
  for (const double rate_hz : {25.0, 30.0, 60.0, 120.0}) {
    SCOPED_TRACE(rate_hz);
    const Prepared prepared = prepare(arm, {recorded(arm, rate_hz, 0.05, 3.0)});
    EXPECT_NEAR(prepared.white_sd_m[0], kNoise_m, 0.2 * kNoise_m);
  }
}

TEST(PreparedBlocks, AreLongWhereTheArmRestsAndShortWhereItsWayBends) {
  arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  arm.bodies.resize(1);
  arm.bodies[0].orientation_usable = false;
  const auto mean_s = [&](double amplitude_m) {
    const Prepared prepared = prepare(arm, {recorded(arm, 120.0, amplitude_m, 3.0)});
    return kDuration_s / static_cast<double>(prepared.trials[0].blocks.size());
  };
  const Preparation usual;
  EXPECT_GT(mean_s(0.0), 0.875 * usual.most_blocks * usual.block_s);
  EXPECT_LT(mean_s(0.05), 0.15);
  // What is long loses no frame.
  const Prepared rest = prepare(arm, {recorded(arm, 120.0, 0.0, 3.0)});
  int frames = 0;
  for (const Block& block : rest.trials[0].blocks) frames += block.bodies.at(0).frames;
  EXPECT_NEAR(frames, kDuration_s * 120.0, 5.0);
}

INSTANTIATE_TEST_SUITE_P(Hz, PreparedFrames, ::testing::Values(5.0, 10.0, 20.0, 25.0, 30.0, 60.0, 120.0));

}  // namespace
}  // namespace softarm::model
