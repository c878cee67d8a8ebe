// The posterior over the catalogue on made-up signatures: against the density written out, and what it says
// of one effect, of none, of many small ones and of an error that no effect makes.
#include "diagnose/posterior.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <utility>

#include "diagnose/policy.h"
#include "effects/catalogue.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeft = 1e-3;  // of the arm's length, of what is as large as the noise

/// n instants of three trials, m numbers each, two unknowns, `effects` effects of one size: all signatures
/// are smooth in the features and of `strength` times the noise, the residual is white noise alone.
EvidenceData made_up(Index n, Index m, int effects, double strength, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto drawn = [&](Index rows, Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  EvidenceData data;
  data.residual = drawn(n, m);
  data.features = drawn(n, 3);
  data.t_s = VectorXd::LinSpaced(n, 0.0, static_cast<double>(n));
  for (Index i = 0; i < n; ++i) data.trial.push_back(static_cast<std::size_t>(3 * i / n));
  const auto signature = [&] {
    const MatrixXd bend = data.features * drawn(3, m), wave = (data.features * drawn(3, m)).array().sin();
    return MatrixXd(strength * (0.5 * bend + wave));
  };
  for (int u = 0; u < 2; ++u) data.unknowns.push_back({nullptr, 0.1, 3.0, signature(), 0.0});
  for (int e = 0; e < effects; ++e)
    data.effects.push_back(
        {effects::catalogue()[static_cast<std::size_t>(e)].get(), 0.0, 5.0, signature(), kLeft * strength});
  return data;
}

TEST(Posterior, BasesAreOfTheKernelsOverTimeByTrial) {
  std::mt19937_64 random(4);
  EvidenceData data = made_up(20, 3, 1, 0.7, random);
  const auto is_of_the_kernels = [&data](std::size_t trials) {
    const Bases bases = bases_of(data, 2);
    const std::vector<MatrixXd> kernels = kernels_of(data);
    const MatrixXd identity = MatrixXd::Identity(20, 20);
    ASSERT_EQ(bases.kernels.size(), kernels.size());
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      const math::BlockEigensystem& eigen = bases.kernels[k];
      EXPECT_EQ(eigen.vectors.size(), k == 0 ? trials : 1) << k;
      EXPECT_LT((eigen.back(eigen.turned(identity)) - identity).norm(), 1e-9) << k;
      EXPECT_LT((eigen.back(eigen.values.asDiagonal() * eigen.turned(identity)) - kernels[k]).norm(), 1e-7)
          << k;
    }
  };
  is_of_the_kernels(3);
  data.trial.assign(20, 0);
  is_of_the_kernels(1);
  data.trial = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 1, 1, 1, 4, 4, 4, 4, 4};  // one goes on later
  is_of_the_kernels(3);
}

TEST(Posterior, OnItsLawAnEffectHasNoForm) {
  std::mt19937_64 random(5);
  EvidenceData data = made_up(20, 3, 4, 0.7, random);
  const Bases bases = bases_of(data);
  const LinearGaussianModel without(data, bases);
  const MatrixXd first = 3.0 * data.unknowns[1].moves, second = 2.0 * data.unknowns[0].moves;
  data.done = {second};
  const LinearGaussianModel other(data, bases);
  data.done = {first};
  const LinearGaussianModel one(data, bases);
  data.done.push_back(second);
  const LinearGaussianModel both(data, bases);
  const double background = 2e-4;
  const std::vector<DirectionNoise> noise = both.evaluate({}, background).noise;
  const auto estimate = [&](const LinearGaussianModel& of) {
    return of.estimate(of.normal_equations(noise), {}, background);
  };
  const auto on_its_law = [&](const LinearGaussianModel& of, std::size_t effect) {
    return of.on_its_law(estimate(of), effect);
  };
  const auto same = [](const Gaussian& found, const Gaussian& expected, Index n) {
    const VectorXd mean = expected.mean.head(n);
    const MatrixXd covariance = expected.covariance.topLeftCorner(n, n);
    EXPECT_LT((found.mean.head(n) - mean).norm(), 1e-9 * mean.norm());
    EXPECT_LT((found.covariance.topLeftCorner(n, n) - covariance).norm(), 1e-9 * covariance.norm());
  };
  const Index none = estimate(without).mean.size(), of_one = estimate(one).mean.size();
  same(on_its_law(one, 0), estimate(without), none);
  same(on_its_law(both, 0), estimate(other), none);
  same(on_its_law(both, 1), estimate(one), of_one);
  EXPECT_GT(estimate(both).covariance(1, 1), 1.1 * on_its_law(both, 0).covariance(1, 1)) << "a form blurs it";
}

