// What is not identifiable from trials is named, with what would help.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;
using ::testing::Test;

bool confused(const identify::Constant& c, const std::string& with) {
  return std::any_of(c.confused_with.begin(), c.confused_with.end(),
                     [&](const auto& other) { return other.first == with; });
}

identify::Result run(const arm::Arm& nominal, const arm::Arm& truth, const testing::Protocol& protocol,
                     std::mt19937_64& random) {
  identify::Options options;
  options.held_out_share = 0.0;
  return identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
}

TEST(Undetermined, WithoutLoadOnlyMomentOverStiffnessShows) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].mass_per_length_kg_m = 0.0;
  std::mt19937_64 random(1);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.15, random);
  testing::Protocol protocol;
  protocol.payloads_kg = {0.0};
  protocol.repeats = 2;
  protocol.draw = testing::paper_inputs;
  const identify::Result result = run(nominal, truth, protocol, random);
  for (const char* name : {"segment_1.chamber_1.moment_gain", "segment_1.chamber_2.moment_gain",
                           "segment_1.chamber_3.moment_gain", "segment_1.bending_stiffness.base"}) {
    const identify::Constant* c = find(result, name);
    ASSERT_NE(c, nullptr) << name;
    EXPECT_FALSE(c->determined) << name;
    EXPECT_TRUE(testing::says(c->advice, "without a known payload")) << c->advice;
  }
  EXPECT_TRUE(confused(*find(result, "segment_1.chamber_1.moment_gain"), "segment_1.bending_stiffness.base"));
  ASSERT_EQ(result.undetermined.size(), 1u) << "the common factor, nothing else";
  EXPECT_TRUE(testing::says(result.undetermined[0].sentence, "only moment over stiffness shows"));
  // All of them by the same share.
  for (const auto& [name, share] : result.undetermined[0].parts) EXPECT_GT(share, 0.0) << name;
  for (const identify::Constant& c : result.constants) {
    if (c.ref.kind == identify::ConstantKind::kElongation) {
      EXPECT_TRUE(c.determined) << c.name;
    }
  }
  // Held near the start, the shapes right all the same.
  EXPECT_NEAR(find(result, "segment_1.bending_stiffness.base")->value, 0.027, 0.5 * 0.027);
  EXPECT_LT(result.fitted.mean_m, 0.001);
}

TEST(Undetermined, ThePayloadTellsItAfterAll) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].mass_per_length_kg_m = 0.0;
  std::mt19937_64 random(1);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.15, random);
  testing::Protocol protocol;
  protocol.draw = testing::paper_inputs;
  const identify::Result result = run(nominal, truth, protocol, random);
  EXPECT_TRUE(result.undetermined.empty());
  for (const identify::Constant& c : result.constants) EXPECT_TRUE(c.determined) << c.name;
}

TEST(Undetermined, AnArmThatStandsNearItsBucklingLoadTellsNoStiffnessByItsWeightAlone) {
  arm::Arm arm = testing::pneumatic_arm();
  arm::Segment& segment = arm.segments[0];
  segment.bending_stiffness.per_min_pressure_nm2_per_pa = 0.0;
  segment.bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  for (arm::Chamber& chamber : segment.chambers)
    chamber.near_elongation_m_per_pa = chamber.far_elongation_m_per_pa = 0.0;
  std::mt19937_64 random(8);
  testing::Protocol protocol;
  protocol.base = testing::standing();
  protocol.draw = [](std::mt19937_64& r) {
    arm::InputValues inputs{0.0, 0.0, 0.0, 0.0};
    inputs[r() % 3] = testing::uniform(r, 0.2e3, 2e3);
    return inputs;
  };
  protocol.payloads_kg = {0.0};
  for (const double share : {0.85, 0.2}) {
    SCOPED_TRACE(share);
    // Greenhill: a standing rod buckles by its own weight at q L^3 = 7.84 EI.
    segment.mass_per_length_kg_m =
        share * 7.84 * segment.bending_stiffness.base_nm2 / (9.80665 * std::pow(segment.length_m, 3));
    const identify::Result result = run(arm, arm, protocol, random);
    const identify::Constant* stiffness = find(result, "segment_1.bending_stiffness.base");
    ASSERT_NE(stiffness, nullptr);
    EXPECT_EQ(testing::says(stiffness->advice, "buckling load"), share == 0.85) << stiffness->advice;
    if (share < 0.85) continue;
    EXPECT_LT(stiffness->sd, 0.25 * stiffness->value)
        << "the curvature of the cost says that it is determined";
    EXPECT_FALSE(stiffness->determined);
    EXPECT_TRUE(testing::says(stiffness->advice, "--hold '*.bending_stiffness.*'"));
  }
}

