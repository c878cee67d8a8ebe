// Trials of virtual arms whose actuators saturate by laws of the rig's own (an exponential), and whose
// chambers stiffen the arm (a power of the mean pressure): our law, identified from some of them, predicts
// the others; without it nothing does.
#include "effects/drive_trials.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

namespace rigged = effects::testing;

/// The demo's arm, its chambers down to about two thirds at 50 kPa, EI up by a fifth there.
rig::Scenario saturating(std::uint64_t seed) {
  rig::Scenario scenario = rigged::shipped_scenario("demo");
  scenario.seed = seed;
  scenario.duration_s = 30.0;
  rig::SegmentSpec& segment = scenario.arm.segments[0];
  for (rig::ChamberSpec& chamber : segment.chambers) chamber.saturation_pa = 60e3;
  segment.saturation.chambers_pa = 400e3;
  rig::StiffnessGrowth growth;
  growth.added_nm2 = 0.2 * segment.stiffness_base_nm2;
  growth.at = 50e3;
  growth.exponent = 0.7;
  segment.stiffness_growth = {growth};
  scenario.pressures.random->max.assign(3, 60e3);
  scenario.mocap.ring_noise = {0.05e-3, 0.001};  // what is compared is the laws' error, not the cameras'
  return scenario;
}

TEST(SaturationOnTheRig, PredictsUnseenTrialsAsProportionalLawsCannot) {
  const arm::Arm arm = rigged::shipped_arm("online_200mm");
  std::vector<trial::Trial> trials;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    trials.push_back(rigged::recorded_trial(arm, saturating(seed), "trial_" + std::to_string(seed)));
  Options proportional;
  proportional.frames.prefer_static = false;  // of the whole range of pressures; at rest they are mostly low
  Options with = proportional;
  with.also_free = {"*.chamber_*.saturation", "per_mean_pressure"};
  const Result before = identify(arm, trials, proportional), after = identify(arm, trials, with);
  RecordProperty("held_out_proportional_mm", std::to_string(1e3 * before.held_out.mean_m));
  RecordProperty("held_out_saturating_mm", std::to_string(1e3 * after.held_out.mean_m));
  EXPECT_TRUE(after.converged);
  EXPECT_GT(before.held_out.frames, 40u);
  EXPECT_LT(after.held_out.mean_m, 0.5 * before.held_out.mean_m)
      << before.held_out.mean_m << " " << after.held_out.mean_m << "\n"
      << describe(after);
  for (const Constant& c : after.constants) {
    if (c.ref.kind == ConstantKind::kChamberSaturation) {
      EXPECT_GT(c.value, 5e-6) << c.name;
    }
  }
}

/// Errors on unseen trials of proportional laws and of saturating ones, of six trials.
struct HeldOut {
  Result before, after;
};

HeldOut held_out(const arm::Arm& arm, rig::Scenario scenario) {
  scenario.duration_s = 30.0;
  scenario.payload.schedule.resize(1);
  scenario.mocap.ring_noise = {0.05e-3, 0.001};
  std::vector<trial::Trial> trials;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    scenario.seed = seed;
    trials.push_back(rigged::recorded_trial(arm, scenario, "trial_" + std::to_string(seed)));
  }
  Options proportional;
  proportional.frames.prefer_static = false;
  Options with = proportional;
  with.also_free = {"*.saturation"};
  return {identify(arm, trials, proportional), identify(arm, trials, with)};
}

TEST(SaturationOnTheRig, OfTendonsPredictsUnseenTrials) {
  rig::Scenario scenario = rigged::shipped_scenario("two_segment");
  for (rig::TendonSpec& tendon : scenario.arm.segments[1].tendons) tendon.saturation_n = 4.0;
  scenario.tensions.random->max.assign(2, 12.0);
  const HeldOut errors = held_out(rigged::shipped_arm("two_segment"), scenario);
  EXPECT_LT(errors.after.held_out.mean_m, 0.5 * errors.before.held_out.mean_m)
      << errors.before.held_out.mean_m << "\n"
      << describe(errors.after);
}

TEST(SaturationOnTheRig, OfCablesPredictsUnseenTrials) {
  rig::Scenario scenario = rigged::shipped_scenario("cable_235mm");
  scenario.arm.segments[0].cables[0].saturation_rad = 1.0;
  const HeldOut errors = held_out(rigged::shipped_arm("cable_235mm"), scenario);
  EXPECT_LT(errors.after.held_out.mean_m, 0.5 * errors.before.held_out.mean_m)
      << errors.before.held_out.mean_m << "\n"
      << describe(errors.after);
}

}  // namespace
}  // namespace softarm::identify
