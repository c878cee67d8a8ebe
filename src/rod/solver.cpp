#include "softarm/rod/solver.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "softarm/math/so3.h"
#include "sweep.h"

namespace softarm::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Points on the way of a continuation need only be near the path; where that fails, they are tried on it.
constexpr double kNearPathRad = 0.1;
constexpr double kNearPathError = 1e-4;  // of positions, over the rod's length

// Positions err by less than a third of what the embedded estimate says (1000 random arms, tip angles to 160
// degrees).
constexpr double kErrorOverEstimate = 0.5;
// Half as many steps err 2^8 times as much.
constexpr double kErrorOfCoarserGrid = 512.0;

bool finite_and_physical(const Rod& rod) {
  const auto ok = [](const Vector3d& v) { return v.allFinite(); };
  bool good = ok(rod.p_base) && rod.q_base.coeffs().allFinite() && ok(rod.gravity_m_s2);
  for (const Segment& s : rod.segments) {
    good = good && s.length_m > 0.0 && s.mass_kg >= 0.0 && s.torsional_compliance >= 0.0 &&
           s.axial_compliance >= 0.0 && s.shear_compliance >= 0.0 && ok(s.rest_curvature_per_m) &&
           ok(s.moment_nm) && std::isfinite(s.length_m) && std::isfinite(s.mass_kg) &&
           std::isfinite(s.bending_compliance) && std::isfinite(s.torsional_compliance) &&
           std::isfinite(s.axial_compliance) && std::isfinite(s.shear_compliance);
  }
  for (const PointLoad& load : rod.loads) {
    good = good && ok(load.force_n) && ok(load.moment_nm) && ok(load.offset_m) && std::isfinite(load.mass_kg);
  }
  return good;
}

/// Scales gravity and point loads; everything else as in `rod`.
void scale_loads(const Rod& rod, double scale, Rod& out) {
  out = rod;
  out.gravity_m_s2 *= scale;
  for (PointLoad& load : out.loads) {
    load.force_n *= scale;
    load.moment_nm *= scale;
  }
}

Vector3d lane(const kernel::Lanes v[3], int k) {
  return {v[0].value[k], v[1].value[k], v[2].value[k]};
}

Matrix3d unknown_lanes(const kernel::Lanes v[3]) {
  Matrix3d m;
  for (int k = 0; k < kUnknownLanes; ++k) m.col(k) = lane(v, k);
  return m;
}

}  // namespace

struct Solver::Impl {
  Impl(const Rod& layout, std::vector<double> stations_m, std::vector<Parameter> wanted,
       const SolverOptions& o)
      : options(o),
        parameters(std::move(wanted)),
        sweep(layout, stations_m, parameters, o.max_refinement),
        scaled(layout),
        states(stations_m.size()),
        dp(stations_m.size(), Eigen::Matrix3Xd::Zero(3, static_cast<int>(parameters.size()))),
        drotation(dp),
        drotation_tip(Eigen::Matrix3Xd::Zero(3, static_cast<int>(parameters.size()))),
        dbase(drotation_tip) {
    sweep.set_rod(layout, layout);
    sweep.refine(1);
  }

  enum class Newton { kConverged, kFar, kDiverged };

