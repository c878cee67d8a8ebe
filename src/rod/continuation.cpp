// Newton's method on the base's orientation, and the path of equilibria where it alone would not stay on its
// branch.
#include <algorithm>
#include <limits>

#include "solver_impl.h"

namespace softarm::rod {
namespace {

// Points on the way of a continuation need only be near the path; where that fails, they are tried on it.
constexpr double kNearPathRad = 0.1;
constexpr double kNearPathError = 1e-4;  // of positions, over the rod's length

// Positions err by less than a third of what the embedded estimate says (1000 random arms, tip angles to 160
// degrees).
constexpr double kErrorOverEstimate = 0.5;
/// Scales gravity and point loads; everything else as in `rod`.
void scale_loads(const Rod& rod, double scale, Rod& out) {
  out = rod;
  out.gravity_m_s2 *= scale;
  for (PointLoad& load : out.loads) {
    load.force_n *= scale;
    load.moment_nm *= scale;
  }
}

}  // namespace

template <typename SetPath>
SolveStatus Solver::Impl::follow(const SetPath& set_path, bool by_loads, double near_path_rad) {
  const bool long_steps = near_path_rad >= kNearPathRad;
  const double largest_change = long_steps ? 0.7 : 0.5;
  const int budget = sweeps + options.max_sweeps;
  double t = 0.0;
  double dt = 1.0;
  Vector3d slope = by_loads ? tip_per_load_scale() : Vector3d::Zero().eval();
  if (by_loads)
    dt = std::min(1.0, (long_steps ? 1.2 : 0.6) / std::max(largest_turn(slope, kLoadScaleLane), 1e-9));
  while (t < 1.0) {
    const Quaterniond q_from = q_tip;
    const double next = std::min(1.0, t + dt);
    q_tip = (math::exp_so3(slope * (next - t)) * q_from).normalized();
    const Quaterniond q_base = set_path(next);
    const Quaterniond q_predicted = q_tip;
    const bool last = next >= 1.0;
    const Newton result = last ? newton_refined(q_base, largest_change, options.linear_correction_rad,
                                                options.position_tolerance)
                               : newton_refined(q_base, largest_change, near_path_rad, kNearPathError);
    if (result != Newton::kConverged) {
      q_tip = q_from;
      dt = 0.4 * (next - t);
      if (dt < options.smallest_continuation_step || sweeps > budget) return SolveStatus::kNoConvergence;
      continue;
    }
    if (last) break;
    if (sweeps > budget) return SolveStatus::kNoConvergence;
    q_tip = (math::exp_so3(correction) * q_tip).normalized();
    const double miss = math::log_so3(q_tip * q_predicted.conjugate()).norm();
    if (by_loads) {
      slope = tip_per_load_scale();
    } else {
      slope = math::log_so3(q_tip * q_from.conjugate()) / (next - t);
    }
    dt = (next - t) * std::clamp(0.7 * std::sqrt(0.25 / std::max(miss, 1e-6)), 0.4, 3.0);
    dt = std::max(dt, options.smallest_continuation_step);
    t = next;
  }
  return SolveStatus::kConverged;
}

Solver::Impl::Newton Solver::Impl::newton(const Quaterniond& q_base, double largest_change,
                                          double accept_rad) {
  double total = 0.0;
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.max_newton_iterations; ++i) {
    position_error = kErrorOverEstimate * sweep.integrate(q_tip);
    sweep.differentiate(0);
    ++sweeps;
    const int base = sweep.breakpoints() - 1;
    const kernel::State& y = sweep.node(base).y;
    const Vector3d error = math::log_so3(Quaterniond(y.q[0], y.q[1], y.q[2], y.q[3]) * q_base.conjugate());
    if (!error.allFinite()) return Newton::kDiverged;
    base_per_tip = unknown_lanes(sweep.lanes(0, base).psi);
    inverse = base_per_tip.inverse();
    correction = -(inverse * error);
    const double size = error.norm();
    if (!correction.allFinite()) return Newton::kDiverged;
    const double step = largest_turn(correction, -1);
    total += step;
    if (std::max(step, size) <= accept_rad || size <= options.orientation_tolerance_rad) {
      return Newton::kConverged;
    }
    if (total > largest_change) return Newton::kFar;
    if (i > 0 && size > 0.5 * last) return Newton::kFar;
    last = size;
    q_tip = (math::exp_so3(correction) * q_tip).normalized();
    correction.setZero();
  }
  return Newton::kDiverged;
}

