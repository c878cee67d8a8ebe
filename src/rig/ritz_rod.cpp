#include "softarm/rig/ritz_rod.h"

#include <algorithm>
#include <cmath>

#include "ritz_rod_impl.h"

namespace softarm::rig {

RitzRod::RitzRod(const RitzRodParams& params) : impl_(std::make_unique<Impl>(params)) {}
RitzRod::~RitzRod() = default;
RitzRod::RitzRod(RitzRod&&) noexcept = default;
RitzRod& RitzRod::operator=(RitzRod&&) noexcept = default;

bool RitzRod::settle(const RitzRodInputs& inputs) {
  Impl& m = *impl_;
  const State saved = m.now;
  const RitzRodInputs saved_inputs = m.inputs;
  m.inputs = inputs;
  m.now.q.setZero();
  m.have_factors = false;
  double load = 0.0, increment = 0.125;
  while (load < 1.0) {
    const Eigen::VectorXd start = m.now.q;
    const double target = std::min(1.0, load + increment);
    if (m.solve(Differences{}, target, false)) {
      load = target;
      increment *= 1.5;
    } else {
      m.now.q = start;
      increment *= 0.5;
      if (increment < 1e-4) {
        m.now = saved;
        m.inputs = saved_inputs;
        m.kinematics.update(m.basis, m.now.q, m.inputs.length_m);
        return false;
      }
    }
  }
  m.remember(Differences{});
  m.last = m.before = m.now;
  m.step_s = 0.0;
  return true;
}

bool RitzRod::step(const RitzRodInputs& inputs, double dt_s) {
  Impl& m = *impl_;
  const RitzRodInputs saved_inputs = m.inputs;
  const bool same_step = m.step_s == 0.0 || std::abs(dt_s - m.step_s) < 1e-12;
  const Differences d = same_step ? Differences{dt_s, 1.5, -2.0, 0.5} : Differences{dt_s, 1.0, -1.0, 0.0};
  const State older = m.before;
  m.before = m.last;
  m.last = m.now;
  m.inputs = inputs;
  if (same_step && m.step_s > 0.0) m.now.q = 2.0 * m.last.q - m.before.q;
  bool ok = m.solve(d, 1.0, m.have_factors && same_step);
  if (!ok) {  // the extrapolation may have been wild
    m.now.q = m.last.q;
    ok = m.solve(d, 1.0, false);
  }
  if (!ok) {
    m.now = m.last;
    m.last = m.before;
    m.before = older;
    m.inputs = saved_inputs;
    m.kinematics.update(m.basis, m.now.q, m.inputs.length_m);
    m.have_factors = false;
    return false;
  }
  m.have_factors = same_step;
  m.step_s = dt_s;
  m.remember(d);
  return true;
}

Eigen::Isometry3d RitzRod::pose(double fraction) const {
  const Impl& m = *impl_;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = m.kinematics.rotation_at(m.basis, m.now.q, fraction);
  pose.translation() = m.kinematics.position_at(m.basis, m.inputs.length_m, fraction);
  return pose;
}

Eigen::Vector3d RitzRod::velocity(double fraction) const {
  const Impl& m = *impl_;
  const int e = m.basis.element_of(fraction);
  const auto weights = m.basis.lagrange(fraction * m.basis.elements() - e);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  for (int j = 0; j < StrainBasis::kPoints; ++j)
    v += weights(j) * m.now.stations[static_cast<std::size_t>(e * StrainBasis::kIntervals + j)].v.col(0);
  return v;
}

Eigen::Vector3d RitzRod::curvature(double fraction) const {
  const Impl& m = *impl_;
  const int e = m.basis.element_of(fraction);
  const LocalBasis b = m.basis.evaluate(e, fraction);
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) u += b[static_cast<std::size_t>(i)] * m.now.u.segment<3>(3 * (e + i));
  return u;
}

double RitzRod::energy_j() const {
  const Impl& m = *impl_;
  double energy = -m.inputs.tip_force_base_n.dot(m.now.stations.back().x.col(0));
  for (std::size_t k = 0; k < m.stations; ++k) {
    const Station& s = m.now.stations[k];
    energy +=
        m.station_mass(k) * (0.5 * s.v.col(0).squaredNorm() - m.params.gravity_base_m_s2.dot(s.x.col(0)));
    energy += 0.5 * m.station_inertia(k) * s.v.rightCols<2>().squaredNorm();
  }
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd u = m.now.u(Eigen::seqN(c, m.n / 3, 3));
    energy += 0.5 * m.stiffness(c) * m.inputs.length_m * u.dot(m.basis.gram() * u);
    energy -= m.inputs.moment_section_nm(c) * m.inputs.length_m * u.dot(m.basis.integral());
  }
  return energy;
}

int RitzRod::last_iterations() const {
  return impl_->iterations;
}
std::size_t RitzRod::coefficient_count() const {
  return static_cast<std::size_t>(impl_->n);
}
const Eigen::VectorXd& RitzRod::coefficients() const {
  return impl_->now.q;
}

}  // namespace softarm::rig
