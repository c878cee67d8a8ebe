// Trials that count as unseen: which others they are predicted without, by true refits, and with a background
// of small departures.
#include "diagnose/unseen.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "diagnose/background.h"
#include "diagnose/evidence_data.h"
#include "diagnose/flexible.h"
#include "diagnose/leftover.h"
#include "diagnose/policy.h"
#include "diagnose/screen.h"
#include "looked.h"
#include "recorded_case.h"
#include "trees.h"

namespace softarm::diagnose {
namespace {

using Eigen::VectorXd;
using Flags = std::vector<bool>;

testing::RecordedCase unseen_case(int trials) {
  return testing::recorded_case("{count_weights: [1]}", 43, trials, 10.0);
}

TEST(Unseen, ATrialIsPredictedWithoutItselfAndThoseOfItsCommands) {
  EXPECT_EQ(predicted_without({0, 1, 0}, {0.0, 60.0, 120.0}),
            (std::vector<Flags>{{true, false, true}, {false, true, false}, {true, false, true}}));
}

TEST(Unseen, WhereAllCommandsAreTheSameItIsPredictedByTheOtherTrials) {
  EXPECT_EQ(predicted_without({0, 0, 0}, {0.0, 60.0, 120.0}),
            (std::vector<Flags>{{true, false, false}, {false, true, false}, {false, false, true}}));
}

TEST(Unseen, OfThreeSessionsWithTheSameCommandsEachIsPredictedByTheOthers) {
  const double hour = 3600.0;
  EXPECT_EQ(predicted_without({0, 0, 0, 0}, {0.0, 60.0, 2 * hour, 4 * hour}),
            (std::vector<Flags>{{true, true, false, false},
                                {true, true, false, false},
                                {false, false, true, false},
                                {false, false, false, true}}));
}

TEST(Unseen, OfThreeSessionsEachIsPredictedByTheOthers) {
  const double hour = 3600.0;
  const std::vector<Flags> without =
      predicted_without({0, 1, 2, 3, 4}, {4 * hour, 0.0, 60.0, 2 * hour, 4 * hour + 60.0});
  EXPECT_EQ(without[0], (Flags{true, false, false, false, true}));
  EXPECT_EQ(without[1], (Flags{false, true, true, false, false}));
  EXPECT_EQ(without[3], (Flags{false, false, false, true, false}));
  // Two sessions are too few to do without one of them.
  EXPECT_EQ(predicted_without({0, 1, 2}, {0.0, 60.0, 4 * hour})[0], (Flags{true, false, false}));
}

TEST(Unseen, IsWhatAModelOfTheOtherTrialsAlonePredicts) {
  const testing::RecordedCase drawn = unseen_case(3);
  const model::Prepared prepared = model::prepare(drawn.arm, drawn.trials);
  JointModel all(drawn.arm, prepared.trials, 0);
  const Linearised at = all.fit(all.start(), {});
  const Unseen refitted = refitted_unseen(all, at);
  for (std::size_t t = 0; t < prepared.trials.size(); ++t) {
    std::vector<model::TrialData> others = prepared.trials;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(t));
    JointModel alone(drawn.arm, others, 0);
    const Linearised by_others = alone.fit(alone.start(), {});
    const VectorXd r = all.residual(t, all.predict_trial(by_others.at, t, &at.predicted[t]));
    const double chi2 = at.root_weight[t].cwiseProduct(r).squaredNorm();
    EXPECT_NEAR(refitted.chi2[t], chi2, 0.05 * chi2) << "trial " << t;
    EXPECT_GT(chi2, at.residual[t].squaredNorm());
  }

