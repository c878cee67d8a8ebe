// Derivatives by every parameter against central differences.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "math/so3.h"
#include "rods.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

struct Case {
  const char* name;
  rod::Parameter parameter;
  double step;
};

void move(rod::Rod& rod, const rod::Parameter& p, double by) {
  const auto i = static_cast<std::size_t>(p.index);
  switch (p.kind) {
    case rod::ParameterKind::kRestCurvature:
      rod.segments[i].rest_curvature_per_m[p.component] += by;
      break;
    case rod::ParameterKind::kMoment:
      rod.segments[i].moment_nm[p.component] += by;
      break;
    case rod::ParameterKind::kBendingCompliance:
      rod.segments[i].bending_compliance += by;
      break;
    case rod::ParameterKind::kTorsionalCompliance:
      rod.segments[i].torsional_compliance += by;
      break;
    case rod::ParameterKind::kAxialCompliance:
      rod.segments[i].axial_compliance += by;
      break;
    case rod::ParameterKind::kShearCompliance:
      rod.segments[i].shear_compliance += by;
      break;
    case rod::ParameterKind::kBendingAnisotropy:
      rod.segments[i].anisotropy[p.component] += by;
      break;
    case rod::ParameterKind::kJointCompliance:
      rod.segments[i].joint_compliance += by;
      break;
    case rod::ParameterKind::kLength:
      rod.segments[i].length_m += by;
      break;
    case rod::ParameterKind::kSegmentMass:
      rod.segments[i].mass_kg += by;
      break;
    case rod::ParameterKind::kLoadForce:
      rod.loads[i].force_n[p.component] += by;
      break;
    case rod::ParameterKind::kLoadMoment:
      rod.loads[i].moment_nm[p.component] += by;
      break;
    case rod::ParameterKind::kLoadMass:
      rod.loads[i].mass_kg += by;
      break;
    case rod::ParameterKind::kLoadOffset:
      rod.loads[i].offset_m[p.component] += by;
      break;
    case rod::ParameterKind::kGravity:
      rod.gravity_m_s2[p.component] += by;
      break;
    case rod::ParameterKind::kBaseRotation:
      rod.q_base = math::exp_so3(by * Eigen::Vector3d::Unit(p.component)) * rod.q_base;
      break;
    case rod::ParameterKind::kLoadScale:
      rod.gravity_m_s2 *= 1.0 + by;
      for (rod::PointLoad& load : rod.loads) load.force_n *= 1.0 + by, load.moment_nm *= 1.0 + by;
      break;
  }
}

std::vector<Case> every_parameter() {
  std::vector<Case> cases;
  for (int c = 0; c < 3; ++c) {
    for (int segment = 0; segment < 2; ++segment) {
      cases.push_back({"rest curvature", {rod::ParameterKind::kRestCurvature, segment, c}, 5e-4});
      cases.push_back({"moment", {rod::ParameterKind::kMoment, segment, c}, 2e-5});
    }
    for (int load = 0; load < 2; ++load) {
      cases.push_back({"force", {rod::ParameterKind::kLoadForce, load, c}, 1e-4});
      cases.push_back({"load moment", {rod::ParameterKind::kLoadMoment, load, c}, 2e-5});
      cases.push_back({"offset", {rod::ParameterKind::kLoadOffset, load, c}, 1e-4});
    }
    cases.push_back({"gravity", {rod::ParameterKind::kGravity, 0, c}, 1e-3});
    cases.push_back({"base rotation", {rod::ParameterKind::kBaseRotation, 0, c}, 1e-4});
  }
  for (int segment = 0; segment < 2; ++segment) {
    cases.push_back({"bending", {rod::ParameterKind::kBendingCompliance, segment, 0}, 2e-3});
    cases.push_back({"torsion", {rod::ParameterKind::kTorsionalCompliance, segment, 0}, 1e-2});
    cases.push_back({"axial", {rod::ParameterKind::kAxialCompliance, segment, 0}, 1e-4});
    cases.push_back({"shear", {rod::ParameterKind::kShearCompliance, segment, 0}, 1e-4});
    for (int c = 0; c < 2; ++c)
      cases.push_back({"anisotropy", {rod::ParameterKind::kBendingAnisotropy, segment, c}, 1e-3});
    cases.push_back({"joint", {rod::ParameterKind::kJointCompliance, segment, 0}, 1e-3});
    cases.push_back({"length", {rod::ParameterKind::kLength, segment, 0}, 1e-4});
    cases.push_back({"mass", {rod::ParameterKind::kSegmentMass, segment, 0}, 1e-4});
  }
  cases.push_back({"load mass", {rod::ParameterKind::kLoadMass, 0, 0}, 1e-4});
  cases.push_back({"load mass", {rod::ParameterKind::kLoadMass, 1, 0}, 1e-4});
  cases.push_back({"load scale", {rod::ParameterKind::kLoadScale, 0, 0}, 2e-5});
  return cases;
}

