// What prepare() makes of inputs that frames hold between their samples, and of the time of the session.
#include "effects/drive_trials.h"

namespace softarm::effects::testing {
namespace {

using identify::Trial;

/// Frames at 120 Hz that hold samples at 50 Hz of an input.
Trial held(const Arm& arm, double begin_s, double duration_s,
           const std::function<double(double t_s)>& sampled) {
  Trial trial;
  trial.name = "held";
  for (int i = 0; i < static_cast<int>(120.0 * duration_s); ++i) {
    Frame frame;
    const double t_s = i / 120.0;
    frame.stamp_s = begin_s + t_s;
    frame.base_body = Eigen::Isometry3d::Identity();
    frame.payload_kg = 0.0;
    frame.bodies.push_back({0, Eigen::Vector3d(0.0, 0.0, 0.05), std::nullopt});
    frame.inputs.assign(arm.inputs.scalars.size(), 0.0);
    // Samples a little after full fiftieths; a frame holds the newest before it.
    frame.inputs[0] = sampled(std::floor((t_s - 0.001) * 50.0) / 50.0 + 0.001);
    trial.frames.push_back(frame);
  }
  return trial;
}

TEST(HeldInputs, BecomeStraightBetweenTheirSamples) {
  const Arm arm = shipped_arm("online_200mm");
  const auto ramp = [](double t_s) { return 1e4 * t_s + 2e3 * std::sin(4.0 * t_s); };
  const Trial trial = held(arm, 50.0, 4.0, ramp);
  const TrialData data = prepare(arm, {trial}).trials.at(0);
  double before_pa = 0.0, after_pa = 0.0;
  for (Eigen::Index i = 12; i + 12 < data.series.t_s.size(); ++i) {
    const double t_s = data.series.t_s[i];
    before_pa += ramp(t_s) - *trial.frames[static_cast<std::size_t>(i)].inputs[0];
    after_pa += ramp(t_s) - data.series.inputs(0, i);
    // What is left: within which frame a sample came is not known.
    EXPECT_NEAR(data.series.inputs(0, i), ramp(t_s), 90.0);
  }
  const auto count = static_cast<double>(data.series.t_s.size());
  EXPECT_GT(before_pa / count, 80.0);  // late by about 10 ms
  EXPECT_LT(std::abs(after_pa / count), 10.0);
  EXPECT_EQ(data.series.inputs, data.series.moment_inputs);
}

TEST(HeldInputs, ThatWereHeldStayHeld) {
  const Arm arm = shipped_arm("online_200mm");
  const auto moves = [](double t_s) {
    return t_s < 1.0 ? 1e4 * t_s : t_s < 3.0 ? 1e4 : t_s < 4.0 ? 1e4 + 1e4 * (t_s - 3.0) : 0.0;
  };
  const TrialData data = prepare(arm, {held(arm, 50.0, 6.0, moves)}).trials.at(0);
  for (Eigen::Index i = 0; i < data.series.t_s.size(); ++i) {
    const double t_s = data.series.t_s[i];
    if (t_s > 1.03 && t_s < 2.97) {
      EXPECT_EQ(data.series.inputs(0, i), 1e4) << t_s;
    } else if (t_s > 4.03) {
      EXPECT_EQ(data.series.inputs(0, i), 0.0) << t_s;
    } else if (t_s < 3.97) {
      EXPECT_NEAR(data.series.inputs(0, i), moves(t_s), 160.0) << t_s;
    }
  }
}

TEST(Session, BeginsWithTheEarliestTrial) {
  const Arm arm = shipped_arm("online_200mm");
  const auto still = [](double) { return 0.0; };
  const Prepared prepared = prepare(
      arm, {held(arm, 1000.0, 1.0, still), held(arm, 400.0, 1.0, still), held(arm, 430.0, 1.0, still)});
  ASSERT_EQ(prepared.trials.size(), 3u);
  EXPECT_DOUBLE_EQ(prepared.trials[0].session_s, 600.0);
  EXPECT_DOUBLE_EQ(prepared.trials[1].session_s, 0.0);
  EXPECT_DOUBLE_EQ(prepared.trials[2].session_s, 30.0);
}

}  // namespace
}  // namespace softarm::effects::testing