TEST(Posterior, AModelMayHaveTheEffectsOfAnother) {
  std::mt19937_64 random(11);
  const EvidenceData data = made_up(20, 3, 4, 0.7, random);
  EvidenceData refit = made_up(20, 3, 0, 0.7, random);
  refit.done = {2.0 * refit.unknowns[0].moves};
  const Bases bases = bases_of(data);
  const LinearGaussianModel others(data, bases);
  const LinearGaussianModel shared(refit, bases, 1, &others, data.effects[1].effect);
  refit.effects = data.effects;
  refit.effects.erase(refit.effects.begin() + 1);
  const LinearGaussianModel own(refit, bases);
  EXPECT_EQ(shared.effects(), own.effects());
  const EffectList present{data.effects[2].effect};
  const Marginal expected = own.evaluate(present, 2e-4), found = shared.evaluate(present, 2e-4);
  EXPECT_NEAR(found.log, expected.log, 1e-9 * std::abs(expected.log));
  EXPECT_LT((found.coefficients - expected.coefficients).norm(), 1e-9 * expected.coefficients.norm());
}

TEST(Posterior, SetsEvaluatedTogetherAreAsEvaluatedAlone) {
  std::mt19937_64 random(17);
  EvidenceData data = made_up(40, 4, 5, 0.7, random);
  data.residual += 1.5 * data.effects[2].moves;
  const Bases bases = bases_of(data);
  const LinearGaussianModel none(data, bases);
  data.unknowns.push_back({nullptr, 0.0, 5.0, data.effects[2].moves});
  const LinearGaussianModel refit(data, bases, 2, &none, data.effects[2].effect);
  const EffectList one{data.effects[1].effect}, two{data.effects[1].effect, data.effects[4].effect};
  const std::vector<DirectionNoise> noise = none.evaluate({}, 2e-4).noise;
  for (const auto& from : {std::vector<DirectionNoise>{}, noise}) {
    std::vector<Evaluated> together{
        {&none, {}, 1e-5}, {&refit, one, 2e-4}, {&none, one, 1e-5}, {&none, two, 2e-4}};
    evaluate(together, from, 2);
    for (const Evaluated& set : together) {
      const Marginal alone = set.about->evaluate(set.present, set.background, from);
      EXPECT_NEAR(set.marginal.log, alone.log, 1e-9 * std::abs(alone.log));
      EXPECT_LT((set.marginal.coefficients - alone.coefficients).norm(), 1e-9 * alone.coefficients.norm());
      ASSERT_EQ(set.marginal.noise.size(), alone.noise.size());
      for (std::size_t d = 0; d < alone.noise.size(); ++d)
        EXPECT_NEAR(set.marginal.noise[d].variance, alone.noise[d].variance, 1e-9 * alone.noise[d].variance);
    }
  }
}

TEST(Posterior, OverEffectsAloneTheEvidenceIsTheSame) {
  std::mt19937_64 random(19);
  EvidenceData data = made_up(40, 4, 5, 20.0, random);
  data.unknowns[0].log_weight = -0.3;
  data.done = {2.0 * data.unknowns[1].moves};
  const LinearGaussianModel model(data, bases_of(data));
  const NormalEquations sums = model.normal_equations(model.evaluate({}, 2e-4).noise);
  const NormalEquations over_effects = model.over_effects(sums);
  ASSERT_EQ(over_effects.score.size(), 5);
  const EffectList sets[] = {{}, {data.effects[1].effect}, {data.effects[1].effect, data.effects[4].effect}};
  for (const EffectList& set : sets) {
    for (const double background : kPolicy.posterior.background) {
      VectorXd unused;
      const double expected = model.integrate(sums, set, background, unused);
      EXPECT_NEAR(model.integrate_effects(over_effects, set, background), expected,
                  1e-9 * std::abs(expected));
    }
  }
}

