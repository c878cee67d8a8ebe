// Saturation and growth of EI as constants to be identified: found from 0, told apart by loads alone, their
// ratio without.
#include <gtest/gtest.h>

#include <cmath>

#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;

constexpr double kA = 2.0e-5, kB = 4.0e-6, kMean = 4.0e-7;

arm::Arm saturating(arm::Arm arm) {
  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.saturation_per_pa = kA;
  return arm;
}

Result run(const arm::Arm& nominal, const arm::Arm& truth, const std::vector<double>& payloads_kg,
           const Options& options, std::uint64_t seed = 11) {
  std::mt19937_64 random(seed);
  testing::Protocol protocol;
  protocol.payloads_kg = payloads_kg;
  protocol.draw = testing::paper_inputs;
  return identify(nominal, testing::make_trials(truth, protocol, random), options);
}

TEST(IdentifySaturation, IsFoundFromNothingWithEiHeldAndPredictsUnseenTrials) {
  const arm::Arm nominal = testing::pneumatic_arm(), truth = saturating(nominal);
  Options without;
  without.held = {"*.bending_stiffness.*"};
  Options with = without;
  with.also_free = {"*.chamber_*.saturation"};
  const Result proportional = run(nominal, truth, {0.0}, without),
               saturated = run(nominal, truth, {0.0}, with);
  EXPECT_TRUE(saturated.converged);
  for (const Constant& c : saturated.constants) {
    EXPECT_TRUE(c.determined) << c.name << " " << c.advice;
    EXPECT_NEAR(c.value, value_of(truth, c.ref), 4.0 * c.sd) << c.name;
  }
  EXPECT_NEAR(find(saturated, "segment_1.chamber_1.saturation")->value, kA, 0.15 * kA);
  EXPECT_LT(saturated.held_out.mean_m, 0.5 * proportional.held_out.mean_m);
  EXPECT_TRUE(testing::says(describe(saturated), "segment_1.chamber_1.saturation"));
}

TEST(IdentifySaturation, OfAllChambersTogetherAndGrowthOfEiAreToldByLoads) {
  arm::Arm truth = testing::pneumatic_arm();
  truth.segments[0].saturation.chambers_per_pa = kB;
  truth.segments[0].bending_stiffness.per_mean_pressure_nm2_per_pa = kMean;
  Options options;
  options.also_free = {"*.chambers.saturation", "per_mean_pressure"};
  const Result result = run(testing::pneumatic_arm(), truth, {0.0, 0.2}, options);
  const Constant &b = *find(result, "segment_1.chambers.saturation"),
                 &growth = *find(result, "segment_1.bending_stiffness.per_mean_pressure");
  EXPECT_TRUE(b.determined) << b.sd;
  EXPECT_NEAR(b.value, kB, 4.0 * b.sd);
  EXPECT_NEAR(growth.value, kMean, 4.0 * growth.sd);
}

TEST(IdentifySaturation, GrowthWithTheLowestTensionAndWithOneTendonIsToldByLoads) {
  arm::Arm nominal = testing::shipped("hybrid_85mm"), truth = nominal;
  constexpr double kLowest = 2.0e-4, kSecond = 1.0e-4;
  truth.segments[0].bending_stiffness.per_min_tension_nm2_per_n = kLowest;
  truth.segments[0].tendons[1].stiffness_gain_nm2_per_n = kSecond;
  testing::Protocol protocol;
  protocol.payloads_kg = {0.0, 0.02};
  protocol.draw = [](std::mt19937_64& random) {
    arm::InputValues inputs{testing::uniform(random, 0.0, 40e3)};
    for (int i = 0; i < 3; ++i) inputs.emplace_back(testing::uniform(random, 0.2, 3.0));
    return inputs;
  };
  std::mt19937_64 random(5);
  Options options;
  options.also_free = {"per_min_tension", "per_tendon_2"};
  const Result result = identify(nominal, testing::make_trials(truth, protocol, random), options);
  const Constant &lowest = *find(result, "segment_1.bending_stiffness.per_min_tension"),
                 &second = *find(result, "segment_1.bending_stiffness.per_tendon_2");
  for (const Constant* c : {&lowest, &second}) EXPECT_TRUE(c->determined) << c->name << " " << c->sd;
  EXPECT_NEAR(lowest.value, kLowest, 4.0 * lowest.sd);
  EXPECT_NEAR(second.value, kSecond, 4.0 * second.sd);
}

