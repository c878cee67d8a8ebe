// The joint model of an arm that swings.
#include <gtest/gtest.h>

#include "diagnose/joint_model.h"
#include "effects/catalogue.h"
#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {
namespace {

using Path = std::vector<std::vector<model::Predicted>>;

/// Effects that act before the arm, on it, and with its motion.
void add_effects(const JointModel& model, const arm::Arm& arm, JointParameters& at) {
  struct Size {
    const char* id;
    double value;
  };
  for (const Size& size : {Size{"clock_offset", 0.02}, Size{"pressure_lag", 0.05}, Size{"tip_mass", 0.01},
                           Size{"inertia", 0.2}}) {
    const model::Effect* effect = effects::find(size.id);
    model::Values values = effect->grid(arm, model.rod()).front();
    values[0] = size.value;
    at.effects.push_back({effect, values});
  }
}

/// Of an arm whose modes are those of these parameters.
Path path_of(JointModel& model, const JointParameters& parameters) {
  Path path;
  model.predict(parameters, nullptr, path);
  model.find_modes(parameters, path);
  model.predict(parameters, &path, path);
  return path;
}

Eigen::VectorXd stacked(const JointModel& model, const Path& path) {
  std::vector<double> all;
  for (std::size_t k = 0; k < path[0].size(); ++k) {
    for (std::size_t i = 0; i < model.trials()[0].blocks[k].bodies.size(); ++i) {
      const Eigen::Vector3d p = path[0][k].p.col(static_cast<Eigen::Index>(i)) /
                                model.sd_m(0, k, model.trials()[0].blocks[k].bodies[i]);
      all.insert(all.end(), {p.x(), p.y(), p.z()});
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

TEST(Motion, DerivativesAreOfTheSwingNotOfItsEquilibria) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const model::Prepared prepared = model::prepare(arm, {testing::record(arm, testing::fast_demo(), "fast")});
  JointModel model(arm, prepared.trials, 1), calm(arm, prepared.trials, 1);
  JointParameters at = model.start();
  add_effects(model, arm, at);
  const Path path = path_of(model, at);
  const Linearised lin = model.linearise(at, &path), followed = calm.linearise(at, nullptr);
  const Eigen::VectorXd here = stacked(model, path);
  for (std::size_t j = 0; j < lin.columns.size(); ++j) {
    const JointUnknown& unknown = lin.columns[j];
    if (unknown.kind == JointUnknown::Kind::kMount) continue;
    constexpr double kStep = 0.01;
    JointParameters changed = at;
    set_unknown(changed, unknown, value_of(at, unknown) / unknown.scale + kStep);
    Path there;
    model.predict(changed, &path, there);
    const Eigen::VectorXd whole = (stacked(model, there) - here) / kStep;
    const auto column = static_cast<Eigen::Index>(j);
    const auto off = [&](const Linearised& by) {
      return (by.derivative[0].col(column).head(whole.size()) - whole).norm() / whole.norm();
    };
    EXPECT_LT(off(lin), 0.12 + 0.4 * off(followed)) << "unknown " << j;
  }
}

rig::Scenario by_hand(std::uint64_t seed) {
  rig::Scenario scenario = testing::demo(25.0);
  scenario.seed = seed;
  return scenario;
}

TEST(Motion, WhatAHandLeavesIsFollowed) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const model::Prepared prepared = model::prepare(arm, {testing::record(arm, by_hand(4), "by hand")});
  JointModel model(arm, prepared.trials, 1);
  Path path;
  model.predict(model.start(), nullptr, path);
  EXPECT_EQ(model.allow_for_motion(model.start(), path), 0U);
  EXPECT_FALSE(model.quasi_static());
  // By what the hand left, and without, in the seconds after it: the noise is that of the cameras alone.
  Path beside;
  JointModel hypothetical(arm, prepared.trials, 1);
  hypothetical.predict(hypothetical.start(), nullptr, beside);
  hypothetical.allow_for_motion(hypothetical.start(), beside, &model);
  double with = 0.0, without = 0.0, rows = 0.0;
  for (std::size_t k = 1; k < path[0].size(); ++k) {
    if (path[0][k].rest.t_s < 10.0 || path[0][k].rest.t_s > 12.0) continue;
    const std::vector<model::Seen>& bodies = prepared.trials[0].blocks[k].bodies;
    for (std::size_t i = 0; i < bodies.size() && model.uses(0, k); ++i, rows += 3.0) {
      const auto column = static_cast<Eigen::Index>(i);
      const double variance = bodies[i].white_sd_m * bodies[i].white_sd_m;
      with += (bodies[i].p_base - path[0][k].p.col(column)).squaredNorm() / variance;
      without += (bodies[i].p_base - beside[0][k].p.col(column)).squaredNorm() / variance;
    }
  }
  ASSERT_GT(rows, 100.0);
  EXPECT_LT(with / rows, 1.2);
  EXPECT_GT(without / rows, 1.5);
}

TEST(Motion, CleanTrialsInWhichAHandChangesThePayloadAreConsistent) {
  const arm::Arm arm = arm::load_arm_file(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  std::vector<trial::Trial> trials;
  for (const std::uint64_t seed : {4U, 5U, 6U})
    trials.push_back(testing::record(arm, by_hand(seed), "trial_" + std::to_string(seed)));
  const Diagnosis d = diagnose(arm, trials, {});
  EXPECT_EQ(d.verdict, Verdict::kConsistent) << d.summary;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_LT(d.after.shared_m, 3.75e-4 * arm.total_length_m());
}

}  // namespace
}  // namespace softarm::diagnose
