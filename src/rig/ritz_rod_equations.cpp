// The equations of motion of RitzRod and their solution.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ritz_rod_impl.h"

namespace softarm::rig {
namespace {

/// Of what is left to correct of L u (rad): far below a nanometre at rest, one nanometre in motion. In
/// shorter steps than kUsualStep_s it must fall with their square, or what is left over would be an
/// acceleration.
constexpr double kTolerance = 1e-9, kStepTolerance = 1e-9, kUsualStep_s = 2e-3;
constexpr double kFastContraction = 0.1;  ///< of the corrections: the factors still serve
constexpr int kMaxIterations = 40;

/// The station of a node.
int station_of(int node) {
  return StrainBasis::kIntervals * (node / StrainBasis::kPoints) + node % StrainBasis::kPoints;
}

}  // namespace

void RitzRod::Impl::evaluate(const Differences& d, double load) {
  kinematics.update(mesh, now.q, lengths_m, load);
  const double rate = d.rate();
  for (std::size_t k = 0; k < stations; ++k) {
    forces[k] = mass[k] * load * params.gravity_base_m_s2;
    director_forces[k].setZero();
    if (d.dt > 0.0) {
      const Eigen::Matrix3d v = rate * station_x(k) + past[k].x;
      const Eigen::Matrix3d a = rate * v + past[k].v;
      forces[k] -= mass[k] * a.col(0) + drag[k] * v.col(0);
      director_forces[k] = -inertia[k] * a.rightCols<2>();
    }
  }
  forces.back() += load * inputs.tip_force_base_n;
  add_loads(d, load);
  gather_moments();
  if (payload_off_axis()) add_payload_moment();

  // Elasticity, viscosity and actuation.
  for (std::size_t j = 0; j < lengths_m.size(); ++j) {
    if (!is_plain(j)) continue;
    const StrainBasis& basis = mesh.pieces()[j].basis;
    const double tau = params.pieces[j].retardation_s;
    for (int c = 0; c < 3; ++c) {
      const Coefficients part = coefficients_of(j, c);
      strain_work = part.of(now.q) / lengths_m[j];
      if (d.dt > 0.0 && tau > 0.0)
        strain_work += tau / d.dt *
                       (d.a0 * strain_work + d.a1 * part.of(last.u) + d.a2 * part.of(before.u) +
                        d.a3 * part.of(oldest.u));
      part.of(residual) = stiffness(j, c) * (basis.gram() * strain_work) -
                          load * inputs.pieces[j].moment_section_nm(c) * basis.integral();
    }
  }
  if (!section_nodes.empty()) add_sections(d, load);
  add_stretches(d, load);
  // Virtual work of the moments: each interval turns everything beyond it.
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  for (std::size_t k = stations - 1; k-- > 0;) {
    beyond += moments[k + 1];
    const int first = 3 * mesh.element(static_cast<int>(k) / StrainBasis::kIntervals).first_function;
    residual.segment<12>(first) -= kinematics.work_of(mesh, static_cast<int>(k), beyond);
  }
  if (!base_yields()) return;
  Eigen::Vector3d spring = base_spring(now.q.head<3>()).moment;
  if (d.dt > 0.0)
    spring += params.pieces.front().retardation_s *
              base_stiffness().cwiseProduct(d.apply<Eigen::Vector3d>(now.q.head<3>(), last.u.head<3>(),
                                                                     before.u.head<3>(), oldest.u.head<3>()));
  residual.head<3>() = spring - kinematics.base_turn.transpose() * (beyond + moments[0]);
}

void RitzRod::Impl::gather_moments() {
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  constexpr int kIntervals = StrainBasis::kIntervals;
  for (int e = mesh.elements() - 1; e >= 0; --e) {
    const double scale = lengths_m[static_cast<std::size_t>(mesh.element(e).piece)] * mesh.element(e).size;
    const auto first = static_cast<std::size_t>(e * kIntervals);
    for (int j = 0; j <= kIntervals; ++j) {
      Eigen::Vector3d sum = mesh.integration()(kIntervals, j) * beyond;
      for (int i = 1; i <= kIntervals; ++i)
        sum += mesh.integration()(i, j) * forces[first + static_cast<std::size_t>(i)];
      tangent_forces[static_cast<std::size_t>(e * StrainBasis::kPoints + j)] = scale * sum;
    }
    for (int i = 1; i <= kIntervals; ++i) beyond += forces[first + static_cast<std::size_t>(i)];
  }
  for (std::size_t k = 0; k < stations; ++k) {
    const Eigen::Matrix3d& r = kinematics.rotations[k];
    moments[k] = r.col(0).cross(director_forces[k].col(0)) + r.col(1).cross(director_forces[k].col(1));
  }
  for (int node = 0; node < StrainBasis::kPoints * mesh.elements(); ++node) {
    const auto i = static_cast<std::size_t>(node);
    moments[static_cast<std::size_t>(station_of(node))] += kinematics.tangents[i].cross(tangent_forces[i]);
  }
}

void RitzRod::Impl::factorise(const Differences& d) {
  kinematics.update_jacobians(mesh, lengths_m);
  const double rate = d.rate();
  matrix.setZero();
  for (std::size_t j = 0; j < lengths_m.size(); ++j)
    for (int c = 0; c < 3 && is_plain(j); ++c) {
      const Coefficients part = coefficients_of(j, c);
      part.square_of(matrix) = stiffness(j, c) / lengths_m[j] *
                               (1.0 + params.pieces[j].retardation_s * rate) * mesh.pieces()[j].basis.gram();
    }
  if (!section_nodes.empty()) factorise_sections(d);
  factorise_stretches();
  constexpr int kIntervals = StrainBasis::kIntervals;
  for (int e = 0; e < mesh.elements(); ++e) {
    const int columns = 3 * (mesh.element(e).first_function + 4);
    auto block = matrix.topLeftCorner(columns, columns);
    auto turned = scratch_a.leftCols(columns);
    const int row = 3 * (e * kIntervals + 1);
    const auto rotation = kinematics.rotation_jacobian.block(row, 0, 3 * kIntervals, columns);
    for (int i = 0; i < kIntervals; ++i)
      turned.middleRows<3>(3 * i).noalias() =
          moment_stiffness(static_cast<std::size_t>(e * kIntervals + i) + 1, rate * rate) *
          rotation.middleRows<3>(3 * i);
    block.noalias() += rotation.transpose() * turned;
    if (d.dt > 0.0 || !load_stiffness.empty() || has_draught()) {
      const auto position = kinematics.position_jacobian.block(row, 0, 3 * kIntervals, columns);
      for (int i = 0; i < kIntervals; ++i) {
        const auto k = static_cast<std::size_t>(e * kIntervals + i) + 1;
        turned.middleRows<3>(3 * i) =
            (mass[k] * rate * rate + drag[k] * rate) * position.middleRows<3>(3 * i);
        if (!load_stiffness.empty())
          turned.middleRows<3>(3 * i) += load_stiffness[k] * position.middleRows<3>(3 * i);
        if (has_draught())
          turned.middleRows<3>(3 * i) += draught_stiffness(k) * rotation.middleRows<3>(3 * i);
      }
      block.noalias() += position.transpose() * turned;
    }
  }
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  for (int k = mesh.stations() - 2; k >= 0; --k) {
    beyond += moments[static_cast<std::size_t>(k) + 1];
    const int first = 3 * mesh.element(k / kIntervals).first_function, columns = first + 12;
    matrix.block(first, 0, 12, columns).noalias() -=
        0.5 * (kinematics.turns_of(mesh, k).transpose() * cross_matrix(beyond)) *
        (kinematics.rotation_jacobian.block(3 * k, 0, 3, columns) +
         kinematics.rotation_jacobian.block(3 * k + 3, 0, 3, columns));
  }
  if (base_yields()) {
    const Eigen::Matrix3d& turn = kinematics.base_turn;
    auto block = matrix.topLeftCorner<3, 3>();
    block += base_spring(now.q.head<3>()).stiffness;
    block.diagonal() += params.pieces.front().retardation_s * rate * base_stiffness();
    block += turn.transpose() * (moment_stiffness(0, rate * rate) - 0.5 * cross_matrix(beyond + moments[0])) *
             turn;
  }
  if (payload_off_axis()) factorise_payload(rate * rate);
  factors.compute(matrix);
}

Eigen::Matrix3d RitzRod::Impl::moment_stiffness(std::size_t k, double rate2) const {
  const Eigen::Matrix3d& r = kinematics.rotations[k];
  const auto lever = [](const Eigen::Vector3d& arm, const Eigen::Vector3d& force) -> Eigen::Matrix3d {
    return arm.dot(force) * Eigen::Matrix3d::Identity() - arm * force.transpose();
  };
  Eigen::Matrix3d x = Eigen::Matrix3d::Zero();
  const int node = StrainBasis::kPoints * (static_cast<int>(k) / StrainBasis::kIntervals) +
                   static_cast<int>(k) % StrainBasis::kIntervals;
  // Where elements meet, the proximal one's last node lies just before the distal one's first.
  for (int i = std::max(0, node - 1); i <= node && i < StrainBasis::kPoints * mesh.elements(); ++i)
    if (station_of(i) == static_cast<int>(k))
      x += lever(kinematics.tangents[static_cast<std::size_t>(i)],
                 tangent_forces[static_cast<std::size_t>(i)]);
  for (int c = 0; c < 2; ++c) {
    x += lever(r.col(c), director_forces[k].col(c));
    x += inertia[k] * rate2 * (Eigen::Matrix3d::Identity() - r.col(c) * r.col(c).transpose());
  }
  return x;
}

bool RitzRod::Impl::solve(const Differences& d, double load, bool factors_valid) {
  const double shortness = d.dt > 0.0 ? std::min(1.0, d.dt / kUsualStep_s) : 1.0;
  const double tolerance = d.dt > 0.0 ? kStepTolerance * shortness * shortness : kTolerance;
  double last_correction = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < stations && d.dt > 0.0; ++k) {
    const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
    past[k].x = d.apply(zero, last.stations[k].x, before.stations[k].x, oldest.stations[k].x);
    past[k].v = d.apply(zero, last.stations[k].v, before.stations[k].v, oldest.stations[k].v);
  }
  evaluate(d, load);
  for (iterations = 1; iterations <= kMaxIterations; ++iterations) {
    if (!factors_valid) factorise(d);
    correction = factors.solve(residual);
    double size = correction.lpNorm<Eigen::Infinity>();
    if (!(size < 1e6)) return false;  // also refuses NaN
    // Slow convergence: the factors are too old, or the shape turned too far from them.
    factors_valid = size < kFastContraction * last_correction;
    const double scale = size > 1.0 ? 1.0 / size : 1.0;
    now.q -= scale * correction;
    // The next correction would be smaller by as much as this one was than the last.
    const bool small_next =
        !params.kinked && factors_valid && iterations > 1 && size / last_correction * size < tolerance;
    if (size < tolerance || small_next) {
      kinematics.update(mesh, now.q, lengths_m, load);
      if (!section_nodes.empty()) add_sections(d, load);  // what they remember
      add_stretches(d, load);
      return true;
    }
    evaluate(d, load);
    last_correction = size;
  }
  return false;
}

}  // namespace softarm::rig
