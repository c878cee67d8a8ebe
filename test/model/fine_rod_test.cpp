// The rod in pieces is the arm's rod.
#include <gtest/gtest.h>

#include "effects/along.h"
#include "effects/body_fixture.h"
#include "softarm/rod/solver.h"

namespace softarm::effects {
namespace {

class Shipped : public ::testing::TestWithParam<const char*> {};

TEST_P(Shipped, InPiecesItIsTheSameRod) {
  const arm::Arm arm = body_testing::shipped(GetParam());
  std::vector<double> places;
  for (const double share : {0.13, 0.5, 0.77, 1.0}) places.push_back(share * arm.total_length_m());
  rod::SolverOptions exact;
  exact.position_tolerance = 1e-9;
  exact.linear_correction_rad = 1e-9;
  const model::FineRod fine(arm);
  rod::Rod coarse = rod::make_rod(arm), pieces = fine.layout();
  rod::Solver one(coarse, places, {}, exact), many(pieces, places, {}, exact);
  int solved = 0;
  for (const double level : {0.0, 0.4, 1.0}) {
    const Eigen::VectorXd inputs = body_testing::inputs_of(arm, level);
    const auto laws =
        softarm::arm::predict(arm, arm::InputValues(inputs.data(), inputs.data() + inputs.size()));
    ASSERT_TRUE(laws);
    rod::actuate(arm, *laws, coarse);
    fine.actuate(arm, *laws, *laws, pieces);
    for (rod::Rod* rod : {&coarse, &pieces}) {
      rod->gravity_m_s2 = {2.0, -1.0, 9.4};
      rod->loads[rod::kPayloadLoad].mass_kg = 0.02;
    }
    ASSERT_EQ(one.solve(coarse), rod::SolveStatus::kConverged);
    ASSERT_EQ(many.solve(pieces), rod::SolveStatus::kConverged);
    for (int i = 0; i < one.stations(); ++i)
      EXPECT_LT((one.station(i).p - many.station(i).p).norm(), 1e-8) << "level " << level << ", place " << i;
    ++solved;
  }
  EXPECT_EQ(solved, 3);
}

INSTANTIATE_TEST_SUITE_P(Arms, Shipped,
                         ::testing::Values("online_200mm", "semi_physical_200mm", "single_chamber_85mm",
                                           "hybrid_85mm", "cable_235mm", "two_segment", "pouch_arm",
                                           "pouch_arm_one_segment", "tendon_trunk"));

TEST(FineRod, AStiffnessProfileIsCutWithThePieces) {
  arm::Arm arm = body_testing::shipped("online_200mm");
  arm.segments[0].stiffness_profile = {{0.0, 1.3}, {0.37, 0.8}, {0.61, 1.0}, {1.0, 0.6}};
  const model::FineRod fine(arm);
  rod::Rod coarse = rod::make_rod(arm), pieces = fine.layout();
  for (rod::Rod* rod : {&coarse, &pieces}) {
    rod->gravity_m_s2 = {9.8, 0.0, 0.0};
    rod->loads[rod::kPayloadLoad].mass_kg = 0.1;
  }
  rod::SolverOptions exact;
  exact.position_tolerance = 1e-9;
  rod::Solver one(coarse, {0.08, 0.2}, {}, exact), many(pieces, {0.08, 0.2}, {}, exact);
  ASSERT_EQ(one.solve(coarse), rod::SolveStatus::kConverged);
  ASSERT_EQ(many.solve(pieces), rod::SolveStatus::kConverged);
  for (int i = 0; i < 2; ++i) EXPECT_LT((one.station(i).p - many.station(i).p).norm(), 1e-8);
}

TEST(FineRod, AForceIsSharedByItsNeighboursWithTheSameMoment) {
  const model::FineRod fine(body_testing::shipped("online_200mm"));
  for (const double s : {0.004, 0.05, 0.0873, 0.1999, 0.2}) {
    rod::Rod rod = fine.layout();
    fine.add_force(s, {1.0, 0.0, 0.0}, rod);
    double moment = 0.0;
    for (int i = 0; i < fine.stations(); ++i)
      moment += fine.station_m(i) *
                rod.loads[static_cast<std::size_t>(model::FineRod::kFirstStation + i)].force_n.x();
    EXPECT_NEAR(moment, s, 1e-12);
  }
}

TEST(FineRod, MassesOfStationsHaveTheMomentOfTheArm) {
  arm::Arm arm = body_testing::shipped("two_segment");
  arm.tip_mass_kg = 0.01;
  arm.payload.arclength_m = 0.6 * arm.total_length_m();
  const model::FineRod fine(arm);
  rod::Rod rod = fine.layout();
  rod.loads[rod::kPayloadLoad].mass_kg = 0.05;
  const Eigen::VectorXd masses = fine.station_masses_kg(rod);
  double expected = 0.01 * arm.total_length_m() + 0.05 * arm.payload.arclength_m, begin = 0.0;
  for (const arm::Segment& segment : arm.segments) {
    expected += segment.mass_per_length_kg_m * segment.length_m * (begin + 0.5 * segment.length_m);
    begin += segment.length_m;
  }
  double moment = 0.0;
  for (int i = 0; i < fine.stations(); ++i) moment += masses[i] * fine.station_m(i);
  EXPECT_NEAR(moment, expected, 1e-9);
}

TEST(Along, WhatCoversAStretchHasItsLengthAndItsMiddle) {
  const model::FineRod fine(body_testing::shipped("two_segment"));
  const double length = fine.length_m();
  const auto expect = [&](const Eigen::VectorXd& shares, double from, double to) {
    double sum = 0.0, moment = 0.0;
    for (int j = 0; j < fine.stations(); ++j) {
      const model::Piece& piece = fine.pieces()[static_cast<std::size_t>(j)];
      sum += shares[j] * (piece.s_to_m - piece.s_from_m);
      moment += shares[j] * (piece.s_to_m - piece.s_from_m) * piece.middle_m();
    }
    EXPECT_NEAR(sum, to - from, 1e-12);
    EXPECT_NEAR(moment, 0.5 * (to * to - from * from), 1e-12);
  };
  for (const double from : {0.0, 0.003, 0.11, 0.19}) {
    for (const double share : {0.02, 0.15, 0.5, 1.0}) {
      const double to = from + share * (length - from);
      expect(effects::cover(fine, from, to), from, to);
    }
  }
  for (const double cap : {0.0, 0.004, 0.016, 0.0301, 0.08}) {
    expect(effects::cap_at_base(fine, cap), 0.0, cap);
    expect(effects::cap_at_tip(fine, cap), length - cap, length);
    EXPECT_LE(effects::cap_at_base(fine, cap).maxCoeff(), 1.0 + 1e-12);
    EXPECT_LE(effects::cap_at_tip(fine, cap).maxCoeff(), 1.0 + 1e-12);
  }
}

TEST(Along, PositionsBetweenStationsLieOnTheRod) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  const model::FineRod fine(arm);
  rod::Rod rod = fine.layout();
  for (rod::Segment& piece : rod.segments) piece.moment_nm = {-0.1, 0.25, 0.0};
  rod.loads[rod::kPayloadLoad].mass_kg = 0.1;
  std::vector<double> places;
  for (int j = 0; j < fine.stations(); ++j) places.push_back(fine.station_m(j));
  for (const double s : {0.005, 0.06, 0.131, 0.2}) places.push_back(s);
  rod::Solver solver(rod, places, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  model::Shape shape;
  for (int j = 0; j < fine.stations(); ++j) shape.stations.push_back(solver.station(j));
  for (int j = fine.stations(); j < solver.stations(); ++j)
    EXPECT_LT(
        (position_at(fine, rod, shape, places[static_cast<std::size_t>(j)]) - solver.station(j).p).norm(),
        2e-6);
}

}  // namespace
}  // namespace softarm::effects
