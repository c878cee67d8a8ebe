// The menu of experiments: only what each arm can do.
#include "diagnose/experiment_menu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include "diagnose/joint_model.h"
#include "softarm/arm/arm_file.h"

namespace softarm::diagnose {
namespace {

using model::TrialData;

constexpr double kBlock_s = 0.1;

double largest(arm::InputKind kind) {
  switch (kind) {
    case arm::InputKind::kPressure:
      return 2e4;
    case arm::InputKind::kVacuum:
      return 4e4;
    case arm::InputKind::kTension:
      return 1.0;
    case arm::InputKind::kAngle:
      return 0.3;
  }
  return 0.0;
}

/// A trial of 20 s, hanging: inputs up and down one after the other.
TrialData recorded(const arm::Arm& arm, double payload_kg, bool with_vacuum = true) {
  TrialData data;
  data.name = "slow.bag";
  const Eigen::Index count = 1000;
  data.series.t_s = Eigen::VectorXd::LinSpaced(count, 0.0, 19.98);
  data.series.inputs.setZero(static_cast<Eigen::Index>(arm.inputs.scalars.size()), count);
  for (Eigen::Index k = 0; k < data.series.inputs.rows(); ++k) {
    const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(k)].kind;
    if (kind == arm::InputKind::kVacuum && !with_vacuum) continue;
    for (Eigen::Index i = 0; i < count; ++i)
      data.series.inputs(k, i) =
          largest(kind) *
          std::pow(std::sin(M_PI * (1.0 + static_cast<double>(k)) * data.series.t_s[i] / 20.0), 2);
  }
  data.series.moment_inputs = data.series.inputs;
  data.series.payload_kg = Eigen::VectorXd::Constant(count, payload_kg);
  for (std::size_t first = 0; first + 5 <= 1000; first += 5) {
    model::Block block;
    block.first = first;
    block.last = first + 5;
    block.begins = first == 0;
    block.gravity_base = {0.0, 0.0, 9.80665};
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      model::Seen seen;
      seen.body = static_cast<int>(b);
      seen.frames = 5;
      seen.white_sd_m = 2e-4;
      block.bodies.push_back(seen);
    }
    data.blocks.push_back(block);
  }
  return data;
}

std::set<std::string> ids(const std::vector<diagnose::Experiment>& menu) {
  std::set<std::string> all;
  for (const diagnose::Experiment& e : menu) all.insert(e.id);
  return all;
}

arm::Arm shipped(const std::string& name) {
  return arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/" + name + ".yaml");
}

TEST(ExperimentMenu, OfEveryShippedArmKeepsWithinWhatWasRecorded) {
  std::size_t arms = 0;
  for (const auto& file : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/config/arms")) {
    if (file.path().extension() != ".yaml") continue;
    SCOPED_TRACE(file.path().filename().string());
    const arm::Arm arm = arm::load_arm_file(file.path().string());
    const double payload_kg = std::min(0.02, arm.payload.range_kg.high);
    const std::vector<TrialData> trials{recorded(arm, payload_kg)};
    const std::vector<diagnose::Experiment> menu = diagnose::experiment_menu(arm, trials, kBlock_s);
    EXPECT_EQ(ids(menu).size(), menu.size()) << "each once";
    EXPECT_GE(menu.size(), 10u);
    const Eigen::VectorXd low = trials[0].series.inputs.rowwise().minCoeff(),
                          high = trials[0].series.inputs.rowwise().maxCoeff();
    for (const diagnose::Experiment& e : menu) {
      SCOPED_TRACE(e.id);
      EXPECT_FALSE(e.action.empty());
      const model::Series& series = e.trial.series;
      EXPECT_TRUE(series.inputs.allFinite());
      EXPECT_TRUE((series.inputs.array() >= low.replicate(1, series.inputs.cols()).array()).all());
      EXPECT_TRUE((series.inputs.array() <= high.replicate(1, series.inputs.cols()).array()).all());
      EXPECT_GE(series.payload_kg.minCoeff(), arm.payload.range_kg.low);
      EXPECT_LE(series.payload_kg.maxCoeff(), arm.payload.range_kg.high);
      ASSERT_FALSE(e.trial.blocks.empty());
      EXPECT_EQ(e.trial.blocks.back().last, static_cast<std::size_t>(series.t_s.size()));
      EXPECT_GE(series.t_s[series.t_s.size() - 1], 20.0);
      const model::Block& block = e.trial.blocks.front();
      EXPECT_NEAR(block.gravity_base.norm(), 9.80665, 1e-9);
      EXPECT_NEAR((block.q_base_mocap * arm.gravity_m_s2 - block.gravity_base).norm(), 0.0, 1e-9);
      EXPECT_EQ(block.bodies.size(), e.arm.bodies.size());
    }
    const bool vacuum =
        std::any_of(arm.inputs.scalars.begin(), arm.inputs.scalars.end(),
                    [](const arm::ScalarInput& i) { return i.kind == arm::InputKind::kVacuum; });
    EXPECT_EQ(ids(menu).count("vacuum_while_bent"), vacuum ? 1u : 0u);
    EXPECT_EQ(ids(menu).count("attitude_hanging"), 0u) << "it was recorded";
    EXPECT_EQ(ids(menu).count("attitude_side_down"), 1u);
    ++arms;
  }
  EXPECT_GE(arms, 8u);
}

