// Sensors of inputs that are noisy or off: constants without bias, intervals that hold.
#include "identify/input_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "synthetic.h"

namespace softarm::identify {
namespace {

std::vector<double> stamps(std::size_t count, double step_s) {
  std::vector<double> list;
  for (std::size_t i = 0; i < count; ++i) list.push_back(step_s * static_cast<double>(i));
  return list;
}

TEST(ScatterOf, FindsWhiteNoiseOnWhatMoves) {
  std::mt19937_64 random(1);
  const std::vector<double> at = stamps(600, 0.02);
  std::vector<double> value;
  for (const double t : at)
    value.push_back(30e3 + 10e3 * std::sin(3.0 * t) + 400.0 * testing::normal3(random).x());
  EXPECT_NEAR(scatter_of(at, value, false), 400.0, 50.0);
}

TEST(ScatterOf, CommandedValuesHaveNone) {
  const std::vector<double> at = stamps(600, 0.02);
  std::vector<double> held, ramp;
  for (std::size_t i = 0; i < at.size(); ++i) {
    held.push_back(5e3 * static_cast<double>(i / 7));  // NOLINT(bugprone-integer-division): a staircase
    ramp.push_back(100.0 * at[i]);
  }
  EXPECT_EQ(scatter_of(at, held, false), 0.0);
  EXPECT_NEAR(scatter_of(at, ramp, false), 0.0, 1e-9);
  EXPECT_EQ(scatter_of(stamps(12, 0.02), std::vector<double>(12, 1.0), false), 0.0) << "too few";
  EXPECT_EQ(scatter_of(std::vector<double>(100, 1.0), std::vector<double>(100, 1.0), false), 0.0)
      << "one stamp";
}

TEST(ScatterOf, ALoggerThatRepeatsASensorsValuesDoesNotHideItsNoise) {
  std::mt19937_64 random(2);
  const std::vector<double> at = stamps(3000, 0.005);
  std::vector<double> value;
  for (std::size_t i = 0; i < at.size(); ++i)
    value.push_back(i % 5 == 0 ? 30e3 + 10e3 * std::sin(2.0 * at[i]) + 400.0 * testing::normal3(random).x()
                               : value.back());
  EXPECT_NEAR(scatter_of(at, value, true), 400.0, 60.0);
  EXPECT_EQ(scatter_of(at, value, false), 0.0) << "may be commands";
}

TEST(InputErrors, DerivativeByInputsIsThatOfPredictions) {
  const arm::Arm arm = testing::pneumatic_arm();
  const std::vector<ConstantRef> constants = default_free(arm);
  LawModel model(arm, constants);
  Eigen::VectorXd theta(static_cast<int>(constants.size()));
  for (std::size_t j = 0; j < constants.size(); ++j) theta[static_cast<int>(j)] = value_of(arm, constants[j]);
  model.set(theta);
  trial::StaticFrame frame;
  frame.inputs = {32e3, 18e3, 25e3, 40e3};
  frame.payload_kg = 0.1;
  frame.gravity_base = {0.0, 0.0, 9.81};
  for (int body = 0; body < static_cast<int>(arm.bodies.size()); ++body)
    frame.bodies.emplace_back().body = body;
  const auto predicted = [&](const trial::StaticFrame& at) {
    Prediction out;
    std::optional<model::Equilibrium> state;
    EXPECT_TRUE(model.predict(at, state, out));
    return out;
  };
  predicted(frame);
  Eigen::MatrixXd dp, dtangent;
  model.derivative_by_laws(frame, dp, dtangent);
  const Eigen::MatrixXd laws = model.laws_by_inputs(frame, Eigen::VectorXd::Constant(4, 50.0));
  for (int k = 0; k < 4; ++k) {
    trial::StaticFrame low = frame, high = frame;
    const auto input = static_cast<std::size_t>(k);
    *low.inputs[input] -= 50.0;
    *high.inputs[input] += 50.0;
    const Prediction before = predicted(low), after = predicted(high);
    const Eigen::Matrix3Xd p = (after.p - before.p) / 100.0,
                           tangent = (after.tangent - before.tangent) / 100.0;
    const Eigen::VectorXd by = dp * laws.col(k), tangent_by = dtangent * laws.col(k);
    EXPECT_LT((by - Eigen::Map<const Eigen::VectorXd>(p.data(), p.size())).norm(), 1e-4 * by.norm() + 1e-12);
    EXPECT_LT((tangent_by - Eigen::Map<const Eigen::VectorXd>(tangent.data(), tangent.size())).norm(),
              1e-4 * tangent_by.norm() + 1e-12);
  }
}

/// Trials of the paper's inputs, whose chambers' sensors then show noise and the zero of their trial.
std::vector<trial::Trial> seen_by_sensors(const arm::Arm& truth, int count, double noise_pa, double zero_pa,
                                          int sessions, std::mt19937_64& random) {
  testing::Protocol protocol;
  protocol.trials = count;
  protocol.draw = testing::paper_inputs;
  std::vector<trial::Trial> made = testing::make_trials(truth, protocol, random), trials;
  for (int session = 0; session < sessions; ++session) {
    trial::Trial trial;
    trial.name = "session_" + std::to_string(session + 1);
    const Eigen::Vector3d zero = zero_pa * testing::normal3(random);
    for (std::size_t i = static_cast<std::size_t>(session); i < made.size();
         i += static_cast<std::size_t>(sessions)) {
      for (trial::Frame& frame : made[i].frames) {
        const Eigen::Vector3d off = zero + noise_pa * testing::normal3(random);
        for (std::size_t k = 0; k < 3; ++k) frame.inputs[k] = *frame.inputs[k] + off[static_cast<int>(k)];
        frame.stamp_ns = trial::to_nanoseconds(2.0 * static_cast<double>(trial.frames.size()));
        trial.frames.push_back(std::move(frame));
      }
    }
    trials.push_back(std::move(trial));
  }
  return trials;
}

struct Gains {
  int inside = 0, all = 0;
  double bias = 0.0;  ///< mean of value over truth, less 1

