// Balance, convergence, invariance, and what happens when there is no solution.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "math/so3.h"
#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

TEST(Equilibrium, ForcesAndMomentsBalanceAtEveryNode) {
  const rod::Rod rod = testing::complicated_rod();
  std::vector<double> stations;
  for (int i = 0; i <= 64; ++i) stations.push_back(0.32 * i / 64.0);
  rod::SolverOptions exact;
  exact.position_tolerance = 1e-11;
  rod::Solver solver(rod, stations, {}, exact);
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);

  // Everything beyond s, summed independently: weights of short pieces by Gauss-Legendre, then the point
  // loads.
  const double nodes[3] = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
  const double weights[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  for (int i = 0; i < 64; ++i) {
    const rod::RodState here = solver.station(i);
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (int k = i; k < 64; ++k) {
      const double a = stations[static_cast<std::size_t>(k)], b = stations[static_cast<std::size_t>(k) + 1];
      for (int g = 0; g < 3; ++g) {
        const double s = 0.5 * (a + b) + 0.5 * (b - a) * nodes[g];
        const rod::Segment& segment = rod.segments[s < 0.2 ? 0 : 1];
        const Eigen::Vector3d weight =
            0.5 * (b - a) * weights[g] * segment.mass_kg / segment.rest_length_m * rod.gravity_m_s2;
        force += weight;
        moment += (solver.at(s).p - here.p).cross(weight);
      }
    }
    for (const rod::PointLoad& load : rod.loads) {
      if (load.s_m < here.s_m) continue;
      const rod::RodState at = solver.at(load.s_m);
      const Eigen::Vector3d f =
          (load.follower ? at.q * load.force_n : load.force_n) + load.mass_kg * rod.gravity_m_s2;
      force += f;
      moment += (at.p + at.q * load.offset_m - here.p).cross(f) +
                (load.follower ? at.q * load.moment_nm : load.moment_nm);
    }
    EXPECT_NEAR((here.n - force).norm(), 0.0, 1e-9) << i;
    EXPECT_NEAR((here.m - moment).norm(), 0.0, 1e-8) << i;
    // The constitutive law at the same place.
    const rod::Segment& segment = rod.segments[here.s_m < 0.2 + 1e-9 ? 0 : 1];
    if (segment.stiffness_profile.empty()) {
      const Eigen::Vector3d m = here.q.conjugate() * here.m + segment.moment_nm;
      const Eigen::Vector2d bent = here.u.head<2>() - segment.rest_curvature_per_m.head<2>();
      const Eigen::Vector2d t = segment.anisotropy;
      const Eigen::Vector2d borne((1.0 + t.x()) * bent.x() + t.y() * bent.y(),
                                  t.y() * bent.x() + (1.0 - t.x()) * bent.y());
      EXPECT_LT((borne / segment.bending_compliance - m.head<2>()).norm(), 1e-7 / segment.bending_compliance);
      EXPECT_NEAR(here.u.z(), segment.rest_curvature_per_m.z() + segment.torsional_compliance * m.z(), 1e-7);
    }
  }
}

TEST(Equilibrium, InterpolationAgreesWithStations) {
  const rod::Rod rod = testing::complicated_rod();
  std::vector<double> stations;
  for (int i = 0; i <= 40; ++i) stations.push_back(0.32 * i / 40.0);
  rod::Solver fine(rod, stations, {});
  rod::Solver coarse(rod, {0.32}, {});
  ASSERT_EQ(fine.solve(rod), rod::SolveStatus::kConverged);
  ASSERT_EQ(coarse.solve(rod), rod::SolveStatus::kConverged);
  for (int i = 0; i < fine.stations(); ++i) {
    const rod::RodState at = coarse.at(fine.station(i).s_m);
    EXPECT_NEAR((at.p - fine.station(i).p).norm(), 0.0, 1e-7 * 0.32) << i;
    EXPECT_NEAR((at.n - fine.station(i).n).norm(), 0.0, 1e-6) << i;
    EXPECT_NEAR((at.m - fine.station(i).m).norm(), 0.0, 1e-6) << i;
    EXPECT_NEAR((at.u - fine.station(i).u).norm(), 0.0, 1e-4) << i;
  }
}