TEST(Undetermined, JammingWithoutAVacuumInTheRecording) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(2);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.15, random);
  testing::Protocol protocol;
  // One chamber at a time: pressures of 50 kPa / 3 are all that jams.
  protocol.draw = [](std::mt19937_64& r) {
    arm::InputValues inputs{0.0, 0.0, 0.0, 0.0};
    inputs[r() % 3] = testing::uniform(r, 1e3, 5e3);
    return inputs;
  };
  const identify::Result result = run(nominal, truth, protocol, random);
  const identify::Constant* jamming = find(result, "segment_1.bending_stiffness.per_jamming_pressure");
  ASSERT_NE(jamming, nullptr);
  EXPECT_FALSE(jamming->determined);
  EXPECT_TRUE(testing::says(jamming->advice, "vacuum does not change")) << jamming->advice;
  const identify::Constant* minimum = find(result, "segment_1.bending_stiffness.per_min_pressure");
  EXPECT_FALSE(minimum->determined);
  EXPECT_TRUE(testing::says(minimum->advice, "all chambers")) << minimum->advice;
  EXPECT_EQ(minimum->value, nominal.segments[0].bending_stiffness.per_min_pressure_nm2_per_pa)
      << "nothing pulls it from its start";
}

TEST(Undetermined, ChambersThatAreAlwaysEqual) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(3);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.15, random);
  testing::Protocol protocol;
  protocol.draw = [](std::mt19937_64& r) {
    arm::InputValues inputs = testing::paper_inputs(r);
    inputs[1] = inputs[0];
    return inputs;
  };
  const identify::Result result = run(nominal, truth, protocol, random);
  const identify::Constant* first = find(result, "segment_1.chamber_1.elongation");
  const identify::Constant* second = find(result, "segment_1.chamber_2.elongation");
  EXPECT_FALSE(first->determined);
  EXPECT_FALSE(second->determined);
  EXPECT_TRUE(confused(*first, second->name));
  EXPECT_TRUE(confused(*second, first->name));
  EXPECT_TRUE(testing::says(first->advice, "each of them alone")) << first->advice;
  EXPECT_TRUE(find(result, "segment_1.chamber_3.elongation")->determined);
  // Their sum is identifiable, and the moments too: they act in different directions.
  const double sum = identify::value_of(truth, first->ref) + identify::value_of(truth, second->ref);
  EXPECT_NEAR(first->value + second->value, sum, 0.05 * sum);
  EXPECT_TRUE(find(result, "segment_1.chamber_1.moment_gain")->determined);
}

TEST(Undetermined, AnInputThatIsNeverOn) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(4);
  testing::Protocol protocol;
  protocol.draw = [](std::mt19937_64& r) {
    arm::InputValues inputs = testing::paper_inputs(r);
    inputs[2] = 0.0;
    return inputs;
  };
  const identify::Result result = run(nominal, nominal, protocol, random);
  const identify::Constant* gain = find(result, "segment_1.chamber_3.moment_gain");
  EXPECT_FALSE(gain->determined);
  EXPECT_TRUE(testing::says(gain->advice, "'chamber_3' (chamber 3 of segment_1) is never on"))
      << gain->advice;
  EXPECT_EQ(gain->value, gain->initial);
  EXPECT_TRUE(find(result, "segment_1.chamber_1.moment_gain")->determined);
}

TEST(Undetermined, KnotsThatNoTrialComesNearAreEachByThemselves) {
  const arm::Arm nominal = testing::shipped("hybrid_85mm");
  std::mt19937_64 random(6);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.1, random);
  testing::Protocol protocol;
  protocol.draw = [&](std::mt19937_64& r) {
    arm::InputValues inputs;
    for (const arm::ScalarInput& input : nominal.inputs.scalars)
      inputs.emplace_back(testing::uniform(r, 0.0, input.kind == arm::InputKind::kTension ? 1.5 : 9e3));
    return inputs;
  };
  identify::Options options;
  options.also_free = {"*.length", "*.rest_curvature.*"};
  const identify::Result result =
      identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
  int alone = 0;
  for (const identify::Combination& combination : result.undetermined) {
    for (const auto& [name, share] : combination.parts) {
      if (name < "segment_1.bending_stiffness.by_pressure.3" ||
          name > "segment_1.bending_stiffness.by_pressure.5")
        continue;
      EXPECT_EQ(combination.parts.size(), 1u) << combination.sentence;
      EXPECT_EQ(std::abs(share), 1.0);
      ++alone;
    }
  }
  EXPECT_EQ(alone, 3);
}