TEST(Posterior, OneOfManyChambersIsAsMuchLessProbableBeforehand) {
  std::mt19937_64 random(7);
  EvidenceData data = made_up(40, 3, 4, 0.7, random);
  data.effects[1].moves = data.effects[0].moves;
  data.residual += 0.5 * data.effects[0].moves;
  const auto odds = [&data](const EffectList& against) {
    const Posterior found = posterior(data, {}, 1);
    const auto of = [&found](const EffectList& effects) {
      for (const EffectSet& set : found.sets)
        if (set.effects == effects) return set.probability;
      return 0.0;
    };
    return of({data.effects[0].effect}) / of(against);
  };
  const EffectList none, other{data.effects[1].effect};
  EXPECT_NEAR(odds(other), 1.0, 1e-9) << "two that do the same";
  const double before = odds(none);
  data.effects[0].log_choices = std::log(4.0);
  EXPECT_NEAR(odds(other), 1.0 / 4.0, 1e-9) << "in every resample of the trials, and so on average";
  // Some resamples are sure of it all the same.
  EXPECT_GT(odds(none), 1.1 * before / 4.0);
  EXPECT_LT(odds(none), before);
}

/// Clocks that drift are apart, too.
TEST(Posterior, TwoThingsAtOnceAreAsImprobableBeforehandAsTwoEffects) {
  std::mt19937_64 random(7);
  EvidenceData data = made_up(40, 3, 4, 0.7, random);
  data.effects[1].moves = data.effects[0].moves;
  data.residual += 0.5 * data.effects[0].moves;
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue())
    if (effect->info().of_clock_rates) data.effects[0].effect = effect.get();
  const Posterior found = posterior(data, {}, 1);
  const auto alone = [&](int e) {
    for (const EffectSet& set : found.sets)
      if (set.effects == EffectList{data.effects[static_cast<std::size_t>(e)].effect}) return set.probability;
    return 0.0;
  };
  EXPECT_NEAR(alone(0) / alone(1), kPolicy.posterior.expected / 4.0, 1e-9);
}

TEST(Posterior, LogLikelihoodByInstantAddsUp) {
  std::mt19937_64 random(3);
  const EvidenceData data = made_up(14, 3, 4, 0.7, random);
  const Bases bases = bases_of(data);
  const LinearGaussianModel model(data, bases);
  const Marginal marginal = model.evaluate({data.effects[1].effect}, 2e-4);
  const std::vector<MatrixXd> kernels = kernels_of(data);
  const Index n = data.residual.rows(), m = data.residual.cols();
  MatrixXd left = data.residual;
  for (std::size_t u = 0; u < 2; ++u)
    left -= marginal.coefficients[static_cast<Index>(u)] * data.unknowns[u].moves;
  for (std::size_t e = 0; e < data.effects.size(); ++e)
    left -= marginal.coefficients[static_cast<Index>(2 + e)] * data.effects[e].moves;
  left = left * bases.directions;
  VectorXd expected = VectorXd::Zero(n);
  double whole = 0.0;
  for (Index d = 0; d < m; ++d) {
    const DirectionNoise& noise = marginal.noise[static_cast<std::size_t>(d)];
    const MatrixXd covariance = noise.variance * ((1.0 - noise.share) * MatrixXd::Identity(n, n) +
                                                  noise.share * kernels[noise.kernel]);
    const Eigen::LLT<MatrixXd> factor(covariance);
    const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
    const VectorXd over = factor.solve(left.col(d));
    whole -= 0.5 * (log_determinant + left.col(d).dot(over));
    expected.array() -= 0.5 * (log_determinant / static_cast<double>(n) + left.col(d).array() * over.array());
  }
  const VectorXd by_instant = model.log_by_instant(marginal, bases);
  EXPECT_LT((by_instant - expected).norm(), 1e-6 * expected.norm());
  EXPECT_NEAR(by_instant.sum(), whole, 1e-6 * std::abs(whole));
}