TEST(Equilibrium, ConvergesWithEighthOrder) {
  const rod::Rod rod = testing::loaded_arm();
  const auto tip = [&](int refinement) {
    std::vector<double> stations;  // stations are breakpoints: they make the steps
    for (int i = 1; i <= refinement; ++i) stations.push_back(0.2 * i / refinement);
    rod::SolverOptions fixed;
    fixed.max_refinement = 1;
    rod::Solver solver(rod, stations, {}, fixed);
    EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
    return solver.station(refinement - 1).p;
  };
  const Eigen::Vector3d exact = tip(64);
  const double coarse = (tip(4) - exact).norm(), fine = (tip(8) - exact).norm();
  EXPECT_LT(coarse, 1e-7 * 0.2);
  EXPECT_GT(std::log2(coarse / fine), 7.0) << coarse << " " << fine;
}

TEST(Equilibrium, AskedAccuracyIsKeptOnAMuchBentRod) {
  rod::Rod rod = testing::loaded_arm();
  rod.segments[0].moment_nm = {0.1, 1.2, 0.02};
  rod.segments[0].bending_compliance = 1.0 / 0.015;
  rod::SolverOptions exact;
  exact.position_tolerance = 1e-12;
  rod::Solver reference(rod, {0.05, 0.2}, {}, exact);
  rod::Solver usual(rod, {0.05, 0.2}, {});
  ASSERT_EQ(reference.solve(rod), rod::SolveStatus::kConverged);
  ASSERT_EQ(usual.solve(rod), rod::SolveStatus::kConverged);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT((usual.station(i).p - reference.station(i).p).norm(), 1e-6 * 0.2);
  }
}

TEST(Equilibrium, AskedAccuracyIsKeptOverTheArmsShapes) {
  // Warm and cold, up and down in refinement, against a grid that is fine everywhere.
  rod::Rod rod = testing::loaded_arm();
  rod::SolverOptions exact, usual;
  exact.position_tolerance = 1e-13;
  usual.position_tolerance = 1e-6;
  const std::vector<double> stations = {0.05, 0.1, 0.15, 0.2};
  rod::Solver reference(rod, stations, {}, exact), cold(rod, stations, {}, usual),
      warm(rod, stations, {}, usual);
  ASSERT_EQ(warm.solve(rod), rod::SolveStatus::kConverged);
  int coarse = 0;
  rod::Rod last = rod;
  for (int i = 0; i < 200; ++i) {
    rod.segments[0].moment_nm = {0.1 * std::sin(0.11 * i), 0.45 + 0.4 * std::sin(0.07 * i), 0.01};
    rod.segments[0].bending_compliance = 1.0 / (0.035 + 0.012 * std::cos(0.05 * i));
    ASSERT_EQ(reference.solve(rod), rod::SolveStatus::kConverged) << i;
    ASSERT_EQ(cold.solve(rod), rod::SolveStatus::kConverged) << i;
    ASSERT_EQ(warm.solve(rod, Eigen::Quaterniond(warm.q_tip()), &last), rod::SolveStatus::kConverged) << i;
    for (int k = 0; k < 4; ++k) {
      EXPECT_LT((cold.station(k).p - reference.station(k).p).norm(), 1e-6 * 0.2) << i;
      EXPECT_LT((warm.station(k).p - reference.station(k).p).norm(), 1e-6 * 0.2) << i;
    }
    coarse += warm.refinement() == 1 ? 1 : 0;
    last = rod;
  }
  EXPECT_GT(coarse, 50);
  EXPECT_LT(coarse, 200);
}

TEST(Equilibrium, TurnsWithTheWorld) {
  const rod::Rod rod = testing::complicated_rod();
  const Eigen::Quaterniond turn = math::exp_so3({0.7, -1.1, 2.0});
  const Eigen::Vector3d shift(1.0, 2.0, -3.0);
  rod::Rod turned = rod;
  turned.p_base = turn * rod.p_base + shift;
  turned.q_base = turn * rod.q_base;
  turned.gravity_m_s2 = turn * rod.gravity_m_s2;
  turned.loads[0].force_n = turn * rod.loads[0].force_n;
  turned.loads[0].moment_nm = turn * rod.loads[0].moment_nm;
  rod::Solver a(rod, {0.1, 0.32}, {}), b(rod, {0.1, 0.32}, {});
  ASSERT_EQ(a.solve(rod), rod::SolveStatus::kConverged);
  ASSERT_EQ(b.solve(turned), rod::SolveStatus::kConverged);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR((b.station(i).p - (turn * a.station(i).p + shift)).norm(), 0.0, 1e-10);
    EXPECT_NEAR((b.station(i).u - a.station(i).u).norm(), 0.0, 1e-8);
  }
}

