// Known constants come back, with intervals that mean what they say.
#include <gtest/gtest.h>

#include <cmath>

#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;

struct Coverage {
  int inside = 0, all = 0;
  double share() const { return static_cast<double>(inside) / all; }
};

void count(const identify::Result& result, const arm::Arm& truth, Coverage& coverage) {
  for (const identify::Constant& c : result.constants) {
    ++coverage.all;
    coverage.inside += std::abs(c.value - identify::value_of(truth, c.ref)) <= 1.959964 * c.sd ? 1 : 0;
  }
}

/// Every constant within `sds` of the truth, determined, and no further off than a share of its scale.
void expect_recovered(const identify::Result& result, const arm::Arm& truth, double sds, double share) {
  EXPECT_TRUE(result.converged);
  for (const identify::Constant& c : result.constants) {
    const double true_value = identify::value_of(truth, c.ref);
    EXPECT_NEAR(c.value, true_value, sds * c.sd) << c.name;
    EXPECT_NEAR(c.value, true_value, share * c.scale) << c.name;
    EXPECT_TRUE(c.determined) << c.name << ": sd " << c.sd << " of " << c.scale << "; " << c.advice;
  }
}

TEST(Recovery, HundredRandomArmsAreCoveredByTheirIntervals) {
  const arm::Arm nominal = testing::pneumatic_arm();
  Coverage coverage;
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    std::mt19937_64 random(1000 + static_cast<std::uint64_t>(i));
    const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.35, random);
    testing::Protocol protocol;
    protocol.trials = 20 + i % 11;
    protocol.draw = testing::paper_inputs;
    protocol.base = i % 3 == 0   ? testing::standing()
                    : i % 3 == 1 ? testing::hanging()
                                 : testing::horizontal();
    // A paper's load of 200 g, less where the arm stands and would fall over.
    protocol.payloads_kg = {0.0, i % 3 == 0 ? 0.05 : 0.2};
    identify::Options options;
    options.held_out_share = 0.0;
    const identify::Result result =
        identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
    EXPECT_EQ(result.constants.size(), 9u);
    count(result, truth, coverage);
    worst = std::max(worst, result.fitted.mean_m);
  }
  EXPECT_EQ(coverage.all, 900);
  RecordProperty("coverage", std::to_string(coverage.share()));
  EXPECT_GE(coverage.share(), 0.92);
  EXPECT_LE(coverage.share(), 0.98);
  EXPECT_LT(worst, 0.001) << "half a millimetre of noise per coordinate is 0.8 mm of distance";
}

TEST(Recovery, IntervalsStayHonestWhereTheModelIsNotPerfect) {
  // Each trial's gain is off by its own 3 % (a law that changes from day to day), beside the noise.
  const arm::Arm nominal = testing::pneumatic_arm();
  Coverage coverage, by_noise_alone;
  for (int i = 0; i < 25; ++i) {
    std::mt19937_64 random(2000 + static_cast<std::uint64_t>(i));
    const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
    testing::Protocol protocol;
    protocol.trials = 1;
    protocol.repeats = 2;
    protocol.draw = testing::paper_inputs;
    std::vector<trial::Trial> trials;
    for (int t = 0; t < 30; ++t) {
      arm::Arm today = truth;
      const double factor = 1.0 + 0.03 * testing::normal3(random).x();
      for (arm::Chamber& chamber : today.segments[0].chambers) chamber.moment_gain_nm_per_pa *= factor;
      trials.push_back(testing::make_trials(today, protocol, random).front());
    }
    identify::Options options;
    options.held_out_share = 0.0;
    const identify::Result result = identify::identify(nominal, trials, options);
    EXPECT_GT(result.uncertainty_factor, 2.0);
    count(result, truth, coverage);
    identify::Result narrow = result;
    for (identify::Constant& c : narrow.constants) c.sd /= result.uncertainty_factor;
    count(narrow, truth, by_noise_alone);
  }
  RecordProperty("coverage", std::to_string(coverage.share()));
  RecordProperty("coverage_by_noise_alone", std::to_string(by_noise_alone.share()));
  EXPECT_GE(coverage.share(), 0.90);
  EXPECT_LE(coverage.share(), 0.995);
  EXPECT_LT(by_noise_alone.share(), 0.8) << "otherwise the model error of this test is too small to matter";
}

