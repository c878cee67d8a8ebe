// How sure an effect of the model is, all others given.
#include "diagnose/doubt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "diagnose/joint_model.h"
#include "diagnose/refits.h"
#include "effects/catalogue.h"

namespace softarm::diagnose {
namespace {

/// A fit with creep, of which two numbers are free: its share, 4 usual ones, and its time.
Linearised with_creep() {
  Linearised at;
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    if (effect->info().id != "creep") continue;
    model::Values values(4);
    values << 4.0 * effect->info().parameters[0].usual, 30.0, 0.5, 0.0;
    at.at.effects.push_back({effect.get(), values});
    for (int k = 0; k < 2; ++k) {
      const model::Parameter& parameter = effect->info().parameters[static_cast<std::size_t>(k)];
      JointUnknown c;
      c.kind = JointUnknown::Kind::kEffect;
      c.parameter = k;
      c.scale = parameter.usual;
      c.low = parameter.low;
      c.high = parameter.high;
      c.prior_sd = k == 0 ? 5.0 : 1.0;
      at.columns.push_back(c);
    }
  }
  at.information = Eigen::Matrix2d::Identity();
  at.gradient = Eigen::Vector2d::Zero();
  return at;
}

/// Standard deviations of 3 of the share and of 1 of the time, correlated.
Posterior with_correlation(double correlation) {
  Posterior posterior;
  posterior.unknowns.mean = Eigen::Vector2d::Zero();
  posterior.unknowns.covariance.resize(2, 2);
  posterior.unknowns.covariance << 9.0, 3.0 * correlation, 3.0 * correlation, 1.0;
  posterior.on_its_law = {posterior.unknowns};
  return posterior;
}

Between no_folds(std::size_t effects) {
  return {{}, std::vector<Spreads>(effects)};
}

double still_there(const Posterior& posterior) {
  const Doubt doubt = doubt_about(with_creep(), posterior, {}, no_folds(1), 40, 0.0);
  EXPECT_EQ(doubt.covariance.rows(), 2);
  return doubt.still_there.at(0);
}

TEST(Doubt, AShareThatIsKnownOnlyBesideATimeIsThere) {
  EXPECT_LT(still_there(with_correlation(0.0)), 0.1);  // 4 +- 3: as well nothing
  // Creep that is longer than the trials: a larger share with a longer time does the same, no share does not.
  EXPECT_GT(still_there(with_correlation(0.99)), 0.99);
  EXPECT_GT(still_there(with_correlation(-0.99)), 0.99);
}

/// Of many folds, so that what one unknown says of itself counts.
Spreads of_many(const Eigen::Vector2d& variance) {
  Spreads spreads;
  spreads.by_sequence = {variance, Eigen::Vector2d::Ones(), Eigen::Vector2d::Constant(1e6)};
  return spreads;
}

TEST(Doubt, NoEffectIsSurerThanFoldsAgree) {
  const Posterior posterior = with_correlation(0.99);
  Between between{of_many({4.0, 0.5}), {of_many({0.01, 0.0})}};
  const auto doubt = [&] { return doubt_about(with_creep(), posterior, {}, between, 40, 0.0); };
  EXPECT_GT(doubt().still_there.at(0), 0.99);
  EXPECT_DOUBLE_EQ(doubt().covariance(0, 0), 9.0);
  between.at_shapes[0] = of_many({9.0, 0.0});  // 4 +- 3, with the time held
  between.unknowns = of_many({4.0, 4.0});      // sd of 2 of the time, for 1
  EXPECT_LT(doubt().still_there.at(0), 0.1);
  EXPECT_NEAR(doubt().covariance(1, 1), 4.0, 1e-2);
  EXPECT_NEAR(doubt().covariance(0, 1), 0.99 * 3.0 * 2.0, 1e-2);
}

TEST(Doubt, AShareOfMassThatIsNotKnownInAnyArmIsNoFinding) {
  Linearised at;
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    if (effect->info().id != "inertia") continue;
    at.at.effects.push_back({effect.get(), Eigen::Vector2d(0.08, 0.0)});
    const model::Parameter& share = effect->info().parameters.front();
    JointUnknown c;
    c.kind = JointUnknown::Kind::kEffect;
    c.scale = share.usual;
    c.low = share.low;
    c.high = share.high;
    c.prior_sd = 5.0;
    at.columns.push_back(c);
  }
  at.information = Eigen::MatrixXd::Identity(1, 1);
  at.gradient = Eigen::VectorXd::Zero(1);
  Posterior posterior;
  posterior.unknowns.mean = Eigen::VectorXd::Zero(1);
  posterior.unknowns.covariance = Eigen::MatrixXd::Constant(1, 1, 1e-4);  // 0.08 +- 0.005
  posterior.on_its_law = {posterior.unknowns};
  EXPECT_GT(doubt_about(at, posterior, {}, no_folds(1), 40, 0.0).still_there.at(0), 0.99);
  EXPECT_LT(doubt_about(at, posterior, {}, no_folds(1), 40, 0.1).still_there.at(0), 0.1);
  at.at.effects[0].values[0] = 0.8;
  EXPECT_GT(doubt_about(at, posterior, {}, no_folds(1), 40, 0.1).still_there.at(0), 0.99);
}

TEST(Doubt, WhatThePosteriorMovesCountsAtTheFitsTime) {
  Posterior posterior = with_correlation(0.99);
  posterior.on_its_law[0].mean << -3.0,
      -1.0;  // along what the trials leave open: at the fit's time the share stays
  const double along = still_there(posterior);
  posterior.on_its_law[0].mean << -3.0, 0.0;
  EXPECT_GT(along, still_there(posterior));
  EXPECT_GT(along, 0.99);
}

TEST(MovedWithout, HoldsWhatMeansNothingWithoutTheEffect) {
  Standing standing{with_creep(), {}};
  standing.fit.information << 25.0, -24.9, -24.9, 25.0;
  standing.unseen.total_rms_m = 1e-3;
  standing.unseen.total_chi2 = 100.0;
  EXPECT_NEAR(moved_without_m(standing, 0), 1e-3 * std::sqrt(4.0 * 25.0 * 4.0 / 100.0), 1e-12);
}

}  // namespace
}  // namespace softarm::diagnose
