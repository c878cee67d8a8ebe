// Derivatives by the rod where an effect answers to the shape: what they make of a change, against the
// difference of two predictions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "effects/body_table.h"
#include "model/instant_solver.h"

namespace softarm::model {
namespace {

namespace body = effects::body_testing;

/// Predictions are settled to a tenth of a micrometre at every body of a dozen instants.
constexpr double kPredicted_m = 5e-7;

struct Answering {
  friend std::ostream& operator<<(std::ostream& out, const Answering& a) { return out << a.name; }
  const char *name, *id;
  std::vector<double> values;
  std::vector<double> steps;  ///< by which these are changed one after the other; 0: not at all
  double within;              ///< of what the change does
  bool stiffens = false;      ///< beside strain_stiffening
};

// Forces that hold places are answered exactly; at a wall of 2000 N/m a tenth of a micrometre is 0.2 mN. Laws
// of pieces are those at their middles, with kinks that move along the arm.
constexpr double kHeld = 1e-3, kStiff = 3e-3, kOfMiddles = 5e-3, kWithKinks = 0.1;

const std::vector<Answering>& answering() {
  static const std::vector<Answering> list{
      // L^3 / (3 EI) is 0.1 m/N: as stiff as the arm, and thirty times as stiff.
      {"tether", "tether", {10.0, 1e-3, 0.03, -0.02, 0.05}, {0.1, 1e-4, 1e-3, 1e-3, 1e-3}, kHeld},
      {"short_tether", "tether", {300.0, 1e-3, 0.03, -0.02, 0.0}, {3.0, 1e-4, 1e-3, 1e-3, 0.0}, kStiff},
      {"soft_wall", "contact", {50.0, 0.14, 0.3, 0.01, 0.0, 0.0, 0.0}, {0.5, 5e-4, 0.01, 1e-4}, kHeld},
      {"wall", "contact", {2000.0, 0.14, 0.3, 0.01, 0.0, 0.0, 0.0}, {20.0, 5e-4, 0.01, 1e-4}, kStiff},
      {"post",
       "contact",
       {1000.0, 0.14, 0.3, 0.01, 0.0, 40.0, 0.0},
       {1.0, 5e-5, 1e-3, 1e-5, 0.0, 0.02},  // over its edge it does not touch
       kStiff},
      {"long_wall", "contact", {200.0, 0.12, 0.3, 0.008, 0.0, 0.0, 0.05}, {2.0, 5e-4, 0.01, 1e-4}, kStiff},
      // On the first piece, where it is also the base that says where the place is.
      {"wall_at_base",
       "contact",
       {2000.0, 0.012, 0.3, 2e-4, 0.0, 0.0, 0.0},
       {20.0, 2e-4, 0.01, 1e-5},
       kStiff},
      {"curvature_softening", "curvature_softening", {0.5, 3.0}, {0.01, 0.05}, kOfMiddles},
      {"strain_stiffening", "strain_stiffening", {5e-3}, {1e-4}, kOfMiddles},
      {"softening_of_stiffening", "curvature_softening", {0.5, 3.0}, {0.01, 0.05}, kOfMiddles, true},
      {"one_sided_softness", "one_sided_softness", {0.3, 0.9}, {5e-3, 0.01}, kWithKinks},
  };
  return list;
}

class FirstOrder : public ::testing::TestWithParam<Answering> {
 protected:
  std::vector<Present> answering(Eigen::Index number = -1, double step = 0.0) const {
    Values values = body::values_of(GetParam().values);
    if (number >= 0) values[number] += step;
    std::vector<Present> list{body::present(GetParam().id, values)};
    if (GetParam().stiffens) list.push_back(body::present("strain_stiffening", Values::Constant(1, 5e-3)));
    return list;
  }
  /// A change of the model from `less` to `more`, with `at` in the middle between them.
  /// @return by how much it moves the bodies
  double expect_known(const std::vector<Present>& at, const std::vector<Present>& less,
                      const std::vector<Present>& more) {
    const Dynamics still{false, 0.0};
    const std::vector<Predicted> base = body::predict(model_, arm_, at, trial_, still, true);
    const Eigen::MatrixXd change = model_.vary(arm_, more, still, trial_, base, false).values -
                                   model_.vary(arm_, less, still, trial_, base, false).values;
    const Eigen::VectorXd moved = body::stacked(body::predict(model_, arm_, more, trial_, still)) -
                                  body::stacked(body::predict(model_, arm_, less, trial_, still));
    Eigen::VectorXd expected(moved.size());
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < base.size(); ++k) {
      const Eigen::MatrixXd by_rod = base[k].by_rod->seen.cast<double>();
      expected.segment(row, by_rod.rows()) = by_rod * change.col(static_cast<Eigen::Index>(k));
      row += by_rod.rows();
    }
    EXPECT_EQ(row, moved.size());
    EXPECT_LT((expected - moved).norm(), GetParam().within * moved.norm() + kPredicted_m);
    return moved.norm();
  }