TEST(Posterior, EvidenceIsTheDensityWrittenOut) {
  std::mt19937_64 random(3);
  EvidenceData data = made_up(14, 3, 4, 0.7, random);
  data.effects[2].unknown_sd = 0.4;
  data.done = {2.0 * data.unknowns[1].moves};
  const double background = 2e-4;
  const Bases bases = bases_of(data);
  const Marginal evidence = LinearGaussianModel(data, bases).evaluate({data.effects[1].effect}, background);
  const std::vector<MatrixXd> kernels = kernels_of(data);
  const Index n = data.residual.rows(), m = data.residual.cols();
  const MatrixXd axes =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(data.residual.transpose() * data.residual).eigenvectors();
  MatrixXd covariance = MatrixXd::Zero(n * m, n * m);
  for (Index d = 0; d < m; ++d) {
    const DirectionNoise& noise = evidence.noise[static_cast<std::size_t>(d)];
    covariance.block(n * d, n * d, n, n) = noise.variance * ((1.0 - noise.share) * MatrixXd::Identity(n, n) +
                                                             noise.share * kernels[noise.kernel]);
  }
  const auto stacked = [&](const MatrixXd& rows) {
    const MatrixXd turned = rows * axes;
    return VectorXd(Eigen::Map<const VectorXd>(turned.data(), n * m));
  };
  VectorXd mean = VectorXd::Zero(n * m);
  for (const Signature& s : data.unknowns) {
    const VectorXd moves = stacked(s.moves);
    mean += s.mean * moves;
    covariance += s.prior_sd * s.prior_sd * moves * moves.transpose();
  }
  for (std::size_t e = 0; e < data.effects.size(); ++e) {
    const VectorXd moves = stacked(data.effects[e].moves);
    const double sd = e == 1 ? data.effects[e].prior_sd : background_sd(data.effects[e], background);
    covariance += sd * sd * moves * moves.transpose();
  }
  for (Index c = 0; c < bases.courses.cols(); ++c) {
    const VectorXd moves = stacked(bases.courses.col(c).asDiagonal() * data.done[0]);
    covariance += std::pow(kPolicy.posterior.form, 2) * moves * moves.transpose();
  }
  const Eigen::LLT<MatrixXd> factor(covariance);
  const VectorXd off = stacked(data.residual) - mean;
  const double log = -0.5 * off.dot(factor.solve(off)) - factor.matrixLLT().diagonal().array().log().sum();
  EXPECT_NEAR(evidence.log, log, 1e-6 * std::abs(log));
}

TEST(Posterior, OfOneEffectOfNoneAndOfManySmallOnes) {
  int one_found = 0, none_named = 0, small_named = 0;
  constexpr int kDraws = 12;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::mt19937_64 random(100 + static_cast<unsigned>(draw));
    const EvidenceData none = made_up(90, 6, 12, 1.0, random);
    const Posterior of_none = posterior(none, {}, 1);
    for (const Signature& s : none.effects) none_named += of_none.of(s.effect) > 0.5;

    EvidenceData one = none;
    one.residual += 1.5 * one.effects[4].moves;
    const Posterior of_one = posterior(one, {}, 1);
    one_found += of_one.of(one.effects[4].effect) > 0.9;
    for (const Signature& s : one.effects) {
      if (s.effect != one.effects[4].effect) none_named += of_one.of(s.effect) > 0.5;
    }

    EvidenceData small = none;
    std::normal_distribution<double> normal;
    for (const Signature& s : small.effects) small.residual += 0.3 * normal(random) * s.moves;
    const Posterior of_small = posterior(small, {}, 1);
    for (const Signature& s : small.effects) small_named += of_small.of(s.effect) > 0.9;
  }
  EXPECT_EQ(one_found, kDraws);
  EXPECT_EQ(none_named, 0);
  EXPECT_LE(small_named, kDraws / 4);
}

// Small effects that no set names move the fit's unknowns, too: its own covariance does not know of them.
TEST(Posterior, IntervalsOfUnknownsKnowOfTheBackground) {
  int covered = 0, covered_by_fit = 0, count = 0;
  std::normal_distribution<double> normal;
  for (unsigned draw = 0; draw < 24; ++draw) {
    std::mt19937_64 random(300 + draw);
    EvidenceData data = made_up(90, 6, 12, 1.0, random);
    for (const Signature& s : data.effects) data.residual += 0.2 * normal(random) * s.moves;
    VectorXd truth(2);
    for (Index u = 0; u < 2; ++u) {
      truth[u] = 0.5 * normal(random);
      data.residual += truth[u] * data.unknowns[static_cast<std::size_t>(u)].moves;
    }
    Eigen::Matrix2d information = Eigen::Matrix2d::Identity() / 9.0;
    Eigen::Vector2d score = Eigen::Vector2d::Constant(0.1 / 9.0);
    for (Index i = 0; i < 2; ++i) {
      const MatrixXd& moves = data.unknowns[static_cast<std::size_t>(i)].moves;
      score[i] += moves.cwiseProduct(data.residual).sum();
      for (Index j = 0; j < 2; ++j)
        information(i, j) += moves.cwiseProduct(data.unknowns[static_cast<std::size_t>(j)].moves).sum();
    }
    const Eigen::Matrix2d of_fit = information.inverse();
    const Eigen::Vector2d at_fit = of_fit * score;
    const Posterior p = posterior(data, {}, 1);
    ASSERT_EQ(p.unknowns.mean.size(), 2);
    for (Index u = 0; u < 2; ++u, ++count) {
      covered += std::abs(p.unknowns.mean[u] - truth[u]) < 1.645 * std::sqrt(p.unknowns.covariance(u, u));
      covered_by_fit += std::abs(at_fit[u] - truth[u]) < 1.645 * std::sqrt(of_fit(u, u));
    }
  }
  EXPECT_GE(covered, 0.8 * count);
  EXPECT_LE(covered_by_fit, 0.6 * count);
}