  /// Newton on the base's orientation with the rod of the last set_rod; q_tip is updated. On kConverged the
  /// last sweep lies within a linear correction (`correction`) of equilibrium.
  /// @param accept_rad a correction below this ends the iteration
  Newton newton(const Quaterniond& q_base, double largest_change, double accept_rad) {
    double total = 0.0;
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < options.max_newton_iterations; ++i) {
      position_error = kErrorOverEstimate * sweep.integrate(q_tip);
      sweep.differentiate(0);
      ++sweeps;
      const int base = sweep.breakpoints() - 1;
      const kernel::State& y = sweep.node(base).y;
      const Vector3d error = log_so3(Quaterniond(y.q[0], y.q[1], y.q[2], y.q[3]) * q_base.conjugate());
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
      q_tip = (exp_so3(correction) * q_tip).normalized();
      correction.setZero();
    }
    return Newton::kDiverged;
  }

  /// Largest rotation of any breakpoint for a rotation of the tip and, unless lane_index is -1, a unit of
  /// that lane. Under large loads the tip hardly turns where the rest does.
  double largest_turn(const Vector3d& tip, int lane_index) const {
    double largest = 0.0;
    for (int k = 0; k < sweep.breakpoints(); ++k) {
      const kernel::LaneState& lanes = sweep.lanes(0, k);
      Vector3d turn = unknown_lanes(lanes.psi) * tip;
      if (lane_index >= 0) turn += lane(lanes.psi, lane_index);
      largest = std::max(largest, turn.squaredNorm());
    }
    return std::sqrt(largest);
  }

  /// False where an odd number of modes is unstable (see Solver::stable).
  bool no_odd_instability() const {
    for (int k = 0; k < sweep.breakpoints(); ++k) {
      if (!(unknown_lanes(sweep.lanes(0, k).psi).determinant() > 0.0)) return false;
    }
    return true;
  }

  /// Rotation of the tip per unit of load scale, at the last sweep.
  Vector3d tip_per_load_scale() const {
    return -(inverse * lane(sweep.lanes(0, sweep.breakpoints() - 1).psi, kLoadScaleLane));
  }

  /// Newton with as fine a grid as the accuracy asks for. @param position_tolerance over the rod's length
  Newton newton_refined(const Quaterniond& q_base, double largest_change, double accept_rad,
                        double position_tolerance) {
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

  /// Tip orientation of the rod without loads: the product of its arcs.
  Quaterniond unloaded_tip(const Rod& rod) const {
    Quaterniond q = rod.q_base;
    for (const Segment& segment : rod.segments) {
      // With a profile the curvature varies about a fixed axis (or nearly so): a few midpoints are close
      // enough.
      const int pieces = segment.stiffness_profile.empty() ? 1 : 16;
      const Vector3d compliance(segment.bending_compliance, segment.bending_compliance,
                                segment.torsional_compliance);
      for (int i = 0; i < pieces; ++i) {
        const double flex = flexibility_factor(segment.stiffness_profile, (i + 0.5) / pieces);
        const Vector3d u = segment.rest_curvature_per_m + flex * compliance.cwiseProduct(segment.moment_nm);
        q = q * exp_so3(u * (segment.length_m / pieces));
      }
    }
    return q.normalized();
  }

  SolveStatus cold(const Rod& rod) {
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

  /// From `start`, whose tip is near q_start, to `rod`.
  SolveStatus from(const Rod& start, const Quaterniond& q_start, const Rod& rod) {
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

  /// Follows the path of equilibria from t = 0, where the last newton() converged, to t = 1.
  /// @param by_loads the load-scale lane is the path's direction; else the predictor is a secant
  /// @param near_path_rad how near to the path its points on the way must be
  template <typename SetPath>
  SolveStatus follow(const SetPath& set_path, bool by_loads, double near_path_rad) {
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
      q_tip = (exp_so3(slope * (next - t)) * q_from).normalized();
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
      q_tip = (exp_so3(correction) * q_tip).normalized();
      const double miss = log_so3(q_tip * q_predicted.conjugate()).norm();
      if (by_loads) {
        slope = tip_per_load_scale();
      } else {
        slope = log_so3(q_tip * q_from.conjugate()) / (next - t);
      }
      dt = (next - t) * std::clamp(0.7 * std::sqrt(0.25 / std::max(miss, 1e-6)), 0.4, 3.0);
      dt = std::max(dt, options.smallest_continuation_step);
      t = next;
    }
    return SolveStatus::kConverged;
  }

  void finish(const Rod& rod) {
    for (int block = 1; block < sweep.blocks(); ++block) sweep.differentiate(block);
    correct_nodes(rod);
    fill_derivatives();
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = state_at_breakpoint(sweep.grid().station_breakpoint[i]);
    }
  }

  /// Applies the last Newton correction to the nodes, and moves the rod so that its base lies in p_base.
  void correct_nodes(const Rod& rod) {
    q_tip = (exp_so3(correction) * q_tip).normalized();
    for (int k = 0; k < sweep.breakpoints(); ++k) {
      const kernel::LaneState& lanes = sweep.lanes(0, k);
      Node& node = sweep.node(k);
      const Vector3d turn = unknown_lanes(lanes.psi) * correction;
      const Vector3d dm = unknown_lanes(lanes.mu) * correction;
      const Vector3d move = unknown_lanes(lanes.pi) * correction;
      const Vector3d dn = unknown_lanes(lanes.nu) * correction;
      const Quaterniond q = exp_so3(turn) * Quaterniond(node.y.q[0], node.y.q[1], node.y.q[2], node.y.q[3]);
      node.y.q[0] = q.w(), node.y.q[1] = q.x(), node.y.q[2] = q.y(), node.y.q[3] = q.z();
      for (int r = 0; r < 3; ++r) {
        node.y.m[r] += dm[r];
        node.y.p[r] += move[r];
        node.n[r] += dn[r];
      }
    }
    const Node base = sweep.node(sweep.breakpoints() - 1);
    for (int k = 0; k < sweep.breakpoints(); ++k) {
      for (int r = 0; r < 3; ++r) sweep.node(k).y.p[r] += rod.p_base[r] - base.y.p[r];
    }
  }

  void shoot(const Rod& rod) {
    sweep.set_rod(rod, rod);
    sweep.refine(1);
    sweep.integrate(q_tip);
    for (int block = 0; block < sweep.blocks(); ++block) sweep.differentiate(block);
    ++sweeps;
    const int base = sweep.breakpoints() - 1;
    const kernel::State& y = sweep.node(base).y;
    base_error = log_so3(Quaterniond(y.q[0], y.q[1], y.q[2], y.q[3]) * rod.q_base.conjugate());
    base_per_tip = unknown_lanes(sweep.lanes(0, base).psi);
    correction.setZero();
    correct_nodes(rod);
    for (int j = 0; j < static_cast<int>(parameters.size()); ++j) {
      const int block = Sweep::block_of(j);
      const int k = Sweep::lane_of(j);
      const kernel::LaneState& at_base = sweep.lanes(block, base);
      dbase.col(j) = lane(at_base.psi, k);
      if (parameters[static_cast<std::size_t>(j)].kind == ParameterKind::kBaseRotation) {
        dbase.col(j) -= Vector3d::Unit(parameters[static_cast<std::size_t>(j)].component);
      }
      for (std::size_t i = 0; i < states.size(); ++i) {
        const kernel::LaneState& own = sweep.lanes(block, sweep.grid().station_breakpoint[i]);
        dp[i].col(j) = lane(own.pi, k) - lane(at_base.pi, k);
        drotation[i].col(j) = lane(own.psi, k);
      }
    }
    for (std::size_t i = 0; i < states.size(); ++i) {
      states[i] = state_at_breakpoint(sweep.grid().station_breakpoint[i]);
    }
  }

  void fill_derivatives() {
    const int base = sweep.breakpoints() - 1;
    const Matrix3d base_pi = unknown_lanes(sweep.lanes(0, base).pi);
    for (int j = 0; j < static_cast<int>(parameters.size()); ++j) {
      const Parameter& parameter = parameters[static_cast<std::size_t>(j)];
      const int block = Sweep::block_of(j);
      const int k = Sweep::lane_of(j);
      const kernel::LaneState& at_base = sweep.lanes(block, base);
      Vector3d wanted = -lane(at_base.psi, k);
      if (parameter.kind == ParameterKind::kBaseRotation) wanted += Vector3d::Unit(parameter.component);
      const Vector3d tip = inverse * wanted;
      drotation_tip.col(j) = tip;
      const Vector3d origin = lane(at_base.pi, k) + base_pi * tip;
      for (std::size_t i = 0; i < states.size(); ++i) {
        const int breakpoint = sweep.grid().station_breakpoint[i];
        const kernel::LaneState& own = sweep.lanes(block, breakpoint);
        const kernel::LaneState& unknowns = sweep.lanes(0, breakpoint);
        dp[i].col(j) = lane(own.pi, k) + unknown_lanes(unknowns.pi) * tip - origin;
        drotation[i].col(j) = lane(own.psi, k) + unknown_lanes(unknowns.psi) * tip;
      }
    }
  }

  RodState state(double s, int segment, double flex, const Node& node) const {
    RodState r;
    r.s_m = s;
    r.q = Quaterniond(node.y.q[0], node.y.q[1], node.y.q[2], node.y.q[3]).normalized();
    double u[3], v[3];
    kernel::strains(sweep.section(segment), flex, node.y, node.n, u, v);
    for (int i = 0; i < 3; ++i) {
      r.p[i] = node.y.p[i];
      r.n[i] = node.n[i];
      r.m[i] = node.y.m[i];
      r.u[i] = u[i];
      r.v[i] = v[i];
    }
    return r;
  }

  RodState state_at_breakpoint(int k) const {
    const Grid& grid = sweep.grid();
    const int count = static_cast<int>(grid.intervals.size());
    const Interval& interval = grid.intervals[static_cast<std::size_t>(std::min(k, count - 1))];
    const auto first = static_cast<std::size_t>(interval.first_step);
    const auto steps = static_cast<std::size_t>(interval.coarse_steps * sweep.refinement());
    const double flex =
        k < count ? grid.steps[first].flex[0] : grid.steps[first + steps - 1].flex[kernel::kStages - 1];
    return state(grid.s(k), interval.segment, flex, sweep.node(k));
  }

  SolverOptions options;
  std::vector<Parameter> parameters;
  Sweep sweep;
  Rod scaled;
  double length = 0.0;
  int sweeps = 0;
  double position_error = 0.0;
  Quaterniond q_tip = Quaterniond::Identity();
  Vector3d correction = Vector3d::Zero();
  Matrix3d base_per_tip = Matrix3d::Identity();
  Matrix3d inverse = Matrix3d::Identity();
  std::vector<RodState> states;
  std::vector<Eigen::Matrix3Xd> dp, drotation;
  Eigen::Matrix3Xd drotation_tip;
  Vector3d base_error = Vector3d::Zero();
  Eigen::Matrix3Xd dbase;
};

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