  double squares_m2 = 0.0, frames = 0.0;
  for (std::size_t t = 0; t < prepared.trials.size(); ++t) {
    Eigen::Index row = 0;
    for (const model::Block& block : prepared.trials[t].blocks) {
      for (const model::Seen& seen : block.bodies) {
        const double m2 = refitted.residual[t].segment<3>(row).squaredNorm();
        row += 3;
        squares_m2 += seen.frames * m2;
        frames += m2 > 0.0 ? seen.frames : 0;
      }
    }
  }
  EXPECT_NEAR(refitted.plain_rms_m, std::sqrt(squares_m2 / frames), 1e-9);
  EXPECT_GT(refitted.plain_rms_m, refitted.fitted_plain_rms_m);
}

TEST(Unseen, AFitWithoutSomeTrialsLeavesTheModelAsItWas) {
  const testing::RecordedCase drawn = unseen_case(3);
  testing::Looked looked(drawn.arm, drawn.trials);
  const double threshold = looked.model.threshold();
  const Unseen before = unseen(looked.model, looked.baseline);
  looked.model.fit_without(looked.baseline.at, {true, false, false}, looked.baseline);
  EXPECT_EQ(looked.model.threshold(), threshold);
  const Linearised again = looked.model.linearise(looked.baseline.at, &looked.baseline.predicted);
  EXPECT_NEAR(unseen(looked.model, again).total_chi2, before.total_chi2, 1e-3 * before.total_chi2);
}

TEST(BetweenFolds, IsHowFarFitsWithoutEachTrialLieApart) {
  const testing::RecordedCase drawn = unseen_case(4);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Spread between =
      between_folds(looked.model, looked.baseline, Flags(looked.baseline.columns.size(), false)).by_sequence;
  const std::size_t trials = drawn.trials.size();
  const Eigen::VectorXd known = looked.baseline.information.inverse().diagonal();
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(known.size()), expected = variance;
  for (std::size_t t = 0; t < trials; ++t) {
    Flags without(trials, false);
    without[t] = true;
    const Linearised others = looked.model.fit_without(looked.baseline.at, without, looked.baseline);
    const Eigen::VectorXd weight = known.cwiseQuotient(others.information.inverse().diagonal());
    EXPECT_LT(weight.maxCoeff(), 1.0) << "fewer trials know less";
    variance += weight.cwiseProduct((others.unknowns() - looked.baseline.unknowns()).cwiseAbs2());
    expected += VectorXd::Ones(known.size()) - weight;
  }
  ASSERT_EQ(between.variance.size(), variance.size());
  for (Eigen::Index j = 0; j < variance.size(); ++j) {
    const double sd = std::sqrt(variance[j]);
    EXPECT_NEAR(std::sqrt(between.variance[j]), sd, 0.15 * sd) << j;
    EXPECT_NEAR(between.expected[j], expected[j], 0.1 * expected[j]) << j;
    EXPECT_GE(between.freedom[j], 1.0) << j;
    EXPECT_LE(between.freedom[j], 3.0 + 1e-9) << j;
  }
}

TEST(BetweenFolds, WhatActsInOneTrialIsNotContradictedByTheOthers) {
  const testing::RecordedCase drawn = unseen_case(4);
  testing::Looked looked(drawn.arm, drawn.trials);
  Linearised at = looked.baseline;
  constexpr Eigen::Index kNumber = 0;  // that the first trial alone knows, beside what was known beforehand
  const auto forget = [](Eigen::MatrixXd& information, double but) {
    information.row(kNumber).setZero();
    information.col(kNumber).setZero();
    information(kNumber, kNumber) = but;
  };
  constexpr double kBefore = 1.0, kByTrial = 99.0, kStep = 0.1;
  forget(at.information, kBefore + kByTrial);
  at.gradient[kNumber] = 0.0;
  bool first = true;
  for (TimeStretch& stretch : at.stretches) {
    forget(stretch.information, first ? kByTrial : 0.0);
    stretch.gradient[kNumber] = first ? -kBefore * kStep : 0.0;  // without it, the number is kStep higher
    first = false;
  }
  const Spread between = between_folds(looked.model, at, Flags(at.columns.size(), false)).by_sequence;
  EXPECT_NEAR(std::sqrt(between.variance[kNumber]), kStep * std::sqrt(kBefore / (kBefore + kByTrial)),
              1e-3 * kStep);
  EXPECT_NEAR(between.expected[kNumber], kByTrial / (kBefore + kByTrial), 1e-6);
  EXPECT_NEAR(between.freedom[kNumber], 1.0, 1e-6);
}

TEST(BetweenFolds, OfOneTrialAreNone) {
  const testing::RecordedCase drawn = unseen_case(1);
  testing::Looked looked(drawn.arm, drawn.trials);
  const Spreads between =
      between_folds(looked.model, looked.baseline, Flags(looked.baseline.columns.size(), false));
  EXPECT_EQ(between.by_sequence.variance.size(), 0);
  EXPECT_EQ(between.by_session.variance.size(), 0);
}

/// A number that each trial measures by itself, alike well, and so far off their mean.
Linearised measured(const std::vector<double>& off) {
  Linearised at;
  JointUnknown number;
  number.kind = JointUnknown::Kind::kViscoelasticLag;
  number.low = -100.0;
  number.high = 100.0;
  at.columns = {number};
  for (std::size_t t = 0; t < off.size(); ++t) {
    TimeStretch stretch;
    stretch.trial = t;
    stretch.information = Eigen::MatrixXd::Ones(1, 1);
    stretch.gradient = VectorXd::Constant(1, off[t]);
    at.stretches.push_back(stretch);
  }
  at.information = Eigen::MatrixXd::Constant(1, 1, static_cast<double>(off.size()));
  at.gradient = VectorXd::Zero(1);
  return at;
}

TEST(BetweenFolds, SequencesThatCrossSessionsAreLookedAtEach) {
  const std::vector<std::size_t> sequence{0, 1, 2, 0, 1, 2, 0, 1, 2}, session{0, 0, 0, 1, 1, 1, 2, 2, 2};
  // Both differ: 12 squares of trials, of a mean of nine; of the means of three, two squares of one.
  const Spreads spreads = between_folds(measured({-2, -1, 0, -1, 0, 1, 0, 1, 2}), sequence, session, {false});
  EXPECT_NEAR(spreads.by_sequence.variance[0], 1.0 / 3.0, 1e-3);
  EXPECT_NEAR(spreads.by_session.variance[0], 1.0 / 3.0, 1e-3);
  EXPECT_NEAR(spreads.by_both.variance[0], 12.0 / (9.0 * 8.0), 1e-3);
  EXPECT_NEAR(spreads.by_sequence.freedom[0], 2.0, 1e-9);
  EXPECT_NEAR(spreads.by_both.freedom[0], 8.0, 1e-9);
  const Spreads sessions =
      between_folds(measured({-1, -1, -1, 0, 0, 0, 1, 1, 1}), sequence, session, {false});
  EXPECT_NEAR(sessions.by_sequence.variance[0], 0.0, 1e-9);
  EXPECT_NEAR(sessions.by_session.variance[0], 1.0 / 3.0, 1e-3);
}

TEST(BetweenFolds, TwoSequencesAreComparedAndTwoSessionsAreNot) {
  const Linearised at = measured({-1, 2, -1, 2, -1, -1});
  const Spreads spreads = between_folds(at, {0, 1, 0, 1, 0, 1}, {0, 0, 0, 1, 1, 1}, {false});
  // The means of both are two apart: the squared error of their mean is half of that, squared.
  EXPECT_NEAR(spreads.by_sequence.variance[0], 1.0, 1e-3);
  EXPECT_NEAR(spreads.by_sequence.expected[0], 1.0, 1e-3);
  EXPECT_NEAR(spreads.by_sequence.freedom[0], 1.0, 1e-9);
  EXPECT_EQ(spreads.by_session.variance.size(), 0);
  const Spreads sessions =
      between_folds(measured({-1, -1, 0, 0, 1, 1}), {0, 0, 0, 0, 0, 0}, {0, 0, 1, 1, 2, 2}, {false});
  EXPECT_NEAR(sessions.by_session.variance[0], 1.0 / 3.0, 1e-3);
}

TEST(BetweenFolds, TrialsOfOneSequenceAreComparedOneByOne) {
  const Spread spread =
      between_folds(measured({-1, 0, 1, 0}), {0, 0, 0, 0}, {0, 0, 0, 0}, {false}).by_sequence;
  EXPECT_NEAR(spread.variance[0], 2.0 / (4.0 * 3.0), 1e-3);
  EXPECT_NEAR(spread.freedom[0], 3.0, 1e-9);
}

TEST(BetweenFolds, OfWhatIsHeldNothingIsToBeExpected) {
  const Spread spread =
      between_folds(measured({-1, 0, 1, 0}), {0, 0, 0, 0}, {0, 0, 0, 0}, {true}).by_sequence;
  EXPECT_EQ(spread.variance[0], 0.0);
  EXPECT_EQ(spread.expected[0], 0.0);
}

/// Residuals of bodies, m, by a function of the instant; the noise is white, so less in longer means.
template <typename Of>
std::vector<VectorXd> residuals(const testing::Looked& looked, const Of& of) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 1e-4);
  std::vector<VectorXd> list;
  for (std::size_t t = 0; t < looked.prepared.trials.size(); ++t) {
    VectorXd r = VectorXd::Zero(looked.baseline.residual[t].size());
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < looked.prepared.trials[t].blocks.size(); ++k) {
      const double x = of(t, k), share = 1.0 / std::sqrt(looked.prepared.trials[t].blocks[k].means);
      for (std::size_t i = 0; i < looked.prepared.trials[t].blocks[k].bodies.size(); ++i, row += 3)
        r.segment<3>(row) = Eigen::Vector3d(x, 0.0, 0.0) +
                            share * Eigen::Vector3d(noise(random), noise(random), noise(random));
    }
    list.push_back(std::move(r));
  }
  return list;
}

