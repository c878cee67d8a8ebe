// What is read from the last sweep: states, derivatives, stability.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solver_impl.h"

namespace softarm::rod {

void Solver::Impl::finish(const Rod& rod) {
  for (int block = 1; block < sweep.blocks(); ++block) sweep.differentiate(block);
  correct_nodes(rod);
  fill_derivatives();
  for (std::size_t i = 0; i < states.size(); ++i) {
    states[i] = state_at_breakpoint(sweep.grid().station_breakpoint[i]);
  }
}

void Solver::Impl::correct_nodes(const Rod& rod) {
  q_tip = (math::exp_so3(correction) * q_tip).normalized();
  for (int k = 0; k < sweep.breakpoints(); ++k) {
    const kernel::LaneState& lanes = sweep.lanes(0, k);
    Node& node = sweep.node(k);
    const Vector3d turn = unknown_lanes(lanes.psi) * correction;
    const Vector3d dm = unknown_lanes(lanes.mu) * correction;
    const Vector3d move = unknown_lanes(lanes.pi) * correction;
    const Vector3d dn = unknown_lanes(lanes.nu) * correction;
    const Quaterniond q =
        math::exp_so3(turn) * Quaterniond(node.y.q[0], node.y.q[1], node.y.q[2], node.y.q[3]);
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

void Solver::Impl::shoot(const Rod& rod) {
  sweep.set_rod(rod, rod);
  sweep.refine(1);
  sweep.integrate(q_tip);
  for (int block = 0; block < sweep.blocks(); ++block) sweep.differentiate(block);
  ++sweeps;
  const int base = sweep.breakpoints() - 1;
  const kernel::State& y = sweep.node(base).y;
  base_error = math::log_so3(Quaterniond(y.q[0], y.q[1], y.q[2], y.q[3]) * rod.q_base.conjugate());
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

void Solver::Impl::fill_derivatives() {
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

RodState Solver::Impl::state(double s, int segment, double flex, const Node& node) const {
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

RodState Solver::Impl::state_at_breakpoint(int k) const {
  const Grid& grid = sweep.grid();
  const int count = static_cast<int>(grid.intervals.size());
  const Interval& interval = grid.intervals[static_cast<std::size_t>(std::min(k, count - 1))];
  const auto first = static_cast<std::size_t>(interval.first_step);
  const auto steps = static_cast<std::size_t>(interval.coarse_steps * sweep.refinement());
  const double flex = k < count ? grid.steps[first].flex[0] : grid.steps[first + steps - 1].flex_proximal;
  return state(grid.s(k), interval.segment, flex, sweep.node(k));
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
      for (int j = 0; j < step.stages(); ++j) step.flex[j] = flex(step.s_distal + step.place(j) * step.h);
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