const Vector3d& Solver::base_error() const {
  return impl_->base_error;
}
Eigen::Ref<const Eigen::Matrix3Xd> Solver::dbase() const {
  return impl_->dbase;
}
Matrix3d Solver::dp_by_tip(int i) const {
  const Sweep& sweep = impl_->sweep;
  const int k = sweep.grid().station_breakpoint[static_cast<std::size_t>(i)];
  return unknown_lanes(sweep.lanes(0, k).pi) - unknown_lanes(sweep.lanes(0, sweep.breakpoints() - 1).pi);
}

int Solver::stations() const {
  return static_cast<int>(impl_->states.size());
}
const RodState& Solver::station(int i) const {
  return impl_->states[static_cast<std::size_t>(i)];
}
const Quaterniond& Solver::q_tip() const {
  return impl_->q_tip;
}
Eigen::Ref<const Eigen::Matrix3Xd> Solver::dp(int i) const {
  return impl_->dp[static_cast<std::size_t>(i)];
}
Eigen::Ref<const Eigen::Matrix3Xd> Solver::drotation(int i) const {
  return impl_->drotation[static_cast<std::size_t>(i)];
}
Eigen::Ref<const Eigen::Matrix3Xd> Solver::drotation_tip() const {
  return impl_->drotation_tip;
}
const Matrix3d& Solver::base_per_tip_rotation() const {
  return impl_->base_per_tip;
}
int Solver::sweeps() const {
  return impl_->sweeps;
}
int Solver::refinement() const {
  return impl_->sweep.refinement();
}