TEST(Derivatives, AgreeWithCentralDifferences) {
  rod::Rod rod = testing::complicated_rod();
  rod.segments[0].joint_compliance = 0.4;
  rod.segments[1].joint_compliance = 0.9;
  const std::vector<double> stations = {0.04, 0.15, 0.26, 0.32};
  const std::vector<Case> cases = every_parameter();
  std::vector<rod::Parameter> parameters;
  for (const Case& c : cases) parameters.push_back(c.parameter);
  rod::SolverOptions exact;
  exact.position_tolerance = 1e-11;
  exact.linear_correction_rad = 1e-10;
  rod::Solver solver(rod, stations, parameters, exact);
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  const Eigen::Quaterniond q_tip = solver.q_tip();

  for (std::size_t j = 0; j < cases.size(); ++j) {
    rod::Solver plus(rod, stations, {}, exact), minus(rod, stations, {}, exact);
    rod::Rod more = rod, less = rod;
    move(more, cases[j].parameter, cases[j].step);
    move(less, cases[j].parameter, -cases[j].step);
    ASSERT_EQ(plus.solve(more, q_tip), rod::SolveStatus::kConverged);
    ASSERT_EQ(minus.solve(less, q_tip), rod::SolveStatus::kConverged);
    const double width = 2.0 * cases[j].step;
    for (int i = 0; i < solver.stations(); ++i) {
      const Eigen::Vector3d dp = (plus.station(i).p - minus.station(i).p) / width;
      const Eigen::Vector3d turn = math::log_so3(plus.station(i).q * minus.station(i).q.conjugate()) / width;
      const double scale = 1e-6 * (dp.norm() + 0.3 * turn.norm());
      const std::string what = std::string(cases[j].name) + " " + std::to_string(cases[j].parameter.index) +
                               " " + std::to_string(cases[j].parameter.component) + " at station " +
                               std::to_string(i);
      EXPECT_LT((solver.dp(i).col(static_cast<int>(j)) - dp).norm(), scale + 1e-8) << what;
      EXPECT_LT((solver.drotation(i).col(static_cast<int>(j)) - turn).norm(), 10 * scale + 1e-7) << what;
    }
    const Eigen::Vector3d tip = math::log_so3(plus.q_tip() * minus.q_tip().conjugate()) / width;
    EXPECT_LT((solver.drotation_tip().col(static_cast<int>(j)) - tip).norm(), 1e-5 * tip.norm() + 1e-7);
  }
}

TEST(Derivatives, DoNotDependOnTheOrderOfParameters) {
  // The first block of SIMD lanes has other tenants than the rest: the same parameter must give the same in
  // both.
  const rod::Rod rod = testing::loaded_arm();
  std::vector<rod::Parameter> parameters(11, rod::Parameter{rod::ParameterKind::kBendingCompliance, 0, 0});
  rod::Solver solver(rod, {0.2}, parameters);
  ASSERT_EQ(solver.solve(rod), rod::SolveStatus::kConverged);
  for (int j = 1; j < 11; ++j) {
    EXPECT_NEAR((solver.dp(0).col(j) - solver.dp(0).col(0)).norm(), 0.0, 1e-16) << j;
  }
}

}  // namespace
}  // namespace softarm::rod