TEST(Equilibrium, SegmentsInSeriesAreOneRod) {
  const rod::Rod one = testing::loaded_arm();
  rod::Rod two = one;
  two.segments[0].rest_length_m = two.segments[0].length_m = 0.08;
  two.segments[0].mass_kg = 0.08;
  rod::Segment rest = one.segments[0];
  rest.rest_length_m = rest.length_m = 0.12;
  rest.mass_kg = 0.12;
  two.segments.push_back(rest);
  rod::Solver a(one, {0.05, 0.2}, {}), b(two, {0.05, 0.2}, {});
  ASSERT_EQ(a.solve(one), rod::SolveStatus::kConverged);
  ASSERT_EQ(b.solve(two), rod::SolveStatus::kConverged);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR((a.station(i).p - b.station(i).p).norm(), 0.0, 1e-9);
}

TEST(Equilibrium, WarmStartKeepsTheBranchAndColdAgrees) {
  rod::Rod rod = testing::loaded_arm();
  rod::Solver warm(rod, {0.2}, {}), cold(rod, {0.2}, {});
  ASSERT_EQ(warm.solve(rod), rod::SolveStatus::kConverged);
  rod::Rod last = rod;
  for (int i = 0; i < 60; ++i) {
    rod.segments[0].moment_nm.y() = 0.3 + 0.3 * std::sin(0.3 * i);
    rod.loads[0].mass_kg = 0.2 + 0.1 * std::cos(0.2 * i);
    const Eigen::Quaterniond start = warm.q_tip();
    ASSERT_EQ(warm.solve(rod, start, &last), rod::SolveStatus::kConverged) << i;
    ASSERT_EQ(cold.solve(rod), rod::SolveStatus::kConverged) << i;
    EXPECT_NEAR((warm.station(0).p - cold.station(0).p).norm(), 0.0, 1e-8) << i;
    last = rod;
  }
}

TEST(Equilibrium, BuckledArmStaysOnItsSide) {
  // A standing column far beyond its buckling load: as the lateral force changes sign, the branch of the
  // start is kept.
  rod::Rod rod = testing::plain_rod(0.2, 0.03);
  rod.gravity_m_s2 = {0.0, 0.0, -9.81};
  rod.loads[0].mass_kg = 0.3;
  rod.loads[0].force_n = {1.0, 0.0, 0.0};
  rod::Solver solver(rod, {0.2}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  rod::Rod last = rod;
  rod.loads[0].mass_kg = 0.6;
  ASSERT_EQ(solver.solve(rod, Eigen::Quaterniond(solver.q_tip()), &last), rod::SolveStatus::kConverged);
  EXPECT_TRUE(solver.stable());
  last = rod;
  rod.loads[0].force_n = {-0.05, 0.0, 0.0};
  ASSERT_EQ(solver.solve(rod, Eigen::Quaterniond(solver.q_tip()), &last), rod::SolveStatus::kConverged);
  EXPECT_GT(solver.station(0).p.x(), 0.1);
  EXPECT_FALSE(solver.stable());  // it would swing round the vertical to the other side
}

TEST(Equilibrium, NoAnswerIsATypedResult) {
  rod::Rod rod = testing::loaded_arm();
  rod::Solver solver(rod, {0.2}, {});
  rod.loads[0].force_n.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kInvalidInput);
  rod = testing::loaded_arm();
  rod.segments[0].length_m = -0.1;
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kInvalidInput);
  rod = testing::loaded_arm();
  rod.loads[0].force_n = {1e7, 0.0, 0.0};  // 1e7 times the buckling load: out of reach of double precision
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kNoConvergence);
  rod = testing::loaded_arm();
  EXPECT_EQ(solver.solve(rod, math::exp_so3({0.0, 0.0, 3.0})), rod::SolveStatus::kNoConvergence);
  EXPECT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  EXPECT_THROW(rod::Solver(rod, {0.3}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace softarm::rod