TEST(Leftover, ABodyThatIsOffThroughoutStandsAloneAndOneSwingOfItDoesNot) {
  const testing::RecordedCase drawn = unseen_case(6);
  const testing::Looked looked(drawn.arm, drawn.trials);
  const auto at_tip = [&](const auto& of) {
    Unseen unseen;
    unseen.residual = residuals(looked, [](std::size_t, std::size_t) { return 0.0; });
    for (std::size_t t = 0; t < looked.prepared.trials.size(); ++t) {
      Eigen::Index row = 0;
      for (std::size_t k = 0; k < looked.prepared.trials[t].blocks.size(); ++k)
        for (const model::Seen& seen : looked.prepared.trials[t].blocks[k].bodies) {
          if (seen.body == 3) unseen.residual[t][row] += of(t, k);
          row += 3;
        }
    }
    return leftover(looked.model, looked.baseline, unseen);
  };
  const Leftover throughout = at_tip([](std::size_t, std::size_t) { return 5e-4; });
  EXPECT_EQ(throughout.lone_body, 3);
  EXPECT_NEAR(throughout.lone_m, 5e-4, 0.5e-4);
  EXPECT_GT(throughout.lone_z, kPolicy.verdict.shared_z);
  // The first mean at rest: of a size that makes it as large on the whole.
  const Leftover once = at_tip([](std::size_t t, std::size_t k) { return t == 2 && k == 0 ? 3e-3 : 0.0; });
  EXPECT_EQ(once.lone_body, 3);
  EXPECT_GT(once.lone_m, 2e-4);
  EXPECT_LT(once.lone_z, kPolicy.verdict.shared_z);
  const Leftover nothing = at_tip([](std::size_t, std::size_t) { return 0.0; });
  EXPECT_EQ(nothing.lone_body, -1);
  EXPECT_EQ(nothing.lone_m, 0.0);
}