// What drives the arm makes an error that none of the effects does; some of them resemble it by chance.
TEST(Posterior, AnErrorThatNoEffectMakesIsNoEffect) {
  int named = 0;
  for (int draw = 0; draw < 12; ++draw) {
    std::mt19937_64 random(200 + static_cast<unsigned>(draw));
    EvidenceData data = made_up(90, 6, 12, 1.0, random);
    std::normal_distribution<double> normal;
    const MatrixXd mix = MatrixXd::NullaryExpr(3, 6, [&] { return normal(random); });
    data.residual += 3.0 * (data.features * mix).array().cos().matrix();
    const Posterior p = posterior(data, {}, 1);
    for (const Signature& s : data.effects) named += p.of(s.effect) > 0.9;
  }
  EXPECT_LE(named, 1);
}

TEST(Posterior, TwoThatDoTheSameShareTheProbability) {
  std::mt19937_64 random(7);
  EvidenceData data = made_up(90, 6, 12, 1.0, random);
  data.effects[5].moves = data.effects[4].moves;
  data.residual += 1.5 * data.effects[4].moves;
  const Posterior p = posterior(data, {}, 1);
  const auto* one = data.effects[4].effect;
  const auto* other = data.effects[5].effect;
  EXPECT_NEAR(p.of(one), p.of(other), 0.05);
  EXPECT_GT(p.of_any({one, other}), 0.99);
  EXPECT_GT(p.instead(other, one), 0.3);
}

// Both move the bodies in the same way, along a curve that the linear model only begins: a fit with either of
// them explains all. That is no reason to have both.
TEST(Posterior, TwoRefitsThatExplainTheSameAreNotBothThere) {
  std::mt19937_64 random(11);
  EvidenceData data = made_up(90, 6, 12, 1.0, random);
  const MatrixXd noise = data.residual, begun = data.effects[4].moves;
  const MatrixXd all = 2.0 * begun + 3.0 * data.features.col(0).cwiseAbs2() * Eigen::RowVectorXd::Ones(6);
  data.effects[5].moves = begun;
  data.residual += all;
  std::vector<RefitEvidence> refits;
  for (const std::size_t e : {4U, 5U}) {
    RefitEvidence refit{data.effects[e].effect, data};
    refit.data.residual = noise;
    refit.data.effects.clear();
    refit.data.unknowns.push_back({nullptr, 0.0, 5.0, all / 2.0});
    refits.push_back(std::move(refit));
  }
  const Posterior p = posterior(data, refits, 1);
  EXPECT_GT(p.of_any({refits[0].effect, refits[1].effect}), 0.99);
  EXPECT_NEAR(p.of(refits[0].effect) + p.of(refits[1].effect), 1.0, 0.05);
}

// What is left by a fit with one effect looks as if another were there by what that does without the first;
// with it, it does something else.
TEST(Posterior, BesideARefitOthersDoWhatTheyDoAboutIt) {
  std::mt19937_64 random(12);
  EvidenceData data = made_up(90, 6, 12, 1.0, random);
  const MatrixXd one = data.effects[4].moves, other = data.effects[5].moves;
  const auto* const beside = data.effects[5].effect;
  RefitEvidence refit{data.effects[4].effect, data};
  refit.data.residual += 0.8 * other;
  refit.data.effects.clear();
  refit.data.unknowns.push_back({nullptr, 0.0, 5.0, one});
  data.residual += 2.0 * one + 0.8 * other;
  EXPECT_GT(posterior(data, {refit}, 1).of(beside), 0.9) << "by what it does without the first";
  refit.data.effects.push_back(data.effects[5]);
  refit.data.effects.back().moves = data.effects[6].moves;
  const Posterior p = posterior(data, {refit}, 1);
  EXPECT_GT(p.of(refit.effect), 0.9);
  EXPECT_LT(p.of(beside), 0.1);
}

