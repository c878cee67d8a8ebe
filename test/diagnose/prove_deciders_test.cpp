// The baselines of the proof: known answers of small linear problems, what they make of noise that is more
// than was stated, and of recordings with and without something hidden.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "diagnose/policy.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "prove/deciders.h"
#include "prove/group_lasso.h"
#include "recorded_case.h"

namespace softarm::prove {
namespace {

using diagnose::EffectList;
using diagnose::EvidenceData;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr double kLeft = 1e-3;  // of the arm's length, of what is as large as the noise

const model::Effect* effect(std::size_t number) {
  return effects::catalogue()[number].get();
}

/// n instants of three trials, m numbers each, two unknowns, effects with these numbers of sizes; the
/// residual is white noise.
EvidenceData made_up(Index n, Index m, const std::vector<int>& sizes, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto drawn = [&](Index rows, Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  EvidenceData data;
  data.residual = noise * drawn(n, m);
  data.features = drawn(n, 3);
  data.t_s = VectorXd::LinSpaced(n, 0.0, static_cast<double>(n));
  for (Index i = 0; i < n; ++i) data.trial.push_back(static_cast<std::size_t>(3 * i / n));
  const auto signature = [&] {
    const MatrixXd bend = data.features * drawn(3, m), wave = (data.features * drawn(3, m)).array().sin();
    return MatrixXd(0.5 * bend + wave);
  };
  for (int u = 0; u < 2; ++u) data.unknowns.push_back({nullptr, 0.1, 3.0, signature(), 0.0});
  for (std::size_t e = 0; e < sizes.size(); ++e)
    for (int k = 0; k < sizes[e]; ++k) data.effects.push_back({effect(e), 0.0, 5.0, signature(), kLeft});
  return data;
}

/// All of an instant's numbers below each other, in the directions of `bases`.
VectorXd stacked(const diagnose::Bases& bases, const MatrixXd& rows) {
  const MatrixXd turned = rows * bases.directions;
  return Eigen::Map<const VectorXd>(turned.data(), turned.size());
}

/// Covariance of noise, constants, background and forms, and the residual less the constants' mean, written
/// out.
struct WrittenOut {
  WrittenOut(const EvidenceData& data, const Weighed& model, const std::vector<bool>& free) {
    const diagnose::Bases bases = bases_of(data);
    const std::vector<MatrixXd> kernels = kernels_of(data);
    const Index n = data.residual.rows(), m = data.residual.cols();
    covariance.setZero(n * m, n * m);
    for (Index d = 0; d < m; ++d) {
      const diagnose::DirectionNoise& noise = model.noise[static_cast<std::size_t>(d)];
      covariance.block(n * d, n * d, n, n) =
          noise.variance *
          ((1.0 - noise.share) * MatrixXd::Identity(n, n) + noise.share * kernels[noise.kernel]);
    }
    off = stacked(bases, data.residual);
    for (const diagnose::Signature& s : data.unknowns) {
      const VectorXd moves = stacked(bases, s.moves);
      off -= s.mean * moves;
      covariance += s.prior_sd * s.prior_sd * moves * moves.transpose();
    }
    signatures.resize(n * m, static_cast<Index>(data.effects.size()));
    for (std::size_t e = 0; e < data.effects.size(); ++e) {
      const VectorXd moves = stacked(bases, data.effects[e].moves);
      signatures.col(static_cast<Index>(e)) = moves;
      if (free[data.unknowns.size() + e]) continue;
      const double sd = background_sd(data.effects[e], model.background);
      covariance += sd * sd * moves * moves.transpose();
    }
    for (const MatrixXd& done : data.done) {
      for (Index c = 0; c < bases.courses.cols(); ++c) {
        const VectorXd moves = stacked(bases, bases.courses.col(c).asDiagonal() * done);
        covariance += std::pow(diagnose::kPolicy.posterior.form, 2) * moves * moves.transpose();
      }
    }
  }
  MatrixXd covariance, signatures;
  VectorXd off;
};

TEST(ProveBic, DevianceIsTheDensityWrittenOut) {
  std::mt19937_64 random(3);
  EvidenceData data = made_up(24, 3, {1, 2, 1}, 1.0, random);
  data.residual += 2.0 * data.effects[1].moves;
  data.done = {3.0 * data.unknowns[0].moves};
  const Bic bic(data);
  const EffectList set{effect(1)};
  const Weighed found = bic.linear(set);
  const std::vector<bool> free = sizes_of(data, set);
  EXPECT_THAT(free, ElementsAre(false, false, false, true, true, false));
  const WrittenOut whole(data, found, free);
  const Eigen::LLT<MatrixXd> factor(whole.covariance);
  const MatrixXd x = whole.signatures.middleCols(1, 2);
  const Eigen::Matrix2d information =
      x.transpose() * factor.solve(x) + Eigen::Matrix2d(Eigen::Vector2d::Constant(1.0 / 25.0).asDiagonal());
  const Vector2d sizes = information.inverse() * (x.transpose() * factor.solve(whole.off));
  const VectorXd left = whole.off - x * sizes;
  const double expected = left.dot(factor.solve(left)) + sizes.squaredNorm() / 25.0 +
                          2.0 * factor.matrixLLT().diagonal().array().log().sum();
  EXPECT_NEAR(found.bic - price(data, set), expected, 1e-6 * std::abs(expected));
  EXPECT_LT(found.bic, bic.none().bic);
}

TEST(ProveBic, GroupsAreWeighedByTheCovarianceWrittenOut) {
  std::mt19937_64 random(4);
  EvidenceData data = made_up(24, 3, {1, 2, 1}, 1.0, random);
  data.done = {data.unknowns[0].moves, 2.0 * data.unknowns[1].moves};
  const Bic bic(data);
  const Grouped grouped = bic.grouped();
  EXPECT_THAT(grouped.effects, ElementsAre(effect(0), effect(1), effect(2)));
  EXPECT_THAT(grouped.columns,
              ElementsAre(std::vector<Index>{0}, std::vector<Index>{1, 2}, std::vector<Index>{3}));
  const WrittenOut whole(data, bic.none(), sizes_of(data, {}));
  const Eigen::LLT<MatrixXd> factor(whole.covariance);
  const MatrixXd gram = whole.signatures.transpose() * factor.solve(whole.signatures);
  const VectorXd score = whole.signatures.transpose() * factor.solve(whole.off);
  EXPECT_TRUE(grouped.gram.isApprox(gram, 1e-6)) << grouped.gram << "\n\n" << gram;
  EXPECT_TRUE(grouped.score.isApprox(score, 1e-6)) << grouped.score << "\n\n" << score;
}

TEST(ProveBic, MoreNoiseThanWasStatedIsNoAlarm) {
  int raw_alarms = 0, alarms = 0;
  for (unsigned draw = 0; draw < 8; ++draw) {
    std::mt19937_64 random(100 + draw);
    const EvidenceData data = made_up(90, 6, std::vector<int>(12, 1), 3.0, random);
    const Bic bic(data);
    double raw = 0.0, own = 0.0;  // what the best effect is worth
    for (const diagnose::Signature& s : data.effects) {
      const double z = s.moves.cwiseProduct(data.residual).sum() / s.moves.norm();
      raw = std::max(raw, z * z - price(data, {s.effect}));
      own = std::max(own, bic.none().bic - bic.linear({s.effect}).bic);
    }
    raw_alarms += raw > 0.0;
    alarms += own > 0.0;
  }
  EXPECT_GE(raw_alarms, 4);
  EXPECT_EQ(alarms, 0);
}

TEST(ProveBic, WhatIsTooSmallToMatterIsNoCandidate) {
  std::mt19937_64 random(5);
  EvidenceData data = made_up(40, 3, {1, 1}, 1.0, random);
  data.effects[0].left = 0.9 * diagnose::kPolicy.selection.trivial / data.effects[0].prior_sd;
  EXPECT_THAT(Bic(data).candidates(), ElementsAre(effect(1)));
}

TEST(ProveBic, ARefitSupportsWhatItsDataNeed) {
  std::mt19937_64 random(7);
  EvidenceData data = made_up(90, 6, {1, 2, 1}, 1.0, random);
  // A fit with the first two: their sizes are among its unknowns, and its residual is what they leave.
  EvidenceData refit = data;
  refit.effects.clear();
  for (int s = 0; s < 3; ++s)
    refit.unknowns.push_back({nullptr, 0.0, 5.0, data.effects[static_cast<std::size_t>(s)].moves, 0.0});
  const VectorXd sizes = (VectorXd(5) << 0.0, 0.0, 1.5, 0.02, -0.02).finished();
  data.residual += sizes[2] * data.effects[0].moves;
  refit.residual = data.residual;
  for (int s = 2; s < 5; ++s) refit.residual -= sizes[s] * refit.unknowns[static_cast<std::size_t>(s)].moves;
  refit.done = {sizes[2] * data.effects[0].moves,
                sizes[3] * data.effects[1].moves + sizes[4] * data.effects[2].moves};
  const EffectList set{effect(0), effect(1)};
  const Bic bic(data);
  const std::vector<double> worth = bic.supports(set, refit, {-1, -1, 0, 1, 1}, -sizes);
  EXPECT_GT(worth[0], 100.0);
  // It is two numbers that change next to nothing.
  EXPECT_NEAR(worth[1], -price(data, {effect(1)}), 15.0);
  EXPECT_LT(bic.refitted(set, refit, {false, false, true, true, true}).bic, bic.none().bic);
}

TEST(ProveBic, AnEffectGoesWithAllItsNumbers) {
  std::mt19937_64 random(8);
  EvidenceData data = made_up(90, 6, {1, 1}, 1.0, random);
  data.residual += 1.5 * data.effects[0].moves;
  EvidenceData refit = data;
  refit.effects.clear();
  refit.residual -= 1.5 * data.effects[0].moves;
  // A size, and a number of its shape that moves the bodies as the size does.
  refit.unknowns.push_back({nullptr, 0.0, 5.0, data.effects[0].moves, 0.0});
  refit.unknowns.push_back({nullptr, 0.0, 5.0, 0.5 * data.effects[0].moves, 0.0});
  const VectorXd absent = (VectorXd(4) << 0.0, 0.0, -1.5, 0.0).finished();
  EXPECT_GT(Bic(data).supports({effect(0)}, refit, {-1, -1, 0, 0}, absent)[0], 100.0);
}

TEST(ProveBic, WeightsAreThoseOfTheCriterion) {
  const EffectList one{effect(0)}, other{effect(1)};
  const diagnose::Posterior posterior =
      weights({{{}, 10.0, 0.0, {}}, {one, 4.0, 0.0, {}}, {other, 6.0, 0.0, {}}, {one, 5.0, 0.0, {}}});
  const double sum = std::exp(-5.0) + std::exp(-2.0) + std::exp(-3.0);
  EXPECT_NEAR(posterior.of(effect(0)), std::exp(-2.0) / sum, 1e-12);
  EXPECT_NEAR(posterior.of(effect(1)), std::exp(-3.0) / sum, 1e-12);
  EXPECT_EQ(posterior.sets.front().effects, one);
}

TEST(ProveGroupLasso, TakesAGroupWholeOrNotAtAll) {
  const std::vector<std::vector<Index>> columns{{0, 1}, {2}};
  const Eigen::Vector3d score(4.0, 0.5, 1.2);
  const double penalty = 1.5;
  const VectorXd x =
      group_lasso_at(Eigen::Matrix3d::Identity(), score, columns, penalty, Eigen::Vector3d::Zero());
  const double kept = 1.0 - penalty * std::sqrt(2.0) / score.head<2>().norm();
  // Alone the second would be below the penalty, as the third is.
  EXPECT_TRUE(x.isApprox(Eigen::Vector3d(4.0 * kept, 0.5 * kept, 0.0), 1e-9)) << x.transpose();
  EXPECT_NE(x[1], 0.0);
}

TEST(ProveGroupLasso, MeetsItsConditionsOfOptimality) {
  MatrixXd gram = MatrixXd::Identity(4, 4);
  gram.block<2, 2>(0, 2) << 0.5, 0.1, -0.2, 0.4;
  gram.block<2, 2>(2, 0) = gram.block<2, 2>(0, 2).transpose();
  const Eigen::Vector4d score(4.0, 3.0, 1.0, -3.0);
  const std::vector<std::vector<Index>> columns{{0, 1}, {2, 3}};
  const double penalty = 0.9, least = penalty * std::sqrt(2.0);
  const VectorXd x = group_lasso_at(gram, score, columns, penalty, Eigen::Vector4d::Zero());
  const VectorXd slope = score - gram * x;
  for (const Index g : {0, 2}) {
    EXPECT_LE(slope.segment<2>(g).norm(), least + 1e-6);
    const Vector2d own = x.segment<2>(g);
    ASSERT_GT(own.norm(), 0.0);
    EXPECT_TRUE(slope.segment<2>(g).isApprox(least * own.normalized(), 1e-6));
  }
}

TEST(ProveGroupLasso, ItsPathBeginsWithWhatIsThere) {
  std::mt19937_64 random(6);
  EvidenceData data = made_up(90, 6, {1, 2, 1, 1, 1, 1}, 1.0, random);
  data.residual += 0.7 * data.effects[1].moves - 0.7 * data.effects[2].moves;
  const std::vector<EffectList> path = group_lasso_path(Bic(data).grouped(), 4);
  ASSERT_FALSE(path.empty());
  EXPECT_THAT(path.front(), ElementsAre(effect(1)));
  for (const EffectList& set : path) EXPECT_LE(set.size(), 4u);
}

const Decision& of(const std::vector<Decision>& decisions, const std::string& method) {
  return *std::find_if(decisions.begin(), decisions.end(),
                       [&](const Decision& d) { return d.method == method; });
}

TEST(ProveDeciders, NameWhatIsThereAndNothingElse) {
  const auto plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3);
  for (const Decision& decision : decide(plain.arm, plain.trials, 0)) {
    EXPECT_FALSE(decision.alarm) << decision.method;
    EXPECT_TRUE(decision.effects.empty()) << decision.method;
  }
  const auto soft = diagnose::testing::recorded_case(
      "{count_weights: [0, 1], from: [base_compliance], size: [0.3, 0.6]}", 4);
  const std::vector<Decision> found = decide(soft.arm, soft.trials, 0);
  for (const char* method : {"bic", "lasso"}) {
    const Decision& decision = of(found, method);
    EXPECT_TRUE(decision.alarm) << method;
    ASSERT_FALSE(decision.effects.empty()) << method;
    EXPECT_EQ(decision.effects[0].effect, "base_compliance") << method;
    EXPECT_GT(decision.effects[0].probability, 0.9) << method;
    EXPECT_EQ(decision.ranking.front(), "base_compliance") << method;
  }
  EXPECT_TRUE(of(found, "gp").alarm);
  EXPECT_TRUE(of(found, "gp").effects.empty());
}

TEST(ProveDeciders, DecideTheSameAfterAnother) {
  const auto both = diagnose::testing::recorded_case(
      "{count_weights: [0, 0, 1], from: [base_compliance, rest_curvature], size: [0.3, 0.6]}", 5, 4, 8.0);
  diagnose::testing::Looked looked(both.arm, both.trials);
  diagnose::Standing standing{looked.baseline, {}};
  standing.unseen = diagnose::unseen(looked.model, standing.fit);
  const Look first = look(looked.model, std::move(standing), nullptr, {});
  const Decision before = group_lasso(looked.model, first, {});
  ASSERT_FALSE(bic_stepwise(looked.model, first, {}).effects.empty());
  const Decision after = group_lasso(looked.model, first, {});
  EXPECT_EQ(before.ranking, after.ranking);
  ASSERT_EQ(before.effects.size(), after.effects.size());
  for (std::size_t i = 0; i < before.effects.size(); ++i)
    EXPECT_EQ(before.effects[i].probability, after.effects[i].probability) << before.effects[i].effect;
}

}  // namespace
}  // namespace softarm::prove