  const arm::Arm arm_ = body::shipped("online_200mm");
  ExtendedModel model_{arm_};
  const TrialData trial_ = body::trial_of(arm_, body::various(arm_));
};

TEST_P(FirstOrder, HasTheAnswerToOtherLoadsAndStrains) {
  const std::vector<std::pair<const char*, std::vector<double>>> changes{
      {"tip_mass", {1e-3}},
      {"base_tilt", {1e-3, 5e-4}},
      {"rest_curvature", {0.03, 0.02, 0.0}},
      {"bending_plane_offset", {5e-3}},
      {"plane_stiffness", {2e-3, -1e-3}},
  };
  for (const auto& one : changes) {
    const std::string id = one.first;
    SCOPED_TRACE(id);
    const Values change = body::values_of(one.second);
    // Masses are positive.
    const Values middle = id == "tip_mass" ? Values(2.0 * change) : Values(0.0 * change);
    const auto beside = [&](double steps) {
      std::vector<Present> list = answering();
      list.push_back(body::present(id, middle + steps * change));
      return list;
    };
    EXPECT_GT(expect_known(beside(0.0), beside(-1.0), beside(1.0)), 20.0 * kPredicted_m);
  }
}

TEST_P(FirstOrder, HasTheAnswerToItsOwnNumbers) {
  double most_m = 0.0;
  for (std::size_t k = 0; k < GetParam().steps.size(); ++k) {
    const double step = GetParam().steps[k];
    if (step == 0.0) continue;
    SCOPED_TRACE(answering().front().effect->info().parameters[k].symbol);
    const auto number = static_cast<Eigen::Index>(k);
    most_m = std::max(most_m, expect_known(answering(), answering(number, -step), answering(number, step)));
  }
  EXPECT_GT(most_m, 20.0 * kPredicted_m);
}

INSTANTIATE_TEST_SUITE_P(Effects, FirstOrder, ::testing::ValuesIn(answering()),
                         [](const auto& which) { return std::string(which.param.name); });

/// A model has its effects in the order in which they were found.
TEST(ExtendedModelOrder, LawsOfPiecesActAfterWhatMakesThePieces) {
  const arm::Arm arm = body::shipped("online_200mm");
  ExtendedModel model(arm);
  const TrialData trial = body::trial_of(arm, body::various(arm));
  const Present before = body::present("plane_stiffness", Eigen::Vector2d(0.2, -0.1));
  for (const Present& after : {body::present("curvature_softening", Eigen::Vector2d(0.5, 3.0)),
                               body::present("strain_stiffening", Values::Constant(1, 5e-3))}) {
    SCOPED_TRACE(after.effect->info().id);
    EXPECT_LT((body::stacked(body::predict(model, arm, {after, before}, trial)) -
               body::stacked(body::predict(model, arm, {before, after}, trial)))
                  .lpNorm<Eigen::Infinity>(),
              1e-12);
  }
}

TEST(ExtendedModelOrder, LawsOfPiecesActInTheOrderOfTheCatalogue) {
  const arm::Arm arm = body::shipped("online_200mm");
  ExtendedModel model(arm);
  const TrialData trial = body::trial_of(arm, body::various(arm));
  const Present stiffening = body::present("strain_stiffening", Values::Constant(1, 5e-3));
  for (const Present& other : {body::present("curvature_softening", Eigen::Vector2d(0.5, 3.0)),
                               body::present("one_sided_softness", Eigen::Vector2d(0.3, 0.9)),
                               body::present("mullins", Eigen::Vector3d(0.2, 0.1, 3.0))}) {
    SCOPED_TRACE(other.effect->info().id);
    EXPECT_LT((body::stacked(body::predict(model, arm, {stiffening, other}, trial)) -
               body::stacked(body::predict(model, arm, {other, stiffening}, trial)))
                  .lpNorm<Eigen::Infinity>(),
              1e-12);
  }
}

constexpr double kBeta_m2 = 5e-3, kSofter = 0.5, kKnee_per_m = 3.0;

/// What strain_stiffening, and then curvature_softening, make of a curvature, 1/m.
double stiffened_and_softened(double linear) {
  double low = 0.0, high = linear;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    (x * (1.0 + kBeta_m2 * x * x) < linear ? low : high) = x;
  }
  const double from = low - kKnee_per_m, width = 0.25 * kKnee_per_m;
  return low +
         kSofter * 0.5 * (from + std::hypot(from, width) + kKnee_per_m - std::hypot(kKnee_per_m, width));
}

TEST(ExtendedModelOrder, LawsOfPiecesComposeAboutTheCurvatureWithoutALoad) {
  arm::Arm arm = body::shipped("online_200mm");
  for (arm::Segment& segment : arm.segments) segment.rest_curvature_per_m = {0.8, -0.5, 0.0};
  ExtendedModel model(arm);
  const std::vector<Predicted> path =
      body::predict(model, arm,
                    {body::present("curvature_softening", Eigen::Vector2d(kSofter, kKnee_per_m)),
                     body::present("strain_stiffening", Values::Constant(1, kBeta_m2))},
                    body::trial_of(arm, body::various(arm)));
  InstantSolver without(arm);
  double most_per_m = 0.0;
  for (const Predicted& now : path) {
    rod::Rod rod;
    ASSERT_TRUE(without.make(arm, {}, {}, {false, 0.0}, now.instant, nullptr, {}, rod));
    ASSERT_EQ(now.shape.middles.size(), rod.segments.size());
    for (std::size_t j = 0; j < rod.segments.size(); ++j) {
      const rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = now.shape.middles[j];
      const Eigen::Vector3d moment = middle.q.conjugate() * middle.m + piece.moment_nm;
      const Eigen::Vector2d linear = piece.curvature_of(moment.head<2>());
      const Eigen::Vector2d bent = stiffened_and_softened(linear.norm()) * linear.normalized();
      EXPECT_LT((piece.rest_curvature_per_m.head<2>() + bent - middle.u.head<2>()).norm(), 1e-3);
      most_per_m = std::max(most_per_m, bent.norm());
    }
  }
  EXPECT_GT(most_per_m, kKnee_per_m);  // both do something
}

}  // namespace
}  // namespace softarm::model
