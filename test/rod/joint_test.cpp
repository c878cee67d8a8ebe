// Concentrated bending: a rotational spring at a segment's start, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "math/so3.h"
#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

using Eigen::Vector3d;

SolverOptions exact() {
  SolverOptions options;
  options.position_tolerance = 1e-11;
  options.linear_correction_rad = 1e-11;
  return options;
}

/// A cantilever with a spring at its root: tip deflection F L^3 / (3 EI) + F L^2 c, slope F L^2 / (2 EI) + F
/// L c.
TEST(Joint, OfACantileverAtItsRootTurnsByTheMomentThere) {
  const double length = 0.2, stiffness = 0.03, compliance = 2.5, force = 1e-5;
  rod::Rod rod = testing::plain_rod(length, stiffness);
  rod.segments[0].joint_compliance = compliance;
  rod.loads[0].force_n = {force, 0.0, 0.0};
  rod::Solver solver(rod, {0.0, length}, {}, exact());
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const double deflection =
      force * std::pow(length, 3) / (3.0 * stiffness) + force * length * length * compliance;
  const double slope = force * length * length / (2.0 * stiffness) + force * length * compliance;
  EXPECT_NEAR(solver.station(1).p.x(), deflection, 1e-6 * deflection);
  EXPECT_NEAR(math::log_so3(solver.station(1).q).y(), slope, 1e-6 * slope);
  EXPECT_LT(math::log_so3(solver.station(0).q).norm(), 1e-9) << "the clamp itself stays";
}

/// Two rods with a spring between them and one at the base under a moment at the end: arcs and kinks,
/// exactly.
TEST(Joint, BetweenTwoRodsUnderAnEndMomentMakesArcsAndKinks) {
  const double l1 = 0.2, l2 = 0.12, ei1 = 0.03, ei2 = 0.02, c0 = 0.4, c1 = 1.1, moment = 0.15;
  rod::Rod rod = testing::plain_rod(l1, ei1);
  rod::Segment second = rod.segments[0];
  second.rest_length_m = second.length_m = l2;
  second.bending_compliance = 1.0 / ei2;
  second.joint_compliance = c1;
  rod.segments[0].joint_compliance = c0;
  rod.segments.push_back(second);
  rod.loads[0].s_m = l1 + l2;
  rod.loads[0].moment_nm = {0.0, moment, 0.0};
  rod::Solver solver(rod, {l1, 0.25, l1 + l2}, {}, exact());
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  // Bending about y turns z towards x. Along an arc of curvature k from heading a: (cos a - cos b) / k, ...
  const auto arc = [](double from, double curvature, double s) -> Vector3d {
    const double to = from + curvature * s;
    return {(std::cos(from) - std::cos(to)) / curvature, 0.0, (std::sin(to) - std::sin(from)) / curvature};
  };
  const double k1 = moment / ei1, k2 = moment / ei2, a0 = moment * c0, a1 = a0 + k1 * l1,
               a2 = a1 + moment * c1;
  const Vector3d middle = arc(a0, k1, l1);
  EXPECT_LT((solver.station(0).p - middle).norm(), 1e-9);
  EXPECT_NEAR(math::log_so3(solver.station(0).q).y(), a1, 1e-9)
      << "the plate is the segment before the joint";
  EXPECT_LT((solver.station(1).p - middle - arc(a2, k2, 0.05)).norm(), 1e-9);
  EXPECT_LT((solver.station(2).p - middle - arc(a2, k2, l2)).norm(), 1e-9);
  EXPECT_NEAR(math::log_so3(solver.station(2).q).y(), a2 + k2 * l2, 1e-9);
  EXPECT_LT((solver.at(0.25).p - solver.station(1).p).norm(), 1e-9);
}

/// Actuation is inside a segment: without load its joint bears nothing. Nor does a joint turn about the
/// tangent.
TEST(Joint, BearsNeitherActuationNorTwist) {
  rod::Rod rod = testing::plain_rod();
  rod.segments[0].joint_compliance = 3.0;
  rod.segments[0].moment_nm = {-0.1, 0.2, 0.0};
  rod::Rod without = rod;
  without.segments[0].joint_compliance = 0.0;
  rod::Solver solver(rod, {0.2}, {}, exact()), reference(rod, {0.2}, {}, exact());
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  ASSERT_EQ(reference.solve(without), rod::SolveStatus::kConverged);
  EXPECT_LT((solver.station(0).p - reference.station(0).p).norm(), 1e-10);
  rod.segments[0].moment_nm.setZero();
  rod.segments[0].torsional_compliance = 1.0 / 0.02;
  rod.loads[0].moment_nm = {0.0, 0.0, 0.05};
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  EXPECT_NEAR(math::log_so3(solver.station(0).q).z(), 0.05 * 0.2 / 0.02, 1e-9);
}

}  // namespace
}  // namespace softarm::rod
