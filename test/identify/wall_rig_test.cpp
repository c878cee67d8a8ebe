// Trials of a virtual arm whose wall creeps by a law of the rig's own (a spectrum of times, of the moment):
// our one element, identified from some of them, predicts the others; a wall that does not remember cannot.
#include "effects/drive_trials.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

namespace rigged = effects::testing;

/// The demo's arm: 40 % of the moment and of the length come about 1.5 s late.
rig::Scenario creeping(std::uint64_t seed) {
  rig::Scenario scenario = rigged::shipped_scenario("demo");
  scenario.seed = seed;
  scenario.duration_s = 30.0;
  rig::SegmentSpec& segment = scenario.arm.segments[0];
  segment.creep.moment = {{1.5, 0.4, 0.3}};
  segment.creep.length = {{1.5, 0.4, 0.3}};
  // The trial before ended elsewhere.
  segment.creep.before_moment_nm = {0.02 * std::cos(2.0 * static_cast<double>(seed)), 0.01};
  scenario.mocap.ring_noise = {0.05e-3, 0.001};
  return scenario;
}

TEST(WallOnTheRig, PredictsUnseenTrialsAsLawsWithoutMemoryCannot) {
  const arm::Arm arm = rigged::shipped_arm("online_200mm");
  std::vector<trial::Trial> trials;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    trials.push_back(rigged::recorded_trial(arm, creeping(seed), "trial_" + std::to_string(seed)));
  Options options;
  options.frames.prefer_static = false;
  arm::Arm walled = arm;
  walled.segments[0].wall.bending = {{0.5, 0.1}};
  walled.segments[0].wall.axial = {{0.5, 0.1}};
  const Result before = identify(arm, trials, options), after = identify(walled, trials, options);
  RecordProperty("held_out_static_mm", std::to_string(1e3 * before.held_out.mean_m));
  RecordProperty("held_out_walled_mm", std::to_string(1e3 * after.held_out.mean_m));
  EXPECT_TRUE(after.converged);
  EXPECT_GT(before.held_out.frames, 40u);
  EXPECT_LT(after.held_out.mean_m, 0.5 * before.held_out.mean_m)
      << before.held_out.mean_m << " " << after.held_out.mean_m << "\n"
      << describe(after);
  const auto value = [&](const std::string& name) {
    const auto found = std::find_if(after.constants.begin(), after.constants.end(),
                                    [&](const Constant& c) { return c.name == name; });
    return found == after.constants.end() ? 0.0 : found->value;
  };
  EXPECT_NEAR(value("segment_1.wall.bending_1.time"), 1.5, 0.5);
  EXPECT_NEAR(value("segment_1.wall.bending_1.share"), 0.4, 0.08);
}

}  // namespace
}  // namespace softarm::identify