  void add(const Result& result, const arm::Arm& truth) {
    for (const Constant& c : result.constants) {
      if (c.ref.kind != ConstantKind::kMomentGain) continue;
      const double real = value_of(truth, c.ref);
      ++all;
      inside += std::abs(c.value - real) <= 1.959964 * c.sd ? 1 : 0;
      bias += c.value / real - 1.0;
    }
  }
  double share() const { return static_cast<double>(inside) / all; }
  double mean_bias() const { return bias / all; }
};

Options all_frames() {
  Options options;
  options.held_out_share = 0.0;
  options.held = {"*.bending_stiffness.*"};
  return options;
}

TEST(InputErrors, NoiseOfPressuresNoLongerMakesGainsTooSmall) {
  arm::Arm nominal = testing::pneumatic_arm();
  for (std::size_t k = 0; k < 3; ++k) nominal.inputs.scalars[k].noise_sd_si = 5e3;
  Gains exact, with;
  double misfit = 0.0, share = 0.0;
  constexpr int kArms = 20;
  for (int i = 0; i < kArms; ++i) {
    std::mt19937_64 random(3000 + static_cast<std::uint64_t>(i));
    arm::Arm truth = nominal;
    for (arm::Chamber& chamber : truth.segments[0].chambers)
      chamber.moment_gain_nm_per_pa *= testing::uniform(random, 0.8, 1.2);
    const auto trials = seen_by_sensors(truth, 80, 5e3, 0.0, 8, random);
    Options options = all_frames();
    const Result now = identify(nominal, trials, options);
    EXPECT_TRUE(now.converged);
    ASSERT_EQ(now.input_errors.size(), 3u);
    EXPECT_TRUE(now.input_errors[0].stated);
    misfit += now.misfit / kArms;
    share += now.noise_share / kArms;
    with.add(now, truth);
    options.exact_inputs = true;
    const Result before = identify(nominal, trials, options);
    EXPECT_TRUE(before.input_errors.empty());
    exact.add(before, truth);
  }
  RecordProperty("coverage_exact", std::to_string(exact.share()));
  RecordProperty("coverage", std::to_string(with.share()));
  RecordProperty("bias_exact", std::to_string(exact.mean_bias()));
  RecordProperty("bias", std::to_string(with.mean_bias()));
  RecordProperty("misfit", std::to_string(misfit));
  RecordProperty("share", std::to_string(share));
  EXPECT_LT(exact.mean_bias(), -0.03) << "otherwise there is nothing to cure";
  EXPECT_NEAR(with.mean_bias(), 0.0, 0.01);
  EXPECT_GE(with.share(), 0.88);
  EXPECT_LT(misfit, 1.3) << "the noise of the inputs explains what is beyond the cameras'";
  EXPECT_GT(share, 0.5);
}

TEST(InputErrors, ZerosOfTheTrialsAreFittedBeside) {
  arm::Arm nominal = testing::pneumatic_arm();
  for (std::size_t k = 0; k < 3; ++k) nominal.inputs.scalars[k].zero_sd_si = 2e3;
  std::mt19937_64 random(11);
  const arm::Arm truth = nominal;
  const auto trials = seen_by_sensors(truth, 60, 0.0, 2e3, 6, random);
  Options options = all_frames();
  const Result with = identify(nominal, trials, options);
  options.exact_inputs = true;
  const Result exact = identify(nominal, trials, options);
  EXPECT_LT(with.misfit, 1.2);
  EXPECT_GT(exact.misfit, 2.0 * with.misfit);
  ASSERT_EQ(with.input_errors.size(), 3u);
  for (const InputErrors& one : with.input_errors) {
    EXPECT_EQ(one.zero_sd, 2e3);
    ASSERT_EQ(one.zeros.size(), 6u);
    for (const FittedZero& zero : one.zeros) {
      EXPECT_LT(zero.sd, 1e3) << "the trials say more than the prior";
      EXPECT_LT(std::abs(zero.value), 3.5 * 2e3);
    }
  }
  for (const Constant& c : with.constants) EXPECT_NEAR(c.value, value_of(truth, c.ref), 4.0 * c.sd) << c.name;
  EXPECT_NE(describe(with).find("zero of chamber_1"), std::string::npos) << describe(with);
}

TEST(InputErrors, AZeroThatDoesWhatARestCurvatureDoesIsSaid) {
  // One chamber, always near one pressure: its zero and the rest curvature are one number.
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.inputs.scalars[0].zero_sd_si = 2e3;
  std::mt19937_64 random(12);
  testing::Protocol protocol;
  protocol.draw = [](std::mt19937_64& r) {
    return arm::InputValues{30e3 + testing::uniform(r, -1e3, 1e3), 20e3, 20e3, 0.0};
  };
  const auto trials = testing::make_trials(nominal, protocol, random);
  Options options = all_frames();
  options.free = {"*.rest_curvature.*"};
  const Result result = identify(nominal, trials, options);
  ASSERT_EQ(result.input_errors.size(), 1u);
  EXPECT_FALSE(result.input_errors[0].confused_with.empty()) << describe(result);
  EXPECT_NE(describe(result).find("cannot be told from segment_1.rest_curvature"), std::string::npos);
}

TEST(InputErrors, ExactSensorsChangeNothing) {
  const arm::Arm nominal = testing::pneumatic_arm();
  std::mt19937_64 random(13);
  testing::Protocol protocol;
  protocol.draw = testing::paper_inputs;
  const auto trials = testing::make_trials(nominal, protocol, random);
  Options options = all_frames();
  Result measured = identify(nominal, trials, options);
  EXPECT_EQ(measured.unmeasured_inputs.size(), 4u);
  EXPECT_TRUE(
      testing::says(describe(measured), "inputs taken as exact: chamber_1, chamber_2, chamber_3, vacuum;"));
  measured.unmeasured_inputs.clear();
  options.exact_inputs = true;
  EXPECT_EQ(to_json(measured), to_json(identify(nominal, trials, options)));
}

}  // namespace
}  // namespace softarm::identify