RodState Solver::at(double s_m) const {
  const Impl& m = *impl_;
  const Grid& grid = m.sweep.grid();
  const double s = std::clamp(s_m, 0.0, grid.s(0));
  int k = 0;
  while (k + 1 < grid.breakpoints() && grid.s(k + 1) >= s) ++k;
  Node node = m.sweep.node(k);
  if (k + 1 == grid.breakpoints() || grid.s(k) == s) return m.state_at_breakpoint(k);
  const Interval& interval = grid.intervals[static_cast<std::size_t>(k)];
  const Segment& segment = m.scaled.segments[static_cast<std::size_t>(interval.segment)];
  const double start = grid.segment_start[static_cast<std::size_t>(interval.segment)];
  const auto flex = [&](double place) {
    return flexibility_factor(segment.stiffness_profile, (place - start) / segment.rest_length_m);
  };
  for (auto i = static_cast<std::size_t>(interval.first_step);; ++i) {  // whole steps, then the rest of one
    kernel::Step step = grid.steps[i];
    const bool partial = step.s_distal + step.h < s;
    if (partial) {
      step.h = s - step.s_distal;
      for (int j = 0; j < kernel::kStages; ++j) step.flex[j] = flex(step.s_distal + kernel::kC[j] * step.h);
    }
    m.sweep.nominal_step(step, node);
    for (int r = 0; r < 3; ++r) node.n[r] -= step.h * step.section->weight[r];
    if (partial || step.s_distal + step.h <= s) break;
  }
  return m.state(s, interval.segment, flex(s), node);
}

bool Solver::stable() const {
  // The base's turn per turn of the tip is the identity for a short rod; it becomes singular at a conjugate
  // point. Two equal modes of a round rod leave the determinant's sign alone but show as two negative real
  // eigenvalues.
  for (int k = 1; k < impl_->sweep.breakpoints(); ++k) {
    const Matrix3d turn = unknown_lanes(impl_->sweep.lanes(0, k).psi);
    const Eigen::Vector3cd eigenvalues = turn.eigenvalues();
    for (int i = 0; i < 3; ++i) {
      if (eigenvalues[i].real() < 0.0 && std::abs(eigenvalues[i].imag()) < 1e-6) return false;
    }
  }
  return true;
}

}  // namespace softarm::rod