TEST(Undetermined, AVacuumThatIsNotRecordedIsNotFitted) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  std::mt19937_64 random(4);
  testing::Protocol protocol;
  protocol.draw = [](std::mt19937_64& r) {
    arm::InputValues inputs = testing::paper_inputs(r);
    inputs[3].reset();
    return inputs;
  };
  const identify::Result result = run(nominal, nominal, protocol, random);
  EXPECT_EQ(find(result, "segment_1.bending_stiffness.per_jamming_pressure"), nullptr);
  EXPECT_EQ(result.frames, 60u);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
}

TEST(Undetermined, WhatIsAskedForAndNotFittedIsSaid) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].axial_stiffness_n = 200.0;
  std::mt19937_64 random(4);
  testing::Protocol protocol;
  protocol.draw = testing::paper_inputs;
  protocol.payloads_kg = {0.2};
  identify::Options options;
  options.also_free = {"axial_stiffness"};
  options.held = {"*elongation"};
  const identify::Result result =
      identify::identify(nominal, testing::make_trials(nominal, protocol, random), options);
  EXPECT_EQ(find(result, "segment_1.axial_stiffness"), nullptr);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_TRUE(testing::says(result.warnings[0], "NOT FITTED: segment_1.axial_stiffness: EA needs"))
      << result.warnings[0];
}

TEST(Undetermined, AGainOfTheWrongSignIsSaid) {
  const arm::Arm nominal = testing::pneumatic_arm();
  arm::Arm truth = nominal;
  truth.segments[0].chambers[1].bending_direction_rad += M_PI;  // the hose sits on the other side
  std::mt19937_64 random(4);
  testing::Protocol protocol;
  protocol.draw = testing::paper_inputs;
  const identify::Result result = run(nominal, truth, protocol, random);
  const identify::Constant* gain = find(result, "segment_1.chamber_2.moment_gain");
  EXPECT_TRUE(gain->at_bound);
  EXPECT_FALSE(gain->determined);
  EXPECT_TRUE(testing::says(gain->advice, "bending direction")) << gain->advice;
}

/// Light, hanging and without payload: gains over EI are all that shows.
TEST(Undetermined, StiffnessThatNoLoadTellsStaysTheArmFilesAndGainsFollow) {
  arm::Arm truth = testing::pneumatic_arm();
  truth.segments[0].mass_per_length_kg_m = 1e-4;
  truth.segments[0].jamming_input.reset();
  truth.segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  truth.segments[0].bending_stiffness.per_min_pressure_nm2_per_pa = 0.0;
  arm::Arm nominal = truth;
  nominal.segments[0].bending_stiffness.base_nm2 *= 2.0;
  testing::Protocol protocol;
  protocol.payloads_kg = {0.0};
  protocol.draw = testing::paper_inputs;
  Options options;
  options.held = {"*.per_min_pressure"};
  for (const std::uint64_t seed : {3, 4, 5}) {
    std::mt19937_64 random(seed);
    const Result result = identify(nominal, testing::make_trials(truth, protocol, random), options);
    const Constant& stiffness = *testing::find(result, "segment_1.bending_stiffness.base");
    EXPECT_FALSE(stiffness.determined);
    EXPECT_TRUE(stiffness.kept);
    EXPECT_NEAR(stiffness.value, nominal.segments[0].bending_stiffness.base_nm2, 1e-9);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(result.arm.segments[0].chambers[k].moment_gain_nm_per_pa,
                  2.0 * truth.segments[0].chambers[k].moment_gain_nm_per_pa,
                  0.04 * truth.segments[0].chambers[k].moment_gain_nm_per_pa);
    const std::string text = describe(result);
    EXPECT_TRUE(testing::says(text, "the trials do not determine it: kept at 0.054 as in the arm file"))
        << text;
    EXPECT_TRUE(testing::says(text, "--hold '*.bending_stiffness.*'"));
  }
}

TEST(Undetermined, StiffnessToldByOwnWeightGoesWithTheStatedMass) {
  const arm::Arm truth = testing::pneumatic_arm();
  testing::Protocol protocol;
  protocol.payloads_kg = {0.0};
  protocol.draw = testing::paper_inputs;
  protocol.base = testing::horizontal();
  std::mt19937_64 random(6);
  const auto trials = testing::make_trials(truth, protocol, random);
  arm::Arm heavy = truth;
  heavy.segments[0].mass_per_length_kg_m *= 1.1;
  const Result with = identify(truth, trials, {}), more = identify(heavy, trials, {});
  const Constant &as_is = *testing::find(with, "segment_1.bending_stiffness.base"),
                 &heavier = *testing::find(more, "segment_1.bending_stiffness.base");
  ASSERT_TRUE(as_is.determined);
  EXPECT_NEAR(heavier.value / as_is.value, 1.1, 0.02);
  EXPECT_TRUE(testing::says(describe(with), "goes with the mass that the arm file states"));
}

}  // namespace
}  // namespace softarm::identify
