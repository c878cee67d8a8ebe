#include "arm_rod.h"

#include <algorithm>

#include "body_kinematics.h"
#include "math/so3.h"

namespace softarm::model {

std::vector<rod::Parameter> segment_parameters(const arm::Arm& arm) {
  std::vector<rod::Parameter> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    list.push_back({rod::ParameterKind::kMoment, i, 0});
    list.push_back({rod::ParameterKind::kMoment, i, 1});
    list.push_back({rod::ParameterKind::kBendingCompliance, i, 0});
    list.push_back({rod::ParameterKind::kLength, i, 0});
  }
  return list;
}

std::vector<double> body_stations(const arm::Arm& arm) {
  std::vector<double> list;
  for (const arm::MeasuredBody& body : arm.bodies)
    list.push_back(std::min(body.arclength_m, arm.total_length_m()));
  return list;
}

rod::SolverOptions solver_options(double orientation_tolerance_rad, double position_tolerance) {
  rod::SolverOptions options;
  options.linear_correction_rad = 1e-4;  // positions are exact to its square
  options.orientation_tolerance_rad = orientation_tolerance_rad;
  options.position_tolerance = position_tolerance;
  return options;
}

Eigen::Matrix3Xd position_by_rod(const arm::MeasuredBody& measured, int body, const rod::Solver& solver) {
  Eigen::Matrix3Xd by_rod = solver.dp(body);
  carry_position(measured, solver.station(body), solver.drotation(body), by_rod);
  return by_rod;
}

Eigen::Matrix3Xd tangent_by_rod(int body, const rod::Solver& solver) {
  return tangent_derivative(solver.station(body), solver.drotation(body));
}

std::optional<Eigen::Quaterniond> Equilibrium::tip_at(const Eigen::VectorXd& at, double most_rad) const {
  const Eigen::Vector3d turn = tip_by_x * (at - x);
  if (!(turn.norm() < most_rad)) return std::nullopt;
  return (math::exp_so3(turn) * q_tip).normalized();
}

bool near_buckling(const rod::Solver& solver) {
  constexpr double kTipPerBase = 4.0;
  return solver.base_per_tip_rotation().inverse().norm() >= kTipPerBase;
}

}  // namespace softarm::model
