#include "rest_modes.h"

#include <vector>

#include "arm_rod.h"
#include "fine_rod.h"
#include "softarm/arm/laws.h"

namespace softarm::model {
namespace {

using Eigen::Index;

constexpr double kTurnOfRest_rad = 1e-10;

Flexibility flexibility_of(const arm::Arm& arm, const FineRod& fine, const rod::Solver& solver) {
  const auto n = static_cast<Index>(fine.stations()), b = static_cast<Index>(arm.bodies.size());
  Flexibility f;
  f.positions.resize(3 * n, 3 * n);
  f.rotations.resize(3 * n, 3 * n);
  f.bodies.resize(6 * b, 3 * n);
  for (Index i = 0; i < b; ++i) {
    const int body = static_cast<int>(i);
    f.bodies.middleRows<3>(3 * i) = position_by_rod(arm.bodies[static_cast<std::size_t>(i)], body, solver);
    f.bodies.middleRows<3>(3 * (b + i)) = tangent_by_rod(body, solver);
  }
  for (Index j = 0; j < n; ++j) {
    const int station = static_cast<int>(b + j);
    f.positions.middleRows<3>(3 * j) = solver.dp(station);
    f.rotations.middleRows<3>(3 * j) = solver.drotation(station);
    f.q.push_back(solver.station(station).q);
  }
  return f;
}

}  // namespace

std::optional<Modes> modes_at_no_input(const arm::Arm& arm, double payload_kg, int count) {
  const auto laws = arm::predict(arm, arm::InputValues(arm.inputs.scalars.size(), 0.0));
  if (!laws) return std::nullopt;
  Eigen::Vector3d gravity = arm.gravity_m_s2;
  if (!arm.base.body) gravity = arm.base.fixed_pose.linear().transpose() * arm.gravity_m_s2;
  return modes_at(arm, *laws, payload_kg, gravity, count);
}

std::optional<Modes> modes_at(const arm::Arm& arm, const std::vector<arm::SegmentPrediction>& segments,
                              double payload_kg, const Eigen::Vector3d& gravity_base, int count) {
  const FineRod fine(arm);
  rod::Rod rod = fine.layout();
  fine.actuate(arm, segments, segments, rod);
  rod.loads[rod::kPayloadLoad].mass_kg = payload_kg;
  rod.gravity_m_s2 = gravity_base;
  std::vector<double> stations = body_stations(arm);
  std::vector<rod::Parameter> forces;
  for (int j = 0; j < fine.stations(); ++j) {
    stations.push_back(fine.station_m(j));
    for (const int axis : {0, 1, 2})
      forces.push_back({rod::ParameterKind::kLoadForce, FineRod::kFirstStation + j, axis});
  }
  rod::Solver solver(fine.layout(), stations, forces, solver_options(kTurnOfRest_rad));
  if (solver.solve(rod) != rod::SolveStatus::kConverged || !solver.stable()) return std::nullopt;
  Rest rest;
  rest.masses_kg = fine.station_masses_kg(rod);
  rest.lengths_m.resize(fine.stations());
  rest.compliance.resize(fine.stations());
  for (int j = 0; j < fine.stations(); ++j) {
    rest.lengths_m[j] = rod.segments[static_cast<std::size_t>(j)].length_m;
    rest.compliance[j] = rod.segments[static_cast<std::size_t>(j)].bending_compliance;
    rest.stations.push_back(solver.station(static_cast<int>(arm.bodies.size()) + j).p);
  }
  Modes modes = modes_of(flexibility_of(arm, fine, solver), rest, count);
  if (modes.stiffness.size() == 0) return std::nullopt;
  return modes;
}

}  // namespace softarm::model