TEST(Recovery, GrossErrorsDoNotMoveIt) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(5);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.3, random);
  testing::Protocol protocol;
  protocol.repeats = 4;
  protocol.draw = testing::paper_inputs;
  std::vector<trial::Trial> trials = testing::make_trials(truth, protocol, random);
  identify::Options options;
  options.held_out_share = 0.0;
  const identify::Result clean = identify::identify(nominal, trials, options);
  int bad = 0;
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      if (testing::uniform(random, 0.0, 1.0) > 0.1) continue;
      for (trial::BodyObservation& body : frame.bodies) body.p_mocap += Eigen::Vector3d(0.03, 0.02, 0.04);
      ++bad;
    }
  }
  ASSERT_GT(bad, 12);
  const identify::Result robust = identify::identify(nominal, trials, options);
  options.robust = false;
  const identify::Result plain = identify::identify(nominal, trials, options);
  double moved_plain = 0.0;
  for (std::size_t j = 0; j < clean.constants.size(); ++j) {
    const identify::Constant& c = clean.constants[j];
    EXPECT_NEAR(robust.constants[j].value, c.value, 1.5 * c.sd) << c.name;
    moved_plain = std::max(moved_plain, std::abs(plain.constants[j].value - c.value) / c.sd);
  }
  EXPECT_GT(moved_plain, 10.0);
  std::uint64_t aside = 0;
  for (const auto& [body, number] : robust.bodies_set_aside) aside += number;
  EXPECT_EQ(aside, 3u * static_cast<std::uint64_t>(bad));
}

TEST(Recovery, TendonsWithACentralChamber) {
  const arm::Arm nominal = testing::shipped("hybrid_85mm");
  std::mt19937_64 random(6);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  testing::Protocol protocol;
  protocol.trials = 60;
  protocol.payloads_kg = {0.0, 0.02, 0.05};
  protocol.base = testing::horizontal();
  protocol.repeats = 2;
  protocol.draw = [&](std::mt19937_64& r) {
    arm::InputValues inputs;
    for (const arm::ScalarInput& input : nominal.inputs.scalars) {
      const bool tension = input.kind == arm::InputKind::kTension;
      inputs.push_back(tension ? (testing::uniform(r, 0, 1) < 0.4 ? 0.0 : testing::uniform(r, 0.3, 2.5))
                               : 1e4 * std::floor(testing::uniform(r, 0.0, 5.0)));
    }
    return inputs;
  };
  identify::Options options;
  options.held_out_share = 0.0;
  const identify::Result result =
      identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
  ASSERT_NE(find(result, "segment_1.tendon_3.offset"), nullptr);
  ASSERT_NE(find(result, "segment_1.bending_stiffness.by_pressure.5"), nullptr);
  ASSERT_NE(find(result, "segment_1.axial_stiffness"), nullptr);
  ASSERT_EQ(find(result, "segment_1.bending_stiffness.base"), nullptr) << "the knots replace it";
  expect_recovered(result, truth, 4.0, 0.2);
}

TEST(Recovery, ServoCables) {
  const arm::Arm nominal = testing::shipped("cable_235mm");
  std::mt19937_64 random(7);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  testing::Protocol protocol;
  protocol.trials = 15;
  protocol.payloads_kg = {0.0, 0.02, 0.04};
  protocol.base = testing::horizontal();
  protocol.draw = [](std::mt19937_64& r) { return arm::InputValues{testing::uniform(r, 0.0, 0.5)}; };
  identify::Options options;
  options.held_out_share = 0.0;
  const identify::Result result =
      identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
  ASSERT_EQ(result.constants.size(), 2u);
  expect_recovered(result, truth, 4.0, 0.05);
}

