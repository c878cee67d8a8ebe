// Stability selection on linear problems whose law is known.
#include "diagnose/law_selection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "diagnose/policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kUnknowns = 3, kTerms = 20, kRows = 60, kOffset = 1;

/// Trials with one offset, three unknowns and twenty terms of random columns; term 7 is nearly term 6.
class Problem {
 public:
  explicit Problem(std::size_t trials, std::size_t units_of_trial = 1) {
    for (std::size_t t = 0; t < trials; ++t) {
      for (std::size_t u = 0; u < units_of_trial; ++u) {
        MatrixXd m = MatrixXd::NullaryExpr(kRows, kOffset + kUnknowns + 2 * kTerms + 1,
                                           [&](Index, Index) { return normal_(random_); });
        m.col(0).setOnes();
        m.middleCols<2>(column(7)) = m.middleCols<2>(column(6)) + 0.1 * m.middleCols<2>(column(7));
        columns_.push_back(std::move(m));
        sums_.trial.push_back(t);
      }
    }
    sums_.offsets = kOffset;
    sums_.unknowns = kUnknowns;
    sums_.terms = kTerms;
    sums_.precision = VectorXd::Constant(kOffset + kUnknowns, 1e-2);
    sums_.size_precision = 0.04;
  }
  static Index column(Index term) { return kOffset + kUnknowns + 2 * term; }

  MatrixXd& trial(std::size_t unit) { return columns_[unit]; }
  /// Adds to the residuals what a term makes.
  void add(Index term, double x, double y) {
    for (MatrixXd& m : columns_) m.rightCols<1>() += x * m.col(column(term)) + y * m.col(column(term) + 1);
  }
  LawSums sums() {
    sums_.of.clear();
    for (const MatrixXd& m : columns_) sums_.of.push_back(m.transpose() * m);
    return sums_;
  }

 private:
  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
  std::vector<MatrixXd> columns_;
  LawSums sums_;
};

Folds thirds(std::size_t trials) {
  Folds folds(3);
  for (std::size_t t = 0; t < trials; ++t) folds[t % 3].push_back(t);
  return folds;
}

TEST(LawSelection, FindsTheTermsThatAreThereAndTheirSizes) {
  Problem problem(9);
  problem.add(2, 0.8, -0.3);
  problem.add(11, 0.0, 0.5);
  const LawSums sums = problem.sums();
  const std::vector<StableTerm> terms = stable_terms(sums, thirds(9), 1);
  ASSERT_EQ(terms.size(), 2U);
  EXPECT_EQ(terms[0].term, 2);
  EXPECT_EQ(terms[1].term, 11);
  EXPECT_GT(terms[1].stability, 0.95);
  const VectorXd sizes = sizes_of(sums, {2, 11}, thirds(9));
  EXPECT_LT((sizes - Eigen::Vector4d(0.8, -0.3, 0.0, 0.5)).cwiseAbs().maxCoeff(), 0.15) << sizes.transpose();
  EXPECT_GT(held_out_gain(sums, {2, 11}, thirds(9)), 0.7 * 0.98 * 9.0 * kRows);
}

TEST(LawSelection, ChoosesNothingWhereNothingIs) {
  for (const bool stretches : {false, true}) {
    Problem problem(stretches ? 3 : 9, stretches ? 4 : 1);
    EXPECT_TRUE(stable_terms(problem.sums(), thirds(stretches ? 3 : 9), 1).empty());
  }
}

TEST(LawSelection, TermsThatStandForEachOtherDoNotShareTheirVotes) {
  Problem problem(9);
  problem.add(6, 0.15, 0.1);
  const std::vector<StableTerm> terms = stable_terms(problem.sums(), thirds(9), 1);
  ASSERT_EQ(terms.size(), 1U);
  EXPECT_TRUE(terms[0].term == 6 || terms[0].term == 7) << terms[0].term;
  EXPECT_GT(terms[0].stability, kPolicy.law.stable);
}

/// A term that is the same throughout each trial goes with the trials' own offsets; the constants' are the
/// fit's.
TEST(LawSelection, WhatOffsetsAndConstantsDoIsNoLaw) {
  Problem problem(9);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (std::size_t t = 0; t < 9; ++t) {
    const double offset = normal(random);
    problem.trial(t).rightCols<1>().array() += offset;
    problem.trial(t).rightCols<1>() += 2.0 * problem.trial(t).col(kOffset + 1);
    problem.trial(t).middleCols<2>(Problem::column(4)) = problem.trial(t).middleCols<2>(kOffset + 1);
    problem.trial(t).middleCols<2>(Problem::column(5)).setConstant(offset > 0.0 ? 1.0 : -1.0);
  }
  EXPECT_TRUE(stable_terms(problem.sums(), thirds(9), 1).empty());
}

TEST(LawSelection, LooksAtNoOtherTrialsThanItMay) {
  Problem problem(9);
  problem.add(2, 0.8, -0.3);
  LawSums sums = problem.sums();
  const Folds some{{0, 3}, {1, 4}, {2, 5}};
  const VectorXd sizes = sizes_of(sums, {2}, some);
  for (std::size_t t : {6, 7, 8}) sums.of[t].setConstant(1e9);
  EXPECT_EQ(sizes_of(sums, {2}, some), sizes);
  const std::vector<StableTerm> terms = stable_terms(sums, some, 1);
  ASSERT_EQ(terms.size(), 1U);
  EXPECT_EQ(terms[0].term, 2);
}

}  // namespace
}  // namespace softarm::diagnose
