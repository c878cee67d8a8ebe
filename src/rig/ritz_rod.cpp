#include "ritz_rod.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ritz_rod_impl.h"

namespace softarm::rig {
namespace {

std::vector<RodMesh::Division> divisions(const RitzRodParams& params) {
  std::vector<RodMesh::Division> result;
  for (const RodPiece& piece : params.pieces) result.push_back({piece.elements, piece.share});
  return result;
}

}  // namespace

RitzRod::Impl::Impl(const RitzRodParams& rod_params)
    : params(rod_params),
      mesh(divisions(rod_params), rod_params.base_stiffness_nm_per_rad ? 1 : 0),
      kinematics(mesh, rod_params.base_attitude),
      n(3 * mesh.functions()),
      stations(static_cast<std::size_t>(mesh.stations())),
      lengths_m(params.pieces.size()),
      mass(stations),
      drag(stations),
      inertia(stations),
      arclength_m(stations),
      exposed_m(stations),
      past(stations),
      forces(stations),
      moments(stations),
      tangent_forces(static_cast<std::size_t>(StrainBasis::kPoints * mesh.elements())),
      director_forces(stations),
      residual(n),
      matrix(n, n),
      scratch_a(3 * StrainBasis::kIntervals, n),
      factors(n) {
  if (params.payload_piece && *params.payload_piece >= params.pieces.size())
    throw std::invalid_argument("the payload must hang at the end of a piece");
  for (const RodLoad& load : params.loads)
    if (load.piece && *load.piece >= params.pieces.size())
      throw std::invalid_argument("a load must act on the end of a piece");
  make_section_nodes();
  make_stretches();
  load_stiffness.assign(params.loads.empty() ? 0 : stations, Eigen::Matrix3d::Zero());
  RitzRodInputs start;
  start.pieces.resize(params.pieces.size());
  set_inputs(start);
  now.q = now.u = Eigen::VectorXd::Zero(n);
  now.stations.resize(stations);
  now.memory = virgin_memory;
  now.stretch_memory = rested_memory;
  now.core_stiffness_nm2.assign(lengths_m.size(), 0.0);
  kinematics.update(mesh, now.q, lengths_m, 1.0);
  remember(Differences{});
  last = before = oldest = now;
}

void RitzRod::Impl::set_inputs(const RitzRodInputs& to) {
  if (to.pieces.size() != params.pieces.size())
    throw std::invalid_argument("inputs for another number of pieces than the rod has");
  inputs = to;
  std::fill(mass.begin(), mass.end(), 0.0);
  std::fill(drag.begin(), drag.end(), 0.0);
  std::fill(inertia.begin(), inertia.end(), 0.0);
  std::fill(arclength_m.begin(), arclength_m.end(), 0.0);
  std::fill(exposed_m.begin(), exposed_m.end(), 0.0);
  for (std::size_t j = 0; j < params.pieces.size(); ++j) {
    const RodMesh::Piece& piece = mesh.pieces()[j];
    const double diameter_m = params.pieces[j].diameter_m;
    lengths_m[j] = inputs.pieces[j].length_m;
    for (std::size_t i = 0; i < piece.basis.weights().size(); ++i) {
      const std::size_t k = static_cast<std::size_t>(piece.first_station()) + i;
      double station_mass = params.pieces[j].mass_kg * piece.basis.weights()[i];
      if (params.pieces[j].mass_slope != 0.0)
        station_mass *= 1.0 + params.pieces[j].mass_slope * (2.0 * piece.basis.fraction_of(i) - 1.0);
      mass[k] += station_mass;
      const double along_m = lengths_m[j] * piece.basis.weights()[i];
      arclength_m[k] += along_m;
      exposed_m[k] +=
          params.draught_grows ? along_m * (piece.begin + piece.share * piece.basis.fraction_of(i)) : along_m;
      drag[k] += params.air_damping_n_s_m2 * along_m;
      inertia[k] += station_mass * diameter_m * diameter_m / 16.0;
    }
  }
  for (std::size_t j = 0; j < params.pieces.size(); ++j)
    mass[static_cast<std::size_t>(mesh.pieces()[j].last_station())] += params.pieces[j].end_mass_kg;
  mass.back() += params.tip_mass_kg;
  const std::size_t payload_piece = params.payload_piece.value_or(params.pieces.size() - 1);
  const std::size_t at = payload_station();
  if (!payload_off_axis()) mass[at] += inputs.payload_kg;
  drag[at] += inputs.hand_damping_n_s_m;

  // The weights beyond each node.
  double beyond_kg = params.tip_mass_kg;
  for (std::size_t j = params.pieces.size(); j-- > 0;) {
    const PieceInputs& p = inputs.pieces[j];
    const double shear = p.shear_stiffness_n ? 1.0 / *p.shear_stiffness_n : 0.0;
    kinematics.compliances[j] = {shear, shear, p.axial_stiffness_n ? 1.0 / *p.axial_stiffness_n : 0.0};
    const RodMesh::Piece& piece = mesh.pieces()[j];
    if (j == payload_piece) beyond_kg += inputs.payload_kg;
    beyond_kg += params.pieces[j].end_mass_kg;
    for (int e = 0; e < piece.basis.elements(); ++e)
      for (int i = 0; i < StrainBasis::kPoints; ++i) {
        const double fraction = (e + mesh.points()[static_cast<std::size_t>(i)]) / piece.basis.elements();
        const int node = StrainBasis::kPoints * (piece.first_element + e) + i;
        const double share = 1.0 - fraction + params.pieces[j].mass_slope * fraction * (1.0 - fraction);
        kinematics.node_forces[static_cast<std::size_t>(node)] =
            (beyond_kg + share * params.pieces[j].mass_kg) * params.gravity_base_m_s2 +
            inputs.tip_force_base_n;
      }
    beyond_kg += params.pieces[j].mass_kg;
  }
}

int RitzRod::Impl::highest_order(double dt_s) const {
  if (params.kinked) return 2;
  const auto damped = [dt_s](const RodPiece& piece) { return piece.retardation_s >= dt_s; };
  return std::all_of(params.pieces.begin(), params.pieces.end(), damped) ? 3 : 2;
}

void RitzRod::Impl::extrapolate(int even) {
  if (even >= 2)
    now.q = 3.0 * (last.q - before.q) + oldest.q;
  else if (even == 1)
    now.q = 2.0 * last.q - before.q;
}

void RitzRod::Impl::remember(const Differences& d) {
  now.u = now.q;
  for (std::size_t j = 0; j < lengths_m.size(); ++j)
    for (int c = 0; c < 3; ++c) coefficients_of(j, c).of(now.u) /= lengths_m[j];
  for (std::size_t k = 0; k < stations; ++k) {
    Station& s = now.stations[k];
    s.x = station_x(k);
    if (d.dt > 0.0)
      s.v = d.apply(s.x, last.stations[k].x, before.stations[k].x, oldest.stations[k].x);
    else
      s.v.setZero();
  }
  for (std::size_t j = 0; j < lengths_m.size(); ++j)
    now.core_stiffness_nm2[j] = inputs.pieces[j].core_stiffness_nm2;
  if (payload_off_axis()) {
    now.payload.col(0) = payload_position();
    now.payload.col(1).setZero();
    if (d.dt > 0.0)
      now.payload.col(1) = d.apply<Eigen::Vector3d>(now.payload.col(0), last.payload.col(0),
                                                    before.payload.col(0), oldest.payload.col(0));
  }
}

bool RitzRod::Impl::increase_load() {
  now.q.setZero();
  double load = 0.0, increment = 0.125;
  while (load < 1.0) {
    const Eigen::VectorXd start = now.q;
    const double target = std::min(1.0, load + increment);
    if (solve(Differences{}, target, false)) {
      load = target;
      increment *= 1.5;
    } else {
      now.q = start;
      increment *= 0.5;
      if (increment < 1e-4) return false;
    }
  }
  return true;
}

RitzRod::RitzRod(const RitzRodParams& params) : impl_(std::make_unique<Impl>(params)) {}
RitzRod::~RitzRod() = default;
RitzRod::RitzRod(RitzRod&&) noexcept = default;
RitzRod& RitzRod::operator=(RitzRod&&) noexcept = default;

bool RitzRod::settle(const RitzRodInputs& inputs) {
  Impl& m = *impl_;
  const State saved = m.now;
  const RitzRodInputs saved_inputs = m.inputs;
  m.set_inputs(inputs);
  m.have_factors = false;
  std::fill(m.rested_memory.begin(), m.rested_memory.end(), 0.0);
  bool found = false;
  do {
    found = m.increase_load();
  } while (found && m.keep_stretches());
  if (!found) {
    m.now = saved;
    m.set_inputs(saved_inputs);
    m.kinematics.update(m.mesh, m.now.q, m.lengths_m, 1.0);
    return false;
  }
  m.remember(Differences{});
  m.last = m.before = m.oldest = m.now;
  m.step_s = 0.0;
  m.even_steps = kMostEvenSteps;
  return true;
}

bool RitzRod::step(const RitzRodInputs& inputs, double dt_s) {
  Impl& m = *impl_;
  const RitzRodInputs saved_inputs = m.inputs;
  const bool at_rest = m.step_s == 0.0, same_step = at_rest || std::abs(dt_s - m.step_s) < 1e-12;
  // A hand that takes hold is a jump of the accelerations: no differences across it.
  const bool jump = inputs.hand_damping_n_s_m > 0.0 && saved_inputs.hand_damping_n_s_m == 0.0;
  const int even_steps = same_step && !jump ? m.even_steps : 0;
  int order = std::min(even_steps + 1, m.highest_order(dt_s));
  Differences d = Differences::of_order(order, dt_s);
  State older = std::move(m.oldest);
  m.oldest = std::move(m.before);
  m.before = std::move(m.last);
  m.last = m.now;
  m.set_inputs(inputs);
  if (!at_rest) m.extrapolate(even_steps);
  bool ok = m.solve(d, 1.0, m.have_factors && m.factors_rate == d.rate());
  // The extrapolation may have been wild; lower orders come over a blow at a wall more easily.
  for (; !ok && order > 0; --order) {
    d = Differences::of_order(order, dt_s);
    m.now.q = m.last.q;
    ok = m.solve(d, 1.0, false);
  }
  if (!ok) {
    m.now = std::move(m.last);
    m.last = std::move(m.before);
    m.before = std::move(m.oldest);
    m.oldest = std::move(older);
    m.set_inputs(saved_inputs);
    m.kinematics.update(m.mesh, m.now.q, m.lengths_m, 1.0);
    m.have_factors = false;
    return false;
  }
  m.have_factors = true;
  m.factors_rate = d.rate();
  m.even_steps = std::min(even_steps + 1, kMostEvenSteps);
  m.step_s = dt_s;
  m.remember(d);
  return true;
}

Eigen::Isometry3d RitzRod::pose(double fraction) const {
  const Impl& m = *impl_;
  const RodPlace place = m.mesh.locate(fraction);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = m.kinematics.rotation_at(m.mesh, m.now.q, place);
  pose.translation() = m.kinematics.position_at(m.mesh, m.lengths_m, place);
  return pose;
}

Eigen::Vector3d RitzRod::velocity(double fraction) const {
  const Impl& m = *impl_;
  const RodPlace place = m.mesh.locate(fraction);
  const auto weights = m.mesh.piece_of(place.element).basis.lagrange(m.mesh.within_element(place));
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  for (int j = 0; j < StrainBasis::kPoints; ++j) {
    const int k = place.element * StrainBasis::kIntervals + j;
    v += weights(j) * m.now.stations[static_cast<std::size_t>(k)].v.col(0);
  }
  return v;
}

Eigen::Vector3d RitzRod::curvature(double fraction) const {
  const Impl& m = *impl_;
  const RodPlace place = m.mesh.locate(fraction);
  const LocalBasis b = m.mesh.evaluate(place);
  const int first = m.mesh.element(place.element).first_function;
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) u += b[static_cast<std::size_t>(i)] * m.now.u.segment<3>(3 * (first + i));
  return u;
}

