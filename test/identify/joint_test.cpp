// The compliance of joints, identified from frames and from the virtual rig's own: a yielding base, a short
// soft stretch of arm where segments meet.
#include <cmath>

#include "effects/drive_trials.h"
#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;

TEST(IdentifyJoint, OfTheBaseAndBetweenSegmentsAreRecovered) {
  arm::Arm nominal = testing::shipped("two_segment");
  arm::Arm truth = nominal;
  truth.segments[0].joint_compliance_rad_per_nm = 0.8;
  truth.segments[1].joint_compliance_rad_per_nm = 1.5;
  std::mt19937_64 random(21);
  testing::Protocol protocol;
  protocol.trials = 20;
  protocol.base = testing::horizontal();
  protocol.payloads_kg = {0.0, 0.05};
  protocol.draw = [&](std::mt19937_64& r) {
    arm::InputValues inputs;
    for (const arm::ScalarInput& input : nominal.inputs.scalars)
      inputs.emplace_back(input.kind == arm::InputKind::kTension ? testing::uniform(r, 0.0, 3.0)
                                                                 : testing::uniform(r, 0.0, 3e4));
    return inputs;
  };
  Options options;
  options.also_free = {"joint_compliance"};
  const Result result = identify(nominal, testing::make_trials(truth, protocol, random), options);
  EXPECT_TRUE(result.converged);
  for (const char* name : {"proximal.joint_compliance", "distal.joint_compliance"}) {
    const Constant* c = find(result, name);
    ASSERT_NE(c, nullptr) << name;
    EXPECT_NEAR(c->value, value_of(truth, c->ref), 4.0 * c->sd) << name;
    EXPECT_NEAR(c->value, value_of(truth, c->ref), 0.2 * value_of(truth, c->ref)) << name;
  }
}

TEST(IdentifyJoint, OfTheRigsYieldingBaseIsRecovered) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  constexpr double kCompliance = 0.4;
  std::vector<trial::Trial> trials;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    rig::Scenario scenario = effects::testing::shipped_scenario("demo");
    scenario.seed = seed;
    scenario.duration_s = 20.0;
    rig::hide({"base_compliance", "", {{"stiffness_nm_per_rad", 1.0 / kCompliance}}}, scenario);
    trials.push_back(effects::testing::recorded_trial(arm, scenario, "trial_" + std::to_string(seed)));
  }
  Options rigid, options;
  options.also_free = {"joint_compliance"};
  const Result without = identify(arm, trials, rigid), with = identify(arm, trials, options);
  const Constant* c = find(with, "segment_1.joint_compliance");
  ASSERT_NE(c, nullptr);
  EXPECT_TRUE(c->determined) << c->value << " " << c->sd;
  EXPECT_NEAR(c->value, kCompliance, 0.1 * kCompliance) << c->sd;
  EXPECT_LT(with.held_out.mean_m, without.held_out.mean_m);
}

TEST(IdentifyJoint, OfTheRigsJointBetweenSegmentsIsRecovered) {
  const arm::Arm arm = effects::testing::shipped_arm("two_segment");
  constexpr double kCompliance = 1.0;
  std::vector<trial::Trial> trials;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    rig::Scenario scenario = effects::testing::shipped_scenario("two_segment");
    scenario.seed = seed;
    scenario.duration_s = 30.0;
    scenario.arm.segments[1].joint = rig::JointSpec{1.0 / kCompliance, 0.004};
    trials.push_back(effects::testing::recorded_trial(arm, scenario, "trial_" + std::to_string(seed)));
  }
  Options rigid, options;
  options.also_free = {"distal.joint_compliance"};
  const Result without = identify(arm, trials, rigid), with = identify(arm, trials, options);
  const Constant* c = find(with, "distal.joint_compliance");
  ASSERT_NE(c, nullptr);
  EXPECT_TRUE(c->determined) << c->value << " " << c->sd;
  EXPECT_NEAR(c->value, kCompliance, std::max(2.0 * c->sd, 0.1 * kCompliance)) << c->sd;
  EXPECT_LT(c->sd, 0.3 * kCompliance);
  EXPECT_LT(with.held_out.mean_m, without.held_out.mean_m);
}

}  // namespace
}  // namespace softarm::identify