double Solver::Impl::largest_turn(const Vector3d& tip, int lane_index) const {
  double largest = 0.0;
  for (int k = 0; k < sweep.breakpoints(); ++k) {
    const kernel::LaneState& lanes = sweep.lanes(0, k);
    Vector3d turn = unknown_lanes(lanes.psi) * tip;
    if (lane_index >= 0) turn += lane(lanes.psi, lane_index);
    largest = std::max(largest, turn.squaredNorm());
  }
  return std::sqrt(largest);
}

bool Solver::Impl::no_odd_instability() const {
  for (int k = 0; k < sweep.breakpoints(); ++k) {
    if (!(unknown_lanes(sweep.lanes(0, k).psi).determinant() > 0.0)) return false;
  }
  return true;
}

Vector3d Solver::Impl::tip_per_load_scale() const {
  return -(inverse * lane(sweep.lanes(0, sweep.breakpoints() - 1).psi, kLoadScaleLane));
}

Solver::Impl::Newton Solver::Impl::newton_refined(const Quaterniond& q_base, double largest_change,
                                                  double accept_rad, double position_tolerance) {
  while (true) {
    const Quaterniond q_start = q_tip;
    const Newton result = newton(q_base, largest_change, accept_rad);
    const double limit = position_tolerance * length;
    if (result == Newton::kConverged && !(position_error <= limit) &&
        sweep.refinement() * 2 <= options.max_refinement) {
      sweep.refine(sweep.refinement() * 2);
      if (accept_rad > options.linear_correction_rad) q_tip = q_start;
      continue;
    }
    // The finest grid was not fine enough: rather no answer than a wrong one.
    if (result == Newton::kConverged && !(position_error <= 10.0 * limit)) return Newton::kDiverged;
    return result;
  }
}

Quaterniond Solver::Impl::unloaded_tip(const Rod& rod) const {
  Quaterniond q = rod.q_base;
  for (const Segment& segment : rod.segments) {
    // With a profile the curvature varies about a fixed axis (or nearly so): a few midpoints are close
    // enough.
    const int pieces = segment.stiffness_profile.empty() ? 1 : 16;
    Vector3d driven = segment.torsional_compliance * segment.moment_nm;
    driven.head<2>() = segment.curvature_of(segment.moment_nm.head<2>());
    for (int i = 0; i < pieces; ++i) {
      const double flex = flexibility_factor(segment.stiffness_profile, (i + 0.5) / pieces);
      const Vector3d u = segment.rest_curvature_per_m + flex * driven;
      q = q * math::exp_so3(u * (segment.length_m / pieces));
    }
  }
  return q.normalized();
}

SolveStatus Solver::Impl::cold(const Rod& rod) {
  const auto set_path = [&](double t) {
    if (t < 1.0) {
      scale_loads(rod, t, scaled);
      sweep.set_rod(scaled, rod);
    } else {
      sweep.set_rod(rod, rod);
    }
    return rod.q_base;
  };
  const Quaterniond q_unloaded = unloaded_tip(rod);
  for (const double near_path_rad : {kNearPathRad, options.linear_correction_rad}) {
    q_tip = q_unloaded;
    set_path(0.0);
    sweep.refine(1);
    if (newton(rod.q_base, 3.0, options.linear_correction_rad) != Newton::kConverged) break;
    const SolveStatus status = follow(set_path, true, near_path_rad);
    // Long steps may have left the branch for one that no arm takes; then the path is walked again in short
    // ones.
    if (status == SolveStatus::kConverged && (near_path_rad < kNearPathRad || no_odd_instability()))
      return status;
  }
  return SolveStatus::kNoConvergence;
}

SolveStatus Solver::Impl::from(const Rod& start, const Quaterniond& q_start, const Rod& rod) {
  const auto set_path = [&](double t) {
    if (t < 1.0) {
      interpolate(start, rod, t, scaled);
      sweep.set_rod(scaled, rod);
    } else {
      sweep.set_rod(rod, rod);
    }
    return t < 1.0 ? scaled.q_base : rod.q_base;
  };
  for (const double near_path_rad : {kNearPathRad, options.linear_correction_rad}) {
    q_tip = q_start;
    const Quaterniond q_base = set_path(0.0);
    if (newton(q_base, options.largest_tip_change_rad, options.linear_correction_rad) != Newton::kConverged)
      break;
    if (follow(set_path, false, near_path_rad) == SolveStatus::kConverged) return SolveStatus::kConverged;
  }
  return SolveStatus::kNoConvergence;
}

}  // namespace softarm::rod
