// What prepare() makes of inputs by their own stamps, and DriveHistory frame by frame; the time of the
// session.
#include <algorithm>

#include "effects/drive_trials.h"
#include "model/drive_history.h"

namespace softarm::effects::testing {
namespace {

using trial::Trial;

constexpr double kFrames_hz = 120.0, kSamples_hz = 50.0;

/// What is recorded at a time.
struct Recorded {
  bool inputs = true, base = true, body = true;
};

/// Frames of a straight arm, with samples of the first input a third of a millisecond after full fiftieths.
std::vector<trial::Frame> frames(
    const arm::Arm& arm, double begin_s, double duration_s, const std::function<double(double t_s)>& input,
    const std::function<Recorded(double t_s)>& at = [](double) { return Recorded(); }) {
  trial::FrameAssembler::Params params;
  params.close_when_taken = true;
  trial::FrameAssembler assembler(arm, params);
  assembler.add_payload(0.0, 0.0);
  for (int k = -1; k < static_cast<int>(kSamples_hz * duration_s); ++k) {
    const double t_s = k / kSamples_hz + 0.0003;
    if (!at(t_s).inputs) continue;
    assembler.add_input(0, begin_s + t_s, arm.inputs.ambient_pressure_pa + input(t_s));
    for (std::size_t i = 1; i < arm.inputs.scalars.size(); ++i)
      assembler.add_input(static_cast<int>(i), begin_s + t_s, arm.inputs.ambient_pressure_pa);
  }
  for (int i = 0; i < static_cast<int>(kFrames_hz * duration_s); ++i) {
    const double stamp_s = begin_s + i / kFrames_hz;
    const Recorded now = at(i / kFrames_hz);
    if (now.base)
      assembler.add_body(trial::FrameAssembler::kBaseBody, stamp_s, {0.0, 0.0, 1.0 + 1e-3 * (i % 7)},
                         Eigen::Quaterniond::Identity());
    if (now.body) assembler.add_body(0, stamp_s, {0.0, 1e-3 * (i % 5), 1.05}, std::nullopt);
  }
  assembler.flush();
  return assembler.take();
}

arm::Arm one_marker_arm() {
  arm::Arm arm = shipped_arm("online_200mm");
  arm.bodies.resize(1);
  arm.bodies[0].orientation_usable = false;
  arm.bodies[0].section_in_body.setIdentity();
  return arm;
}

Trial trial_of(const arm::Arm& arm, const std::vector<trial::Frame>& frames) {
  trial::TrialRecorder recorder(arm, "trial");
  for (const trial::Frame& frame : frames) recorder.add(frame);
  return recorder.take();
}

double ramp(double t_s) {
  return 1e4 * t_s + 2e3 * std::sin(4.0 * t_s);
}

TEST(PreparedInputs, AreStraightBetweenTheirSamples) {
  const arm::Arm arm = one_marker_arm();
  const Trial trial = trial_of(arm, frames(arm, 50.0, 4.0, ramp));
  const model::TrialData data = model::prepare(arm, {trial}).trials.at(0);
  double held_pa = 0.0;
  const Eigen::Index last = data.series.t_s.size() - 4;  // after the last sample it is held
  for (Eigen::Index i = 0; i < last; ++i) {
    EXPECT_NEAR(data.series.inputs(0, i), ramp(data.series.t_s[i]), 2.0);  // of the curve between samples
    held_pa += ramp(data.series.t_s[i]) - *trial.frames[static_cast<std::size_t>(i)].inputs[0];
  }
  EXPECT_GT(held_pa / static_cast<double>(last), 80.0);  // late by about 10 ms
  EXPECT_EQ(data.series.inputs, data.series.moment_inputs);
}

TEST(PreparedInputs, StayAsTheyAreWhereTheArmSaysThatTheyAreLatched) {
  arm::Arm arm = one_marker_arm();
  arm.inputs.scalars[0].between = arm::Between::kHeld;
  const Trial trial = trial_of(arm, frames(arm, 50.0, 1.0, ramp));
  const model::TrialData data = model::prepare(arm, {trial}).trials.at(0);
  for (Eigen::Index i = 0; i < data.series.t_s.size(); ++i)
    EXPECT_EQ(data.series.inputs(0, i), *trial.frames[static_cast<std::size_t>(i)].inputs[0]);
}

/// The arm is driven on while cameras do not see it.
TEST(PreparedInputs, GoOnWhereNoBodyIsSeen) {
  const arm::Arm arm = one_marker_arm();
  const auto without = [&](const Recorded& lost) {
    const auto at = [&](double t_s) { return t_s > 2.0 && t_s < 3.5 ? lost : Recorded(); };
    return model::prepare(arm, {trial_of(arm, frames(arm, 50.0, 6.0, ramp, at))}).trials.at(0);
  };
  for (const bool base : {true, false}) {
    SCOPED_TRACE(base ? "frames with the base alone" : "no frames");
    const model::TrialData data = without({true, base, false});
    EXPECT_NEAR(static_cast<double>(data.frames), 4.5 * kFrames_hz, 3.0);
    double blind_s = 0.0;
    for (const model::Block& block : data.blocks) {
      EXPECT_EQ(block.begins, &block == &data.blocks.front());
      const auto first = static_cast<Eigen::Index>(block.first), last = static_cast<Eigen::Index>(block.last);
      const double from_s = data.series.t_s[first], to_s = data.series.t_s[last - 1];
      const bool blind = from_s > 1.99 && to_s < 3.51;
      EXPECT_EQ(block.bodies.empty(), blind) << from_s << " to " << to_s << " s";
      if (blind) blind_s += to_s - from_s;
      for (Eigen::Index i = first; i < last && data.series.t_s[i] < 5.9; ++i)  // samples end
        EXPECT_NEAR(data.series.inputs(0, i), ramp(data.series.t_s[i]), 40.0) << data.series.t_s[i] << " s";
    }
    EXPECT_GT(blind_s, 1.0);
  }
  // States at rest that were recorded one by one are no motion: each begins anew.
  const auto stills = [](double t_s) { return Recorded{true, true, std::fmod(t_s, 2.0) < 0.6}; };
  const model::TrialData apart =
      model::prepare(arm, {trial_of(arm, frames(arm, 50.0, 6.0, ramp, stills))}).trials.at(0);
  EXPECT_EQ(std::count_if(apart.blocks.begin(), apart.blocks.end(), [](const auto& b) { return b.begins; }),
            3);
  for (const model::Block& block : apart.blocks) EXPECT_FALSE(block.bodies.empty());

  // Of what drives it later than an input may be old nothing is known: what was before is over.
  const model::TrialData cut = without({false, false, false});
  std::vector<double> begins_s;
  for (const model::Block& block : cut.blocks)
    if (block.begins) begins_s.push_back(cut.series.t_s[static_cast<Eigen::Index>(block.first)]);
  ASSERT_EQ(begins_s.size(), 2u);
  EXPECT_NEAR(begins_s[1], 3.5, 0.02);
}

TEST(PreparedInputs, AreThoseOfTheFramesWhereNothingElseIsKnown) {
  const arm::Arm arm = one_marker_arm();
  Trial trial{"frames", frames(arm, 50.0, 1.0, ramp)};
  const model::TrialData data = model::prepare(arm, {trial}).trials.at(0);
  for (Eigen::Index i = 0; i < data.series.t_s.size(); ++i)
    EXPECT_EQ(data.series.inputs(0, i), *trial.frames[static_cast<std::size_t>(i)].inputs[0]);
}

TEST(DriveHistory, HasTheInputsOfAPreparedTrialOnceTheirNextSampleIsThere) {
  const arm::Arm arm = one_marker_arm();
  const auto shape = [](double t_s) { return t_s < 1.0 ? ramp(t_s) : t_s < 2.5 ? 9e3 : ramp(t_s - 1.5); };
  const std::vector<trial::Frame> all = frames(arm, 50.0, 4.0, shape);
  const Trial trial = trial_of(arm, all);
  model::DriveHistory history(arm);
  for (const trial::Frame& frame : all) {
    Eigen::VectorXd inputs(static_cast<Eigen::Index>(frame.inputs.size()));
    for (Eigen::Index k = 0; k < inputs.size(); ++k) inputs[k] = *frame.inputs[static_cast<std::size_t>(k)];
    history.add(frame.stamp_s(), inputs, frame.samples);
    const model::Series now = history.series(50.0, 0.1);
    EXPECT_NEAR(now.t_s[now.t_s.size() - 1], frame.stamp_s() - 50.0, 1e-9);
    EXPECT_EQ(now.inputs(0, now.t_s.size() - 1), inputs[0]);  // nothing is known of what comes later
  }
  const model::Series series = history.series(50.0, 0.1);
  EXPECT_LT(series.t_s.size(), 300);  // of 480 frames
  Eigen::Index next = 0;
  for (std::size_t i = 4; i + 4 < trial.frames.size(); ++i) {
    const double stamp_s = trial.frames[i].stamp_s(), t_s = stamp_s - 50.0;
    while (series.t_s[next + 1] < t_s) ++next;
    const double w = (t_s - series.t_s[next]) / (series.t_s[next + 1] - series.t_s[next]);
    const double value = series.inputs(0, next) + w * (series.inputs(0, next + 1) - series.inputs(0, next));
    EXPECT_NEAR(value, *trial.inputs[0].at(stamp_s), 31.0) << t_s;
  }
}

TEST(DriveHistory, TakesFramesForSamplesWhereThereAreNone) {
  const arm::Arm arm = one_marker_arm();
  model::DriveHistory history(arm);
  const auto count = static_cast<Eigen::Index>(arm.inputs.scalars.size());
  for (int i = 0; i < 100; ++i)
    history.add(7.0 + 0.01 * i, Eigen::VectorXd::Constant(count, i < 50 ? 0.0 : 1e3 * (i % 2)), {});
  const model::Series series = history.series(7.0, 0.0);
  EXPECT_EQ(series.t_s.size(), 2 + 49);  // level, then up and down
  EXPECT_EQ(series.inputs(0, series.t_s.size() - 1), 1e3);
}

TEST(Session, BeginsWithTheEarliestTrial) {
  const arm::Arm arm = one_marker_arm();
  const auto still = [](double) { return 0.0; };
  const auto at = [&](double begin_s) { return trial_of(arm, frames(arm, begin_s, 1.0, still)); };
  const model::Prepared prepared = model::prepare(arm, {at(1000.0), at(400.0), at(430.0)});
  ASSERT_EQ(prepared.trials.size(), 3u);
  EXPECT_DOUBLE_EQ(prepared.trials[0].series.session_s, 600.0);
  EXPECT_DOUBLE_EQ(prepared.trials[1].series.session_s, 0.0);
  EXPECT_DOUBLE_EQ(prepared.trials[2].series.session_s, 30.0);
}

}  // namespace
}  // namespace softarm::effects::testing
