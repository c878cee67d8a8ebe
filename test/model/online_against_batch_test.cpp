// Every effect of the catalogue frame by frame, as the live node has it, against the same effect over a whole
// trial, as a diagnosis has it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"
#include "model/online_effects.h"
#include "softarm/arm/laws.h"

namespace softarm::effects::testing {
namespace {

constexpr double kDuration_s = 6.0, kRate_hz = 60.0, kPayload_kg = 0.08;
// What averaging over a tenth of a second, once the inputs and once the shapes, makes of a slow motion.
constexpr double kAverages_m = 2e-5, kShareOfEffect = 0.05, kUsualSizes = 2.0;

/// Slow, never still, with every input in use.
Eigen::VectorXd slow_inputs(const arm::Arm& arm, double t_s) {
  Eigen::VectorXd u(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const arm::InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(i)].kind;
    const double wave = 0.5 - 0.5 * std::cos(2.0 * M_PI * 0.2 * t_s + 1.5 * static_cast<double>(i));
    u[i] = wave * (kind == arm::InputKind::kTension  ? 3.0
                   : kind == arm::InputKind::kAngle  ? 0.8
                   : kind == arm::InputKind::kVacuum ? 40e3
                                                     : 20e3);
  }
  return u;
}

/// An arm that has what the effect acts on.
arm::Arm arm_for(const model::Effect& effect) {
  for (const arm::Arm& arm : {shipped_arm("semi_physical_200mm"), tendon_arm(), shipped_arm("two_segment"),
                              shipped_arm("cable_235mm"), arm_in_sections()}) {
    if (effect.applies_to(arm)) return arm;
  }
  throw std::runtime_error("no arm for " + effect.info().id);
}

/// Large sizes; of where it may be and when it may begin, what shows most of those that can be live.
model::Present shown_most(const model::Effect& effect, const arm::Arm& arm, const model::TrialData& trial,
                          model::ExtendedModel& batch) {
  const model::Info& info = effect.info();
  const Eigen::Matrix3Xd without = positions(predict(batch, arm, {}, trial));
  model::Present most{&effect, {}};
  double most_m = -1.0;
  for (model::Values values : effect.grid(arm, batch.rod())) {
    for (int k = 0; k < info.sizes; ++k) {
      const model::Parameter& size = info.parameters[static_cast<std::size_t>(k)];
      values[k] = std::min(kUsualSizes * size.usual, size.high);
    }
    if (!effect.live_obstacle(values).empty() && most_m >= 0.0) continue;
    const double shown_m = (positions(predict(batch, arm, {{&effect, values}}, trial)) - without).norm();
    const bool first_live = most_m >= 0.0 && !effect.live_obstacle(most.values).empty();
    if (!first_live && shown_m <= most_m) continue;
    most.values = values;
    most_m = shown_m;
  }
  return most;
}

class OnlineAgainstBatch : public ::testing::TestWithParam<std::string> {};

TEST_P(OnlineAgainstBatch, BothSeeTheSameBodies) {
  const model::Effect& effect = *find(GetParam());
  arm::Arm arm = arm_for(effect);
  arm.gravity_m_s2 = {0.0, 0.0, 9.80665};  // as the trial has it: the base is mocap's frame
  model::ExtendedModel batch(arm);
  const model::TrialData trial = made_up(
      arm, kDuration_s, [&](double t_s) { return slow_inputs(arm, t_s); }, kPayload_kg, kRate_hz);
  const std::vector<model::Present> present{shown_most(effect, arm, trial, batch)};
  model::OnlineEffects online(arm, present);
  const std::string obstacle = effect.live_obstacle(present[0].values);
  if (!obstacle.empty()) {
    ASSERT_EQ(online.notes().size(), 1u);
    EXPECT_NE(online.notes()[0].find("NOT in the model: " + obstacle), std::string::npos)
        << online.notes()[0];
    return;
  }
  const std::vector<model::Predicted> with = predict(batch, arm, present, trial);
  const std::vector<model::Predicted> without = predict(batch, arm, {}, trial);

  const Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  double largest_m = 0.0, effect_m = 0.0;
  for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
    ASSERT_TRUE(with[k].solved && without[k].solved);
    const model::Block& block = trial.blocks[k];
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(arm.bodies.size()));
    for (std::size_t i = block.first; i < block.last; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::VectorXd u = trial.series.inputs.col(column);
      const auto& driven = online.begin(100.0 + trial.series.t_s[column],
                                        arm::InputValues(u.data(), u.data() + u.size()), kPayload_kg, base);
      auto laws = arm::predict(arm, driven.inputs);
      const auto moments = arm::predict(arm, driven.moment_inputs);
      ASSERT_TRUE(laws && moments);
      for (std::size_t s = 0; s < laws->size(); ++s) {
        (*laws)[s].moment_nm = (*moments)[s].moment_nm;
        (*laws)[s].curvature_per_m = (*moments)[s].curvature_per_m;
      }
      ASSERT_TRUE(online.solve(*laws, *driven.payload_kg));
      online.keep();
      mean += online.bodies().p / static_cast<double>(block.last - block.first);
    }
    if (trial.series.t_s[static_cast<Eigen::Index>(block.first)] < 1.0) continue;  // memories fill
    largest_m = std::max(largest_m, (mean - with[k].p).colwise().norm().maxCoeff());
    effect_m = std::max(effect_m, (with[k].p - without[k].p).colwise().norm().maxCoeff());
  }
  EXPECT_GT(effect_m, 5e-5) << "a trial that does not show the effect compares nothing";
  EXPECT_LT(largest_m, kAverages_m + kShareOfEffect * effect_m) << "effect " << 1e3 * effect_m << " mm";
}

std::vector<std::string> all_ids() {
  std::vector<std::string> ids;
  for (const auto& effect : catalogue()) ids.push_back(effect->info().id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, OnlineAgainstBatch, ::testing::ValuesIn(all_ids()),
                         [](const ::testing::TestParamInfo<std::string>& one) { return one.param; });

}  // namespace
}  // namespace softarm::effects::testing
