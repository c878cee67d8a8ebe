#include <utility>

#include "solver_impl.h"

namespace softarm::rod {
namespace {

// Half as many steps err 2^8 times as much.
constexpr double kErrorOfCoarserGrid = 512.0;

bool finite_and_physical(const Rod& rod) {
  const auto ok = [](const Vector3d& v) { return v.allFinite(); };
  bool good = ok(rod.p_base) && rod.q_base.coeffs().allFinite() && ok(rod.gravity_m_s2);
  for (const Segment& s : rod.segments) {
    good = good && s.length_m > 0.0 && s.mass_kg >= 0.0 && s.torsional_compliance >= 0.0 &&
           s.axial_compliance >= 0.0 && s.shear_compliance >= 0.0 && std::isfinite(s.joint_compliance) &&
           ok(s.rest_curvature_per_m) && ok(s.moment_nm) && std::isfinite(s.length_m) &&
           std::isfinite(s.mass_kg) && std::isfinite(s.bending_compliance) &&
           std::isfinite(s.torsional_compliance) && std::isfinite(s.axial_compliance) &&
           std::isfinite(s.shear_compliance) && s.anisotropy.squaredNorm() < 1.0;
  }
  for (const PointLoad& load : rod.loads) {
    good = good && ok(load.force_n) && ok(load.moment_nm) && ok(load.offset_m) && std::isfinite(load.mass_kg);
  }
  return good;
}

}  // namespace

Solver::Solver(const Rod& layout, std::vector<double> stations_m, std::vector<Parameter> parameters,
               const SolverOptions& options)
    : impl_(std::make_unique<Impl>(layout, std::move(stations_m), std::move(parameters), options)) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

SolveStatus Solver::solve(const Rod& rod) {
  Impl& m = *impl_;
  m.sweeps = 0;
  if (!finite_and_physical(rod)) return SolveStatus::kInvalidInput;
  m.length = rod.rest_length_m();
  const SolveStatus status = m.cold(rod);
  if (status == SolveStatus::kConverged) m.finish(rod);
  return status;
}

SolveStatus Solver::solve(const Rod& rod, const Quaterniond& q_tip, const Rod* from) {
  Impl& m = *impl_;
  m.sweeps = 0;
  if (!finite_and_physical(rod) || !q_tip.coeffs().allFinite()) return SolveStatus::kInvalidInput;
  m.length = rod.rest_length_m();
  m.q_tip = q_tip;
  m.sweep.set_rod(rod, rod);
  if (m.sweep.refinement() > 1 &&
      m.position_error * kErrorOfCoarserGrid < m.options.position_tolerance * m.length) {
    m.sweep.refine(m.sweep.refinement() / 2);
  }
  if (m.newton_refined(rod.q_base, m.options.largest_tip_change_rad, m.options.linear_correction_rad,
                       m.options.position_tolerance) != Impl::Newton::kConverged) {
    if (from == nullptr || !finite_and_physical(*from)) return SolveStatus::kNoConvergence;
    const SolveStatus status = m.from(*from, q_tip, rod);
    if (status != SolveStatus::kConverged) return status;
  }
  m.finish(rod);
  return SolveStatus::kConverged;
}

SolveStatus Solver::shoot(const Rod& rod, const Quaterniond& q_tip) {
  Impl& m = *impl_;
  m.sweeps = 0;
  if (!finite_and_physical(rod) || !q_tip.coeffs().allFinite()) return SolveStatus::kInvalidInput;
  m.length = rod.rest_length_m();
  m.q_tip = q_tip;
  m.shoot(rod);
  return m.base_error.allFinite() && m.states.back().p.allFinite() ? SolveStatus::kConverged
                                                                   : SolveStatus::kNoConvergence;
}

}  // namespace softarm::rod