// Beside a refit that leaves nothing, sets about the fit have probabilities that no double can say.
TEST(Posterior, UnknownsOfTheFitAreKnownHoweverProbableARefitIs) {
  std::mt19937_64 random(14);
  EvidenceData data = made_up(90, 6, 12, 1.0, random);
  RefitEvidence refit{data.effects[4].effect, data};
  refit.data.effects.clear();
  refit.data.unknowns.push_back({nullptr, 0.0, 5.0, data.effects[4].moves});
  data.residual *= 1e4;
  const Posterior p = posterior(data, {refit}, 1);
  EXPECT_GT(p.of(refit.effect), 0.999);
  ASSERT_EQ(p.unknowns.mean.size(), 2);
  EXPECT_TRUE(p.unknowns.mean.allFinite() && p.unknowns.covariance.allFinite());
}

// Usual sizes may move the bodies by sixty times the noise: a hundredth of one is then seen, and is no
// background where all the others are smaller than a thousandth.
TEST(Posterior, ASmallShareOfAUsualSizeIsNamedWhereAllElseIsRight) {
  std::mt19937_64 random(13);
  EvidenceData data = made_up(90, 6, 12, 60.0, random);
  data.residual += 0.015 * data.effects[3].moves;
  const Posterior p = posterior(data, {}, 1);
  EXPECT_GT(p.of(data.effects[3].effect), 0.9);
}

// As inertia's, of which a share is not known in any arm.
TEST(Posterior, WhatIsNotKnownOfAnEffectAnywayIsNoFinding) {
  std::mt19937_64 random(14);
  EvidenceData data = made_up(90, 6, 12, 20.0, random);
  data.effects[3].unknown_sd = 0.2;
  data.residual += 0.3 * data.effects[3].moves;
  EXPECT_LT(posterior(data, {}, 1).of(data.effects[3].effect), 0.1);
  data.residual += 3.0 * data.effects[3].moves;
  EXPECT_GT(posterior(data, {}, 1).of(data.effects[3].effect), 0.9) << "far more than that";
  data.residual -= 3.0 * data.effects[3].moves;
  data.effects[3].unknown_sd = 0.0;
  EXPECT_GT(posterior(data, {}, 1).of(data.effects[3].effect), 0.9) << "were it known";
}

// An effect of the fit whose law is a little other than the catalogue's, or that fades, leaves what another
// effect with a name may look like: that is no finding. One that has nothing of it is found as well as
// before.
TEST(Posterior, WhatGoesOtherwiseThanItsLawIsNoSecondEffect) {
  for (unsigned draw = 0; draw < 6; ++draw) {
    std::mt19937_64 random(700 + draw);
    EvidenceData data = made_up(90, 6, 12, 1.0, random);
    const MatrixXd done = 8.0 * data.effects[3].moves;
    const MatrixXd smooth = bases_of(data).courses.rightCols(2);
    const VectorXd gain = smooth.rowwise().sum(), fading = 2.0 * data.t_s.array() / 90.0 - 1.0;
    data.effects.erase(data.effects.begin() + 3);
    const std::size_t alike = draw % 2 == 0 ? 5 : 6;
    data.effects[alike].moves = kPolicy.posterior.form * (draw % 2 == 0 ? gain : fading).asDiagonal() * done;
    EvidenceData otherwise = data;
    otherwise.residual += 1.5 * data.effects[alike].moves;
    EXPECT_GT(posterior(otherwise, {}, 1).of(data.effects[alike].effect), 0.9) << draw;
    otherwise.done = {done};
    EXPECT_LT(posterior(otherwise, {}, 1).of(data.effects[alike].effect), 0.5) << draw;
    EvidenceData beside = data;
    beside.done = {done};
    beside.residual += 1.5 * data.effects[8].moves;
    EXPECT_GT(posterior(beside, {}, 1).of(data.effects[8].effect), 0.9) << draw;
  }
}

TEST(Posterior, SaysNothingOfTooFewInstants) {
  std::mt19937_64 random(9);
  EXPECT_TRUE(
      posterior(made_up(kPolicy.posterior.fewest_instants - 1, 3, 3, 1.0, random), {}, 1).sets.empty());
}

}  // namespace
}  // namespace softarm::diagnose
