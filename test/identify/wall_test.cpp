// The wall as constants to be identified, with the state at the beginning of each trial: derivatives of
// predicted bodies, and what is found of an arm whose wall is known.
#include <gtest/gtest.h>

#include <cmath>

#include "arm/wall_memory.h"
#include "identify/law_model.h"
#include "synthetic.h"

namespace softarm::identify {
namespace {

using testing::find;

arm::Arm creeping() {
  arm::Arm arm = testing::pneumatic_arm();
  arm.segments[0].wall.bending = {{1.5, 0.3}};
  arm.segments[0].wall.axial = {{4.0, 0.4}};
  return arm;
}

arm::InputValues inputs_at(double t_s, double phase) {
  const auto step = [&](double every_s, double pa) {
    return std::fmod(t_s + phase, 2.0 * every_s) < every_s ? pa : 5e3;
  };
  return {step(4.0, 45e3), step(2.5, 30e3), step(3.5, 20e3), 0.0};
}

/// Frames at 10 Hz of an arm with that wall, which was somewhere else before.
trial::Trial recorded(const arm::Arm& truth, double phase, const Eigen::VectorXd& start,
                      std::mt19937_64& random) {
  testing::FrameMaker maker(truth);
  arm::WallMemory memory(truth.segments[0]);
  trial::Trial trial;
  double last_s = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double t_s = 0.1 * i;
    const arm::InputValues inputs = inputs_at(t_s, phase);
    const arm::SegmentPrediction laws = predict(truth, inputs)->front();
    const arm::WallDrive drive =
        wall_drive(truth.segments[0], laws, mean_pressure_pa(truth, truth.segments[0], inputs));
    if (i == 0) {
      memory.begin(drive, start);
    } else {
      memory.follow(t_s - last_s, drive);
    }
    last_s = t_s;
    const auto frame = maker.make_lagging(inputs, 0.1, testing::hanging(), memory.lag());
    if (!frame) continue;
    trial.frames.push_back(testing::with_noise(truth, *frame, random));
    trial.frames.back().stamp_ns = trial::to_nanoseconds(100.0 + t_s);
  }
  return trial;
}

std::vector<trial::Trial> trials_of(const arm::Arm& truth, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<trial::Trial> trials;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d start(0.6 * (k - 1.5), 0.3 * k, 0.001 * (k - 2));
    trials.push_back(recorded(truth, 1.3 * k, start, random));
    trials.back().name = "trial_" + std::to_string(k + 1);
  }
  return trials;
}

TEST(IdentifyWall, DerivativesOfBodiesByConstantsAndStarts) {
  arm::Arm arm = creeping();
  arm.segments[0].wall.slows_per_pa = 1e-5;
  std::vector<ConstantRef> constants = constants_of(arm);
  trial::StaticFrame frame;
  auto record = std::make_shared<trial::DriveRecord>();
  for (int i = 0; i < 40; ++i) {
    record->stamp_s.push_back(0.1 * i);
    record->inputs.push_back(inputs_at(0.1 * i, 0.7));
  }
  frame.drive = record;
  frame.stamp_s = 3.0;
  frame.inputs = record->inputs[30];
  frame.payload_kg = 0.03;
  frame.gravity_base = {3.0, -4.0, 8.0};
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) frame.bodies.emplace_back().body = i;
  LawModel model(arm, constants);
  Eigen::VectorXd start(3);
  start << 0.5, -0.3, 0.002;
  const auto at = [&](const Eigen::VectorXd& theta, const Eigen::VectorXd& from) {
    Prediction prediction;
    std::optional<model::Equilibrium> equilibrium;
    model.set(theta);
    model.set_start(0, from);
    EXPECT_TRUE(model.predict(frame, equilibrium, prediction));
    return prediction;
  };
  Eigen::VectorXd theta(static_cast<Eigen::Index>(constants.size()));
  for (Eigen::Index j = 0; j < theta.size(); ++j)
    theta[j] = value_of(arm, constants[static_cast<std::size_t>(j)]);
  const Prediction here = at(theta, start);
  const auto compare = [&](const Prediction& up, const Prediction& down, const Eigen::MatrixXd& dp, double h,
                           const std::string& name) {
    double largest = 0.0;
    for (int k = 0; k < here.p.cols(); ++k) {
      const Eigen::Vector3d difference = (up.p.col(k) - down.p.col(k)) / 2.0;
      EXPECT_LT((difference - h * dp.block<3, 1>(3 * k, 0)).norm(), 1e-3 * difference.norm() + 1e-7) << name;
      largest = std::max(largest, difference.norm());
    }
    EXPECT_GT(largest, 1e-7) << name;
  };
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const ConstantRef& c = constants[static_cast<std::size_t>(j)];
    if (!is_stated(arm, c)) continue;
    const double h = theta[j] != 0.0 ? 3e-3 * std::abs(theta[j]) : 1e-4 * allowed_range(arm, c).high;
    Eigen::VectorXd up = theta, down = theta;
    up[j] += h;
    down[j] -= h;
    compare(at(up, start), at(down, start), here.dp.col(j), h, name_of(arm, c));
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double h = k < 2 ? 0.05 : 5e-4;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(3, k);
    compare(at(theta, start + step), at(theta, start - step), here.dp_by_start.col(k), h,
            "start " + std::to_string(k));
  }
}

TEST(IdentifyWall, IsFoundWithTheStateAtTheBeginningOfEachTrial) {
  const arm::Arm truth = creeping();
  arm::Arm nominal = truth;
  nominal.segments[0].wall.bending = {{0.6, 0.15}};
  nominal.segments[0].wall.axial = {{8.0, 0.2}};
  Options options;
  options.free = {"*.wall.*", "*.moment_gain"};
  options.held_out_share = 0.0;
  options.frames.prefer_static = false;
  const Result result = identify(nominal, trials_of(truth, 3), options);
  EXPECT_TRUE(result.converged);
  for (const Constant& c : result.constants)
    EXPECT_NEAR(c.value, value_of(truth, c.ref), 4.0 * c.sd) << c.name;
  for (const char* name : {"segment_1.wall.bending_1.time", "segment_1.wall.bending_1.share"})
    EXPECT_TRUE(find(result, name)->determined) << name;
  ASSERT_EQ(result.starts.size(), 12U);
  for (std::size_t k = 0; k < 4; ++k) {
    const WallStart& x = result.starts[3 * k];
    EXPECT_EQ(x.trial, "trial_" + std::to_string(k + 1));
    EXPECT_EQ(x.element, "bending_1.x");
    EXPECT_NEAR(x.value, 0.6 * (static_cast<double>(k) - 1.5), 5.0 * x.sd) << x.trial;
    EXPECT_LT(x.sd, 0.5) << "less than the prior";
  }
  EXPECT_NE(describe(result).find("segment_1.wall.bending_1.x"), std::string::npos);
  EXPECT_NE(to_json(result).find("\"bending_1.x\""), std::string::npos);
}

}  // namespace
}  // namespace softarm::identify