Eigen::Vector3d RitzRod::base_rotation() const {
  if (!impl_->base_yields()) return Eigen::Vector3d::Zero();
  return impl_->now.q.head<3>();
}

double RitzRod::energy_j() const {
  const Impl& m = *impl_;
  double energy = -m.inputs.tip_force_base_n.dot(m.now.stations.back().x.col(0));
  for (std::size_t k = 0; k < m.stations; ++k) {
    const Station& s = m.now.stations[k];
    energy += m.mass[k] * (0.5 * s.v.col(0).squaredNorm() - m.params.gravity_base_m_s2.dot(s.x.col(0)));
    energy += 0.5 * m.inertia[k] * s.v.rightCols<2>().squaredNorm();
  }
  for (std::size_t j = 0; j < m.lengths_m.size(); ++j) {
    if (!m.is_plain(j)) continue;
    const StrainBasis& basis = m.mesh.pieces()[j].basis;
    for (int c = 0; c < 3; ++c) {
      const Eigen::VectorXd u = m.coefficients_of(j, c).of(m.now.u);
      energy += 0.5 * m.stiffness(j, c) * m.lengths_m[j] * u.dot(basis.gram() * u);
      energy -= m.inputs.pieces[j].moment_section_nm(c) * m.lengths_m[j] * u.dot(basis.integral());
    }
  }
  for (int e = 0; e < m.mesh.elements(); ++e)  // of shear and stretch
    for (std::size_t i = 0; i < StrainBasis::kPoints; ++i) {
      const std::size_t node = static_cast<std::size_t>(StrainBasis::kPoints * e) + i;
      const std::size_t k = static_cast<std::size_t>(StrainBasis::kIntervals * e) + i;
      const auto piece = static_cast<std::size_t>(m.mesh.element(e).piece);
      const double weight = m.lengths_m[piece] * m.mesh.element(e).size *
                            m.mesh.integration()(StrainBasis::kIntervals, static_cast<int>(i));
      energy +=
          0.5 * weight *
          m.kinematics.node_forces[node].dot(m.kinematics.tangents[node] - m.kinematics.rotations[k].col(2));
    }
  if (m.base_yields()) energy += m.base_spring(m.now.q.head<3>()).energy;
  return energy + m.section_energy() + m.stretch_energy() + m.load_energy();
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