TEST(ExperimentMenu, AVacuumThatWasNeverOnIsNotProposed) {
  const arm::Arm arm = shipped("semi_physical_200mm");
  EXPECT_EQ(ids(diagnose::experiment_menu(arm, {recorded(arm, 0.1)}, kBlock_s)).count("vacuum_while_bent"),
            1u);
  EXPECT_EQ(
      ids(diagnose::experiment_menu(arm, {recorded(arm, 0.1, false)}, kBlock_s)).count("vacuum_while_bent"),
      0u);
}

/// Of the pull at the tip that is proposed, N.
double pull_n(const arm::Arm& arm, double payload_kg) {
  for (const diagnose::Experiment& e :
       diagnose::experiment_menu(arm, {recorded(arm, payload_kg)}, kBlock_s)) {
    if (e.id != "pull_along") continue;
    std::istringstream words(e.action.substr(e.action.find(" with ") + 6));
    double value = 0.0;
    std::string unit;
    words >> value >> unit;
    return unit == "mN" ? 1e-3 * value : value;
  }
  return 0.0;
}

TEST(ExperimentMenu, PullsNoHarderThanTheArmIsKnownToBear) {
  arm::Arm arm = shipped("online_200mm");
  const double weight_n =
      9.80665 * (arm.segments[0].mass_per_length_kg_m * arm.segments[0].length_m + arm.tip_mass_kg);
  const double by_stiffness_n = pull_n(arm, 0.0);
  ASSERT_GT(by_stiffness_n, 0.0);
  ASSERT_LT(by_stiffness_n, weight_n);
  arm.segments[0].bending_stiffness.base_nm2 = 50.0;  // a wrong constant is no reason to pull with a tonne
  EXPECT_NEAR(pull_n(arm, 0.0), weight_n, 0.01 * weight_n);
  arm.payload.range_kg.high = 0.05;
  EXPECT_NEAR(pull_n(arm, 0.0), 0.49, 0.01);
  arm.segments[0].mass_per_length_kg_m = arm.tip_mass_kg = 0.0;
  arm.payload.range_kg.high = 5.0;
  EXPECT_NEAR(pull_n(arm, 0.3), 2.94, 0.02);
}

TEST(ExperimentMenu, VariesTheTrialThatDrivesTheArmMost) {
  const arm::Arm arm = shipped("online_200mm");
  TrialData still = recorded(arm, 0.0);
  still.name = "still.bag";
  still.series.inputs *= 0.1;
  still.series.moment_inputs = still.series.inputs;
  const std::vector<TrialData> trials{still, recorded(arm, 0.05)};
  const std::vector<diagnose::Experiment> menu = diagnose::experiment_menu(arm, trials, kBlock_s);
  const auto repeat =
      std::find_if(menu.begin(), menu.end(), [](const diagnose::Experiment& e) { return e.id == "repeat"; });
  ASSERT_NE(repeat, menu.end());
  EXPECT_THAT(repeat->action, ::testing::HasSubstr("slow.bag once more with a payload of 50.0 g"));
  // Out and back, as often as there is time for.
  const model::Series& series = repeat->trial.series;
  for (Eigen::Index i = 0; i < series.t_s.size(); i += 50) {
    const double t = series.t_s[i], there = std::min(t, 2.0 * 19.98 - t);
    EXPECT_NEAR(series.inputs(0, i), 2e4 * std::pow(std::sin(M_PI * there / 20.0), 2), 20.0);
  }
}

TEST(ExperimentMenu, OfArmsOfEveryKindCanBePredicted) {
  for (const char* name : {"semi_physical_200mm", "tendon_trunk", "cable_235mm", "pouch_arm"}) {
    SCOPED_TRACE(name);
    const arm::Arm arm = shipped(name);
    const std::vector<TrialData> trials{recorded(arm, 0.0)};
    std::size_t possible = 0, all = 0;
    for (const diagnose::Experiment& e : diagnose::experiment_menu(arm, trials, 0.5)) {
      const std::vector<TrialData> next{e.trial};
      diagnose::JointModel model(e.arm, next, 1);
      diagnose::JointParameters parameters = model.start();
      for (const auto& load : e.loads) parameters.effects.push_back({load.get(), model::Values()});
      EXPECT_EQ(model.columns(parameters).size(), model.columns(model.start()).size()) << e.id;
      std::vector<std::vector<model::Predicted>> predicted;
      model.predict(parameters, nullptr, predicted);
      const auto solved = std::count_if(predicted[0].begin(), predicted[0].end(),
                                        [](const model::Predicted& block) { return block.solved; });
      if (solved > 0.9 * static_cast<double>(e.trial.blocks.size())) ++possible;
      ++all;
    }
    EXPECT_GT(possible, 0.7 * static_cast<double>(all));
  }
}

TEST(ExperimentMenu, OfNoTrialWorthRepeatingIsEmpty) {
  const arm::Arm arm = shipped("online_200mm");
  EXPECT_TRUE(diagnose::experiment_menu(arm, {}, kBlock_s).empty());
}

}  // namespace
}  // namespace softarm::diagnose