TEST(Recovery, TwoSegments) {
  const arm::Arm nominal = testing::shipped("two_segment");
  std::mt19937_64 random(8);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  testing::Protocol protocol;
  protocol.trials = 60;
  protocol.payloads_kg = {0.0, 0.15};
  protocol.draw = [&](std::mt19937_64& r) {
    arm::InputValues inputs;
    for (const arm::ScalarInput& input : nominal.inputs.scalars) {
      const double on = testing::uniform(r, 0.0, 1.0) < 0.3 ? 0.0 : 1.0;
      const double size = input.kind == arm::InputKind::kTension ? 3.0
                          : input.kind == arm::InputKind::kAngle ? 0.4
                                                                 : 40e3;
      inputs.push_back(on * size * testing::uniform(r, 0.2, 1.0));
    }
    return inputs;
  };
  identify::Options options;
  options.held_out_share = 0.0;
  const identify::Result result =
      identify::identify(nominal, testing::make_trials(truth, protocol, random), options);
  EXPECT_GE(result.constants.size(), 8u);
  int determined = 0;
  for (const identify::Constant& c : result.constants) {
    EXPECT_NEAR(c.value, identify::value_of(truth, c.ref), 4.0 * c.sd) << c.name;
    determined += c.determined ? 1 : 0;
  }
  EXPECT_GE(determined, static_cast<int>(result.constants.size()) - 2);
  EXPECT_LT(result.fitted.mean_m, 0.0011);
}

TEST(Recovery, LengthAndRestCurvatureWhereAsked) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(9);
  arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  const identify::ConstantRef length{identify::ConstantKind::kLength, 0, 0},
      x{identify::ConstantKind::kRestCurvatureX, 0, 0}, y{identify::ConstantKind::kRestCurvatureY, 0, 0};
  identify::set_value(truth, length, 0.206);
  identify::set_value(truth, x, 0.4);
  identify::set_value(truth, y, -0.7);
  EXPECT_NEAR(truth.bodies[0].arclength_m, 0.206 / 3.0, 1e-6) << "bodies keep their fraction";
  EXPECT_NEAR(truth.segments[0].mass_per_length_kg_m * 0.206, 0.176, 1e-9) << "and the arm its mass";
  testing::Protocol protocol;
  protocol.draw = [](std::mt19937_64& r) {  // with the arm at rest now and then
    return testing::uniform(r, 0.0, 1.0) < 0.2 ? arm::InputValues{0.0, 0.0, 0.0, 0.0}
                                               : testing::paper_inputs(r);
  };
  const auto trials = testing::make_trials(truth, protocol, random);
  identify::Options options;
  options.held_out_share = 0.0;
  options.also_free = {"length", "rest_curvature.*"};
  EXPECT_EQ(identify::identify(nominal, trials, options).constants.size(), 12u) << "the last parts of names";
  options.also_free = {"length", "*.rest_curvature.*"};
  const identify::Result result = identify::identify(nominal, trials, options);
  ASSERT_EQ(result.constants.size(), 12u);
  expect_recovered(result, truth, 4.0, 0.3);
  EXPECT_NEAR(result.arm.bodies[2].arclength_m, result.arm.segments[0].length_m, 1e-9);
}

TEST(Recovery, AxialStiffnessWhereThePayloadStretchesTheArm) {
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].axial_stiffness_n = 200.0;
  std::mt19937_64 random(10);
  arm::Arm truth = nominal;
  truth.segments[0].axial_stiffness_n = 150.0;
  testing::Protocol protocol;
  protocol.draw = testing::paper_inputs;
  const auto trials = testing::make_trials(truth, protocol, random);
  identify::Options options;
  const std::string name = "segment_1.axial_stiffness";
  EXPECT_EQ(testing::find(identify::identify(nominal, trials, options), name), nullptr) << "only where asked";
  options.also_free = {"axial_stiffness"};
  const identify::Result result = identify::identify(nominal, trials, options);
  const identify::Constant* stiffness = testing::find(result, name);
  ASSERT_NE(stiffness, nullptr);
  EXPECT_TRUE(stiffness->determined);
  EXPECT_NEAR(stiffness->value, 150.0, 4.0 * stiffness->sd);
  EXPECT_LT(stiffness->sd, 20.0);
  EXPECT_EQ(*result.arm.segments[0].axial_stiffness_n, stiffness->value);

  protocol.payloads_kg = {0.0};
  const auto unloaded = testing::make_trials(truth, protocol, random);
  EXPECT_EQ(testing::find(identify::identify(nominal, unloaded, options), name), nullptr)
      << "as long as any, then";
  options.free = {"axial_stiffness"};
  EXPECT_THROW(identify::identify(nominal, unloaded, options), identify::IdentifyError);
}

}  // namespace
}  // namespace softarm::identify
