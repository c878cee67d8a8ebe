// The solver against an independent discretisation: the potential energy of a fine chain of rigid links in
// three dimensions, minimised by Ceres with automatic derivatives, extrapolated to infinitely many links.
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

/// Elastic energy of a joint between two links: 1/2 K (theta - h u*)^2 / h with theta the relative rotation.
struct Joint {
  std::array<double, 3> root_stiffness;
  std::array<double, 3> rest_angle;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    T qa[4], qb[4], inverse[4], between[4], angle[3];
    ceres::AngleAxisToQuaternion(a, qa);
    ceres::AngleAxisToQuaternion(b, qb);
    inverse[0] = qa[0];
    for (int i = 1; i < 4; ++i) inverse[i] = -qa[i];
    ceres::QuaternionProduct(inverse, qb, between);
    ceres::QuaternionToAngleAxis(between, angle);
    for (int i = 0; i < 3; ++i) residual[i] = root_stiffness[i] * (angle[i] - rest_angle[i]);
    return true;
  }
};

/// Potential of the force that a link of length h carries: -F . (h t) = F h / 2 |t - F/|F||^2 + constant.
struct Weight {
  double root_energy;
  std::array<double, 3> direction;

  template <typename T>
  bool operator()(const T* a, T* residual) const {
    const T z[3] = {T(0), T(0), T(1)};
    T t[3];
    ceres::AngleAxisRotatePoint(a, z, t);
    for (int i = 0; i < 3; ++i) residual[i] = root_energy * (t[i] - direction[i]);
    return true;
  }
};

/// Tip of a chain of n links; clamped half a link before the first joint.
Eigen::Vector3d chain_tip(const rod::Rod& rod, int n) {
  const rod::Segment& segment = rod.segments[0];
  const double h = segment.length_m / n;
  std::vector<std::array<double, 3>> link(static_cast<std::size_t>(n), {0.0, 0.0, 0.0});
  std::array<double, 3> base = {0.0, 0.0, 0.0};
  ceres::Problem problem;
  EXPECT_EQ(segment.anisotropy.y(), 0.0) << "a joint's axes are those of the section";
  const std::array<double, 3> compliance = {segment.bending_compliance / (1.0 + segment.anisotropy.x()),
                                            segment.bending_compliance / (1.0 - segment.anisotropy.x()),
                                            segment.torsional_compliance};
  for (int k = 0; k < n; ++k) {
    // Half a link of material lies between the clamp and the middle of the first link.
    const double material = k == 0 ? 0.5 * h : h;
    Joint joint;
    for (int i = 0; i < 3; ++i) {
      const auto c = static_cast<std::size_t>(i);
      joint.root_stiffness[c] = std::sqrt(1.0 / (compliance[c] * material));
      joint.rest_angle[c] =
          material * (segment.rest_curvature_per_m[i] + compliance[c] * segment.moment_nm[i]);
    }
    double* from = k == 0 ? base.data() : link[static_cast<std::size_t>(k - 1)].data();
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Joint, 3, 3, 3>(new Joint(joint)), nullptr, from,
                             link[static_cast<std::size_t>(k)].data());
    const double carried = segment.mass_kg * (n - k - 0.5) / n + rod.loads[0].mass_kg;
    const Eigen::Vector3d force = carried * rod.gravity_m_s2 + rod.loads[0].force_n;
    const Eigen::Vector3d direction = force.normalized();
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Weight, 3, 3>(new Weight{
                                 std::sqrt(force.norm() * h), {direction.x(), direction.y(), direction.z()}}),
                             nullptr, link[static_cast<std::size_t>(k)].data());
  }
  problem.SetParameterBlockConstant(base.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 500;
  options.function_tolerance = 0.0;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-13;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  for (const auto& a : link) {
    const double z[3] = {0.0, 0.0, 1.0};
    Eigen::Vector3d t;
    ceres::AngleAxisRotatePoint(a.data(), z, t.data());
    tip += h * t;
  }
  return tip;
}

void expect_agreement(const rod::Rod& rod) {
  const double length = rod.segments[0].length_m;
  const Eigen::Vector3d coarse = chain_tip(rod, 100), middle = chain_tip(rod, 200),
                        fine = chain_tip(rod, 400);
  // Error in even powers of h: two Richardson steps.
  const Eigen::Vector3d first = (4.0 * middle - coarse) / 3.0, second = (4.0 * fine - middle) / 3.0;
  const Eigen::Vector3d limit = (16.0 * second - first) / 15.0;
  EXPECT_LT((limit - second).norm(), 1e-6 * length) << "the chain itself has not converged";
  rod::Solver solver(rod, {rod.rest_length_m()}, {});
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  EXPECT_TRUE(solver.stable());
  EXPECT_LT((solver.station(0).p - limit).norm(), 1e-6 * length)
      << solver.station(0).p.transpose() << " against " << limit.transpose();
}

TEST(Chain, LoadedArmInThreeDimensions) {
  expect_agreement(testing::loaded_arm());
}

TEST(Chain, CurvedAndTwistedAtRest) {
  rod::Rod rod = testing::loaded_arm();
  rod.segments[0].rest_curvature_per_m = {1.0, -3.0, 6.0};
  rod.segments[0].moment_nm = {0.05, 0.2, -0.03};
  rod.gravity_m_s2 = {3.0, -6.0, 7.0};
  expect_agreement(rod);
}

TEST(Chain, StifferInOnePlaneThanAcrossIt) {
  rod::Rod rod = testing::loaded_arm();
  rod.segments[0].rest_curvature_per_m = {1.0, -3.0, 6.0};
  rod.segments[0].anisotropy = {0.5, 0.0};
  expect_agreement(rod);
}

TEST(Chain, StandingSoftArm) {
  rod::Rod rod = testing::loaded_arm();
  rod.gravity_m_s2 = {0.0, 0.0, -9.81};
  rod.segments[0].moment_nm = {-0.02, 0.1, 0.0};
  rod.loads[0].mass_kg = 0.05;
  expect_agreement(rod);
}

}  // namespace
}  // namespace softarm::rod