TEST(Ceiling, LearnsLoopsWideAndNarrowAndNothingOfNoise) {
  const testing::RecordedCase drawn = unseen_case(6);
  const testing::Looked looked(drawn.arm, drawn.trials);
  for (const double width : {1.5e4, 2.5e3}) {  // Pa, of pressures up to 5e4: a wall, a valve
    double held = 0.0;
    const auto loop = [&](std::size_t t, std::size_t k) {
      const double now = looked.baseline.predicted[t][k].instant.inputs[0];
      held = k == 0 ? now : std::clamp(held, now - 0.5 * width, now + 0.5 * width);
      return 1e-3 * (now - held) / width;
    };
    EXPECT_GT(ceiling(looked.model, looked.baseline, residuals(looked, loop), 0), 0.6) << width;
  }
  const auto nothing = [](std::size_t, std::size_t) { return 0.0; };
  EXPECT_LT(ceiling(looked.model, looked.baseline, residuals(looked, nothing), 0), 0.01);
}

TEST(Ceiling, OfSeveralAtOnceIsThatOfEach) {
  const testing::RecordedCase drawn = unseen_case(6);
  const testing::Looked looked(drawn.arm, drawn.trials);
  const auto bend = [&](std::size_t t, std::size_t k) {
    return 2e-8 * looked.baseline.predicted[t][k].instant.inputs[0];
  };
  const std::vector<VectorXd> nothing = residuals(looked, [](std::size_t, std::size_t) { return 0.0; }),
                              something = residuals(looked, bend);
  Linearised driven_otherwise = looked.baseline;
  for (auto& trial : driven_otherwise.predicted)
    for (model::Predicted& one : trial) one.instant.inputs = one.instant.inputs.cwiseAbs2().eval();
  const std::vector<double> shares =
      ceilings(looked.model,
               {{looked.baseline, nothing}, {driven_otherwise, something}, {looked.baseline, something}}, 2);
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_NEAR(shares[0], ceiling(looked.model, looked.baseline, nothing, 1), 1e-9);
  EXPECT_NEAR(shares[1], ceiling(looked.model, driven_otherwise, something, 1), 1e-9);
  EXPECT_NEAR(shares[2], ceiling(looked.model, looked.baseline, something, 1), 1e-9);
  EXPECT_GT(shares[2], shares[0] + 0.3);
}

