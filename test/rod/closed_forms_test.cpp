// The solver against shapes that are known exactly.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <cmath>

#include "math/so3.h"
#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

using testing::plain_rod;

TEST(ClosedForm, PureEndMomentGivesACircle) {
  const double length = 0.2, ei = 0.03;
  for (const double angle : {0.3, 2.0, 5.0}) {
    rod::Rod rod = plain_rod(length, ei);
    rod.loads[0].moment_nm = {0.0, ei * angle / length, 0.0};
    rod::SolverOptions exact;
    exact.position_tolerance = 1e-10;
    rod::Solver solver(rod, {0.05, 0.2}, {}, exact);
    ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
    const double radius = length / angle;
    for (int i = 0; i < 2; ++i) {
      const double turned = angle * solver.station(i).s_m / length;
      EXPECT_NEAR(solver.station(i).p.x(), radius * (1.0 - std::cos(turned)), 1e-9 * length);
      EXPECT_NEAR(solver.station(i).p.z(), radius * std::sin(turned), 1e-9 * length);
      EXPECT_NEAR(solver.station(i).p.y(), 0.0, 1e-14);
    }
  }
}

TEST(ClosedForm, ActuationMomentBendsTowardsItsDirection) {
  for (const double phi : {0.0, 0.7, 2.5, -1.9}) {
    rod::Rod rod = plain_rod();
    rod.segments[0].moment_nm = {-0.2 * std::sin(phi), 0.2 * std::cos(phi), 0.0};
    rod::Solver solver(rod, {0.2}, {});
    ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
    EXPECT_NEAR(std::atan2(solver.station(0).p.y(), solver.station(0).p.x()), phi, 1e-10);
  }
}

TEST(ClosedForm, SmallTipLoadOfACantileverWithShear) {
  const double length = 0.2, ei = 0.03, ga = 45.0, force = 1e-5;
  rod::Rod rod = plain_rod(length, ei);
  rod.segments[0].shear_compliance = 1.0 / ga;
  rod.loads[0].force_n = {force, 0.0, 0.0};
  rod::Solver solver(rod, {length}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const double expected = force * std::pow(length, 3) / (3.0 * ei) + force * length / ga;
  EXPECT_NEAR(solver.station(0).p.x() / expected, 1.0, 1e-6);
}

TEST(ClosedForm, SmallDistributedLoadOfACantilever) {
  const double length = 0.2, ei = 0.03;
  rod::Rod rod = plain_rod(length, ei);
  rod.segments[0].mass_kg = 1e-5;
  rod.gravity_m_s2 = {0.0, 1.0, 0.0};
  rod::Solver solver(rod, {length}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  EXPECT_NEAR(solver.station(0).p.y() / (1e-5 * std::pow(length, 3) / (8.0 * ei)), 1.0, 1e-6);
}

TEST(ClosedForm, HangingRodStretchesUnderItsLoad) {
  const double ea = 150.0;
  rod::Rod rod = plain_rod(0.2, 0.03);
  rod.segments[0].axial_compliance = 1.0 / ea;
  rod.segments[0].mass_kg = 0.2;
  rod.gravity_m_s2 = {0.0, 0.0, 9.81};
  rod.loads[0].mass_kg = 0.3;
  rod::Solver solver(rod, {0.2}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  EXPECT_NEAR(solver.station(0).p.z(), 0.2 * (1.0 + 9.81 * (0.3 + 0.1) / ea), 1e-12);
}

/// Horizontal cantilever under a dead tip load, by elliptic integrals (Bisshopp and Drucker 1945):
/// k is the modulus with F L^2 / EI = (K(k) - F(k, phi1))^2, k sin(phi1) = 1 / sqrt 2.
double elastica_tip_deflection(double load) {
  const auto alpha = [](double k) {
    return boost::math::ellint_1(k) - boost::math::ellint_1(k, std::asin(1.0 / (k * std::sqrt(2.0))));
  };
  double low = std::sqrt(0.5) + 1e-12, high = 1.0 - 1e-15;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (alpha(middle) < std::sqrt(load) ? low : high) = middle;
  }
  const double k = 0.5 * (low + high);
  const double phi1 = std::asin(1.0 / (k * std::sqrt(2.0)));
  return 1.0 - 2.0 / std::sqrt(load) * (boost::math::ellint_2(k) - boost::math::ellint_2(k, phi1));
}

TEST(ClosedForm, ElasticaUnderADeadTipLoad) {
  const double table[][2] = {{1.0, 0.30172}, {2.0, 0.49346}, {4.0, 0.66996}, {10.0, 0.81061}};
  for (const auto& row : table) {
    rod::Rod rod = plain_rod(0.2, 0.03);
    rod.loads[0].force_n = {row[0] * 0.03 / 0.04, 0.0, 0.0};
    rod::Solver solver(rod, {0.2}, {});
    ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged) << row[0];
    const double deflection = solver.station(0).p.x() / 0.2;
    EXPECT_NEAR(deflection, row[1], 6e-6);
    EXPECT_NEAR(deflection, elastica_tip_deflection(row[0]), 1e-7);
  }
}

TEST(ClosedForm, ElasticaUnderLargeLoadsIsReachedByContinuation) {
  for (const double load : {30.0, 100.0, 200.0}) {
    rod::Rod rod = plain_rod(0.2, 0.03);
    rod.loads[0].force_n = {load * 0.03 / 0.04, 0.0, 0.0};
    rod::Solver solver(rod, {0.2}, {});
    ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged) << load;
    // Beyond 100 the modulus is too close to 1 for double precision, and the asymptote is exact to 1e-6.
    const double expected =
        load > 100.0 ? 1.0 - (2.0 - std::sqrt(2.0)) / std::sqrt(load) : elastica_tip_deflection(load);
    EXPECT_NEAR(solver.station(0).p.x() / 0.2, expected, 1e-6) << load;
  }
}

TEST(ClosedForm, HelixFromConstantCurvatureAndTorsion) {
  const double length = 0.2;
  const Eigen::Vector3d u(0.0, 8.0, 15.0);
  rod::Rod rod = plain_rod(length);
  rod.segments[0].rest_curvature_per_m = u;
  rod::Solver solver(rod, {0.03, 0.11, length}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const double rate = u.norm();
  const Eigen::Vector3d axis = u / rate;
  const Eigen::Vector3d along = axis.z() * axis;
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ() - along;
  for (int i = 0; i < 3; ++i) {
    const double s = solver.station(i).s_m;
    const Eigen::Vector3d p = along * s + across * std::sin(rate * s) / rate +
                              axis.cross(across) * (1.0 - std::cos(rate * s)) / rate;
    EXPECT_NEAR((solver.station(i).p - p).norm(), 0.0, 2e-9 * length);
    EXPECT_LT(math::log_so3(solver.station(i).q * math::exp_so3(u * s).conjugate()).norm(), 1e-7);
  }
}

TEST(ClosedForm, FollowerTipForceKeepsItsAngle) {
  // A tip force along the tangent leaves the rod straight; a dead one of the same size would buckle it.
  rod::Rod rod = plain_rod();
  rod.loads[0].follower = true;
  rod.loads[0].force_n = {0.0, 0.0, -3.0};
  rod.loads[0].moment_nm = {0.0, 0.06, 0.0};
  rod::Solver solver(rod, {0.2}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const rod::RodState tip = solver.station(0);
  EXPECT_NEAR((tip.q.conjugate() * tip.n - rod.loads[0].force_n).norm(), 0.0, 1e-9);
  EXPECT_NEAR((tip.q.conjugate() * tip.m - rod.loads[0].moment_nm).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace softarm::rod
