// Derivatives by every parameter against central differences.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rods.h"
#include "softarm/math/so3.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

struct Case {
  const char* name;
  Parameter parameter;
  double step;
};

void move(Rod& rod, const Parameter& p, double by) {
  const auto i = static_cast<std::size_t>(p.index);
  switch (p.kind) {
    case ParameterKind::kRestCurvature:
      rod.segments[i].rest_curvature_per_m[p.component] += by;
      break;
    case ParameterKind::kMoment:
      rod.segments[i].moment_nm[p.component] += by;
      break;
    case ParameterKind::kBendingCompliance:
      rod.segments[i].bending_compliance += by;
      break;
    case ParameterKind::kTorsionalCompliance:
      rod.segments[i].torsional_compliance += by;
      break;
    case ParameterKind::kAxialCompliance:
      rod.segments[i].axial_compliance += by;
      break;
    case ParameterKind::kShearCompliance:
      rod.segments[i].shear_compliance += by;
      break;
    case ParameterKind::kLength:
      rod.segments[i].length_m += by;
      break;
    case ParameterKind::kSegmentMass:
      rod.segments[i].mass_kg += by;
      break;
    case ParameterKind::kLoadForce:
      rod.loads[i].force_n[p.component] += by;
      break;
    case ParameterKind::kLoadMoment:
      rod.loads[i].moment_nm[p.component] += by;
      break;
    case ParameterKind::kLoadMass:
      rod.loads[i].mass_kg += by;
      break;
    case ParameterKind::kLoadOffset:
      rod.loads[i].offset_m[p.component] += by;
      break;
    case ParameterKind::kGravity:
      rod.gravity_m_s2[p.component] += by;
      break;
    case ParameterKind::kBaseRotation:
      rod.q_base = exp_so3(by * Eigen::Vector3d::Unit(p.component)) * rod.q_base;
      break;
    case ParameterKind::kLoadScale:
      rod.gravity_m_s2 *= 1.0 + by;
      for (PointLoad& load : rod.loads) load.force_n *= 1.0 + by, load.moment_nm *= 1.0 + by;
      break;
  }
}

std::vector<Case> every_parameter() {
  std::vector<Case> cases;
  for (int c = 0; c < 3; ++c) {
    for (int segment = 0; segment < 2; ++segment) {
      cases.push_back({"rest curvature", {ParameterKind::kRestCurvature, segment, c}, 5e-4});
      cases.push_back({"moment", {ParameterKind::kMoment, segment, c}, 2e-5});
    }
    for (int load = 0; load < 2; ++load) {
      cases.push_back({"force", {ParameterKind::kLoadForce, load, c}, 1e-4});
      cases.push_back({"load moment", {ParameterKind::kLoadMoment, load, c}, 2e-5});
      cases.push_back({"offset", {ParameterKind::kLoadOffset, load, c}, 1e-4});
    }
    cases.push_back({"gravity", {ParameterKind::kGravity, 0, c}, 1e-3});
    cases.push_back({"base rotation", {ParameterKind::kBaseRotation, 0, c}, 1e-4});
  }
  for (int segment = 0; segment < 2; ++segment) {
    cases.push_back({"bending", {ParameterKind::kBendingCompliance, segment, 0}, 2e-3});
    cases.push_back({"torsion", {ParameterKind::kTorsionalCompliance, segment, 0}, 1e-2});
    cases.push_back({"axial", {ParameterKind::kAxialCompliance, segment, 0}, 1e-4});
    cases.push_back({"shear", {ParameterKind::kShearCompliance, segment, 0}, 1e-4});
    cases.push_back({"length", {ParameterKind::kLength, segment, 0}, 1e-4});
    cases.push_back({"mass", {ParameterKind::kSegmentMass, segment, 0}, 1e-4});
  }
  cases.push_back({"load mass", {ParameterKind::kLoadMass, 0, 0}, 1e-4});
  cases.push_back({"load mass", {ParameterKind::kLoadMass, 1, 0}, 1e-4});
  cases.push_back({"load scale", {ParameterKind::kLoadScale, 0, 0}, 2e-5});
  return cases;
}

TEST(Derivatives, AgreeWithCentralDifferences) {
  const Rod rod = testing::complicated_rod();
  const std::vector<double> stations = {0.04, 0.15, 0.26, 0.32};
  const std::vector<Case> cases = every_parameter();
  std::vector<Parameter> parameters;
  for (const Case& c : cases) parameters.push_back(c.parameter);
  SolverOptions exact;
  exact.position_tolerance = 1e-11;
  exact.linear_correction_rad = 1e-10;
  Solver solver(rod, stations, parameters, exact);
  ASSERT_EQ(solver.solve(rod), SolveStatus::kConverged);
  const Eigen::Quaterniond q_tip = solver.q_tip();

  for (std::size_t j = 0; j < cases.size(); ++j) {
    Solver plus(rod, stations, {}, exact), minus(rod, stations, {}, exact);
    Rod more = rod, less = rod;
    move(more, cases[j].parameter, cases[j].step);
    move(less, cases[j].parameter, -cases[j].step);
    ASSERT_EQ(plus.solve(more, q_tip), SolveStatus::kConverged);
    ASSERT_EQ(minus.solve(less, q_tip), SolveStatus::kConverged);
    const double width = 2.0 * cases[j].step;
    for (int i = 0; i < solver.stations(); ++i) {
      const Eigen::Vector3d dp = (plus.station(i).p - minus.station(i).p) / width;
      const Eigen::Vector3d turn = log_so3(plus.station(i).q * minus.station(i).q.conjugate()) / width;
      const double scale = 1e-6 * (dp.norm() + 0.3 * turn.norm());
      const std::string what = std::string(cases[j].name) + " " + std::to_string(cases[j].parameter.index) +
                               " " + std::to_string(cases[j].parameter.component) + " at station " +
                               std::to_string(i);
      EXPECT_LT((solver.dp(i).col(static_cast<int>(j)) - dp).norm(), scale + 1e-8) << what;
      EXPECT_LT((solver.drotation(i).col(static_cast<int>(j)) - turn).norm(), 10 * scale + 1e-7) << what;
    }
    const Eigen::Vector3d tip = log_so3(plus.q_tip() * minus.q_tip().conjugate()) / width;
    EXPECT_LT((solver.drotation_tip().col(static_cast<int>(j)) - tip).norm(), 1e-5 * tip.norm() + 1e-7);
  }
}

TEST(Derivatives, DoNotDependOnTheOrderOfParameters) {
  // The first block of SIMD lanes has other tenants than the rest: the same parameter must give the same in
  // both.
  const Rod rod = testing::loaded_arm();
  std::vector<Parameter> parameters(11, Parameter{ParameterKind::kBendingCompliance, 0, 0});
  Solver solver(rod, {0.2}, parameters);
  ASSERT_EQ(solver.solve(rod), SolveStatus::kConverged);
  for (int j = 1; j < 11; ++j) {
    EXPECT_NEAR((solver.dp(0).col(j) - solver.dp(0).col(0)).norm(), 0.0, 1e-16) << j;
  }
}

}  // namespace
}  // namespace softarm::rod