/// For trees: inputs, what follows them, and plays of them, of each instant.
struct Told {
  std::vector<VectorXd> now;
  std::vector<std::size_t> trial;

  explicit Told(const testing::Looked& looked) {
    for (std::size_t t = 0; t < looked.prepared.trials.size(); ++t) {
      std::vector<VectorXd> memory;
      for (const model::Predicted& one : looked.baseline.predicted[t]) {
        const VectorXd& u = one.instant.inputs;
        if (memory.empty()) memory.assign(7, u);
        for (std::size_t i = 0; i < 3; ++i)
          memory[i] += (1.0 - std::exp(-one.instant.dt_s / kTimes_s[i])) * (u - memory[i]);
        for (std::size_t i = 0; i < 4; ++i)
          memory[3 + i] = memory[3 + i]
                              .cwiseMax((u.array() - 0.5 * kWidths_pa[i]).matrix())
                              .cwiseMin((u.array() + 0.5 * kWidths_pa[i]).matrix());
        VectorXd all(8 * u.size());
        all.head(u.size()) = u;
        for (std::size_t i = 0; i < 7; ++i)
          all.segment((1 + static_cast<Eigen::Index>(i)) * u.size(), u.size()) = u - memory[i];
        now.push_back(std::move(all));
        trial.push_back(t);
      }
    }
  }

  static constexpr double kTimes_s[] = {0.3, 1.0, 4.0};
  static constexpr double kWidths_pa[] = {1e3, 2.5e3, 7.5e3, 2e4};
};