TEST(IdentifySaturation, WithoutLoadItIsGrowthOfEiAndHoldingEiTellsTheRatio) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].mass_per_length_kg_m = 0.0;
  nominal.segments[0].jamming_input.reset();
  nominal.segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  nominal.segments[0].bending_stiffness.per_min_pressure_nm2_per_pa = 0.0;
  arm::Arm truth = nominal;
  truth.segments[0].saturation.chambers_per_pa = kB;
  Options options;
  options.also_free = {"*.chambers.saturation", "per_mean_pressure"};
  options.held = {"*.base", "*.per_min_pressure"};
  const Result both = run(nominal, truth, {0.0}, options);
  for (const char* name :
       {"segment_1.chambers.saturation", "segment_1.bending_stiffness.per_mean_pressure"}) {
    const Constant& c = *find(both, name);
    EXPECT_FALSE(c.determined) << name;
    EXPECT_TRUE(testing::says(c.advice, "--hold '*.bending_stiffness.*'")) << c.advice;
  }
  EXPECT_TRUE(testing::says(describe(both), "only moment over stiffness shows"));
  EXPECT_LT(both.held_out.mean_m, 0.001) << "the ratio is fitted all the same";
  options.held = {"*.bending_stiffness.*"};
  const Result ratio = run(nominal, truth, {0.0}, options);
  const Constant& b = *find(ratio, "segment_1.chambers.saturation");
  EXPECT_TRUE(b.determined);
  EXPECT_NEAR(b.value, kB, 4.0 * b.sd);
  for (const Constant& c : ratio.constants) EXPECT_FALSE(testing::says(c.advice, "--hold")) << c.name;
}

TEST(IdentifySaturation, WhereThereIsNoneStaysAtNothingAndIsNoFailure) {
  const arm::Arm nominal = testing::pneumatic_arm();
  Options options;
  options.held = {"*.bending_stiffness.*"};
  options.also_free = {"saturation"};
  options.free = {"moment_gain"};
  bool at_zero = false;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Result result = run(nominal, nominal, {0.0, 0.2}, options, seed);
    EXPECT_TRUE(result.converged);
    for (const Constant& c : result.constants) {
      if (role_of(c.ref.kind) != ConstantRole::kSaturation) continue;
      EXPECT_GE(c.value, 0.0);
      at_zero = at_zero || c.at_bound;
      EXPECT_FALSE(c.kept);
      EXPECT_FALSE(testing::says(c.advice, "limit")) << c.advice;
      EXPECT_EQ(c.determined, c.sd <= options.determined_sd * c.scale) << c.name;
    }
    EXPECT_FALSE(testing::says(describe(result), "LIMIT"));
  }
  EXPECT_TRUE(at_zero) << "the bound was never tried";
}

TEST(IdentifySaturation, OfASingleChamberOneOfTheTwoIsToBeHeld) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].chambers.resize(1);
  nominal.segments[0].chambers[0].saturation_per_pa = 0.0;
  nominal.segments[0].saturation.chambers_per_pa = 0.0;
  arm::Arm truth = nominal;
  truth.segments[0].chambers[0].saturation_per_pa = kA;
  const Result both = run(nominal, truth, {0.0, 0.2}, {});
  for (const char* name : {"segment_1.chamber_1.saturation", "segment_1.chambers.saturation"}) {
    const Constant& c = *find(both, name);
    EXPECT_FALSE(c.determined) << name;
    EXPECT_TRUE(testing::says(c.advice, "segment_1 has a single chamber")) << name << ": " << c.advice;
    EXPECT_TRUE(testing::says(c.advice, "--hold segment_1.chambers.saturation")) << name << ": " << c.advice;
  }
  Options one;
  one.held = {"segment_1.chambers.saturation"};
  const Result held = run(nominal, truth, {0.0, 0.2}, one);
  EXPECT_TRUE(find(held, "segment_1.chamber_1.saturation")->determined);
}

TEST(IdentifySaturation, PatternsThatEndInAWildcardFreeWhatIsStatedAlone) {
  arm::Arm nominal = testing::pneumatic_arm();
  Options options;
  options.free = {"segment_1.*", "*.bending_stiffness.*"};
  const Result stated = run(nominal, nominal, {0.0, 0.2}, options);
  EXPECT_EQ(find(stated, "segment_1.chamber_1.saturation"), nullptr);
  EXPECT_EQ(find(stated, "segment_1.bending_stiffness.per_mean_pressure"), nullptr);
  EXPECT_NE(find(stated, "segment_1.bending_stiffness.base"), nullptr);
  nominal.segments[0].chambers[0].saturation_per_pa = 0.0;
  options.free = {"*.chamber_1.*"};
  const Result first = run(nominal, nominal, {0.0, 0.2}, options);
  EXPECT_NE(find(first, "segment_1.chamber_1.saturation"), nullptr);
  EXPECT_EQ(find(first, "segment_1.chamber_2.saturation"), nullptr);
}

}  // namespace
}  // namespace softarm::identify
