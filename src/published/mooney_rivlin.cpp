#include "mooney_rivlin.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace softarm::published {
namespace {

// C of (20) is positive definite in between (theta = 1/2).
bool usable(double strain) {
  return strain > -0.5 && strain < 1.0;
}

}  // namespace

Eigen::Matrix3d published_strain(const Eigen::Vector3d& strain, double twist, double poisson_ratio) {
  Eigen::Matrix3d y = Eigen::Matrix3d::Zero();
  y.diagonal() << strain[0], -poisson_ratio * strain[0], -poisson_ratio * strain[0];
  y(0, 1) = y(1, 0) = strain[1] + twist;
  y(0, 2) = y(2, 0) = strain[2] - twist;
  return y;
}

Invariants invariants(const Eigen::Matrix3d& cauchy_green) {
  const double trace = cauchy_green.trace();
  return {trace, 0.5 * (trace * trace - (cauchy_green * cauchy_green).trace()), cauchy_green.determinant()};
}

std::optional<Eigen::Matrix3d> published_stress_pa(const arm::MooneyRivlin& material,
                                                   const Eigen::Matrix3d& cauchy_green) {
  if (!cauchy_green.allFinite() || cauchy_green.llt().info() != Eigen::Success) return std::nullopt;
  const Invariants of = invariants(cauchy_green);
  const double pressure = 2.0 / 3.0 * (material.c10_pa * of.i1 - material.c01_pa * of.i2);  // (25)
  const Eigen::Matrix3d transposed = cauchy_green.transpose();
  const Eigen::Matrix3d stress = -pressure * Eigen::Matrix3d::Identity() +
                                 2.0 * material.c10_pa * transposed -
                                 2.0 * material.c01_pa * transposed.inverse();
  if (!stress.allFinite()) return std::nullopt;
  return stress;
}

// With e the strain, I_1 = 3, I_2 = 3 - 3 e^2 and
// sigma_11 = -2 C10 + 2 C01 (1 - e^2) + 2 C10 (1 + 2 e) - 2 C01 / (1 + 2 e); de = lambda_1 d lambda_1.
std::optional<double> published_modulus_pa(const arm::MooneyRivlin& material, double strain) {
  if (!usable(strain)) return std::nullopt;
  const double square = 1.0 + 2.0 * strain;
  return std::sqrt(square) *
         (4.0 * material.c10_pa + 4.0 * material.c01_pa / (square * square) - 4.0 * material.c01_pa * strain);
}

std::optional<double> published_chain_rule_modulus_pa(const arm::MooneyRivlin& material, double strain) {
  if (!usable(strain)) return std::nullopt;
  const double stretch = std::sqrt(1.0 + 2.0 * strain);
  const double lateral_square = 1.0 - strain;
  const double by_i1 = -2.0 / 3.0 * material.c10_pa;  // sigma_11 knows I_1 and I_2 through p* alone
  const double by_i2 = 2.0 / 3.0 * material.c01_pa;
  return by_i1 * 2.0 * stretch + by_i2 * 4.0 * stretch * lateral_square;
}

}  // namespace softarm::published