/// Share of the mean square that trees learn, each trial from those of other commands; of the first body.
double share_of_trees(const testing::Looked& looked, const std::vector<VectorXd>& residual) {
  const Told told(looked);
  const std::vector<std::size_t>& sequence = looked.model.sequences();
  Eigen::MatrixXd x(static_cast<Eigen::Index>(told.now.size()), told.now.front().size());
  VectorXd y(x.rows());
  for (Eigen::Index i = 0, row = 0; i < x.rows(); ++i) {
    const std::size_t t = told.trial[static_cast<std::size_t>(i)];
    if (i > 0 && t != told.trial[static_cast<std::size_t>(i - 1)]) row = 0;
    const std::size_t k = static_cast<std::size_t>(std::count(told.trial.begin(), told.trial.begin() + i, t));
    x.row(i) = told.now[static_cast<std::size_t>(i)];
    y[i] = residual[t][row];
    row += 3 * static_cast<Eigen::Index>(looked.prepared.trials[t].blocks[k].bodies.size());
  }
  double left = 0.0;
  for (std::size_t s = 0; s < 3; ++s) {
    testing::Trees::Rows others, own;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      (sequence[told.trial[static_cast<std::size_t>(i)]] % 3 == s ? own : others).push_back(i);
    const testing::Trees trees(x, y, others);
    for (const Eigen::Index i : own) left += std::pow(y[i] - trees.at(x.row(i)), 2);
  }
  return 1.0 - left / y.squaredNorm();
}

TEST(Ceiling, IsNoWorseThanTreesOverPlaysAndWhatFollows) {
  const testing::RecordedCase drawn = unseen_case(6);
  const testing::Looked looked(drawn.arm, drawn.trials);
  const auto instant = [&](std::size_t t, std::size_t k) -> const model::Instant& {
    return looked.baseline.predicted[t][k].instant;
  };
  double held = 0.0;
  const std::function<double(std::size_t, std::size_t)> made[] = {
      [&](std::size_t t, std::size_t k) {  // a valve that sticks
        const double now = instant(t, k).inputs[1];
        held = k == 0 ? now : std::clamp(held, now - 1e3, now + 1e3);
        return 1e-6 * (now - held);
      },
      [&](std::size_t t, std::size_t k) {  // a wall that follows
        const double now = instant(t, k).inputs[2];
        held = k == 0 ? now : held + (1.0 - std::exp(-instant(t, k).dt_s / 2.0)) * (now - held);
        return 1e-7 * (now - held);
      },
      [&](std::size_t t, std::size_t k) { return 5e-7 * (std::min(2e3, instant(t, k).inputs[0]) - 1e3); },
      [&](std::size_t t, std::size_t k) {
        return 1e-12 * instant(t, k).inputs[0] * (instant(t, k).inputs[1] - 1e4);
      }};
  for (const auto& of : made) {
    const std::vector<VectorXd> residual = residuals(looked, of);
    const double trees = share_of_trees(looked, residual);
    const double share = ceiling(looked.model, looked.baseline, residual, 0);
    // They know widths and times near these, and a sharp edge suits nothing better.
    EXPECT_GT(share, trees - (&of - made == 2 ? 0.1 : 0.05)) << &of - made;
    EXPECT_GT(std::max(share, trees), 0.2) << &of - made << ": neither learns anything: compares nothing";
  }
}

TEST(Ceiling, DoesNotLearnWhatIsAnewInEveryTrial) {
  const testing::RecordedCase drawn = unseen_case(6);
  const testing::Looked looked(drawn.arm, drawn.trials);
  const double of_trial[] = {1e-3, -1e-3, 0.6e-3, -1.2e-3, 0.4e-3, -0.8e-3};
  const auto anew = [&](std::size_t t, std::size_t) { return of_trial[t]; };
  EXPECT_LT(ceiling(looked.model, looked.baseline, residuals(looked, anew), 0), 0.3);
}

TEST(Ceiling, TriesNoCommandsThatItLearntFrom) {
  testing::RecordedCase drawn = unseen_case(3);
  const std::vector<trial::Trial> once = drawn.trials;
  for (trial::Trial again : once) {
    again.name += "_again";
    drawn.trials.push_back(std::move(again));
  }
  const testing::Looked looked(drawn.arm, drawn.trials);
  ASSERT_EQ(looked.model.sequences(), (std::vector<std::size_t>{0, 1, 2, 0, 1, 2}));
  // The same whenever these commands come, and anew in others.
  const auto of_sequence = [&](std::size_t t, std::size_t k) {
    const double phase = 0.3 * static_cast<double>(k) + 2.0 * static_cast<double>(t % 3);
    return 1e-3 * (t % 3 == 1 ? -1.0 : 1.0) * std::cos(phase);
  };
  EXPECT_LT(ceiling(looked.model, looked.baseline, residuals(looked, of_sequence), 0), 0.3);
}

/// Every effect at a small size of its own, beside noise.
std::vector<VectorXd> with_small_departures(testing::Looked& looked,
                                            const std::vector<model::Present>& candidates,
                                            double background) {
  Linearised& at = looked.baseline;
  looked.model.complete(at);
  const std::vector<SizeStep> steps = size_steps(candidates);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<double> size;
  std::vector<Eigen::MatrixXd> moves;
  for (std::size_t t = 0; t < looked.prepared.trials.size(); ++t)
    moves.push_back(signatures_of(looked.model, at, t, steps));
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::vector<VectorXd> alone;
    for (const Eigen::MatrixXd& m : moves) alone.push_back(m.col(static_cast<Eigen::Index>(s)));
    const double moved_m = std::max(1e-9, summed(looked.model, at, alone).total_rms_m);
    size.push_back(normal(random) *
                   std::min(0.3, background * looked.model.arm().total_length_m() / moved_m));
  }
  std::vector<VectorXd> residual;
  for (std::size_t t = 0; t < moves.size(); ++t) {
    residual.push_back(at.residual[t]);
    for (std::size_t s = 0; s < size.size(); ++s)
      residual[t] += size[s] * moves[t].col(static_cast<Eigen::Index>(s));
  }
  return residual;
}

TEST(Background, OfEverythingIsExplainedOnUnseenTrialsAndNothingElse) {
  const testing::RecordedCase drawn = unseen_case(6);
  testing::Looked looked(drawn.arm, drawn.trials);
  Linearised& at = looked.baseline;
  std::vector<model::Present> candidates;
  for (const Screened& s : screen(looked.model, at, 0, [](double) {}))
    candidates.push_back({s.effect, s.values});
  const std::vector<VectorXd> noise = at.residual;
  const double of_noise_m = summed(looked.model, at, noise).total_rms_m;

  at.residual = with_small_departures(looked, candidates, 1.5e-4);
  const Unseen without = summed(looked.model, at, at.residual);
  ASSERT_GT(without.total_rms_m, 1.2 * of_noise_m);
  const Unseen with = with_background(looked.model, at, candidates, 1.5e-4, without, 0);
  const auto beyond2 = [&](const Unseen& u) {
    return u.total_rms_m * u.total_rms_m - of_noise_m * of_noise_m;
  };
  EXPECT_LT(beyond2(with), 0.35 * beyond2(without));

  // What jumps from one stretch of time to the next is no departure of the arm.
  at.residual = noise;
  std::mt19937_64 random(5);
  std::normal_distribution<double> jump(0.0, 3.0);
  for (VectorXd& r : at.residual) {
    for (Eigen::Index row = 0; row < r.size(); ++row) r[row] += row % 60 < 30 ? jump(random) : -jump(random);
  }
  const Unseen jumping = summed(looked.model, at, at.residual);
  EXPECT_GT(with_background(looked.model, at, candidates, 1.5e-4, jumping, 0).total_rms_m,
            0.97 * jumping.total_rms_m);
}

}  // namespace
}  // namespace softarm::diagnose
