// What acts on RitzRod from outside: hoses and walls, moving air, a payload off the axis, the hinge of the
// base.
#include <algorithm>
#include <cmath>

#include "ramp.h"
#include "ritz_rod_impl.h"

namespace softarm::rig {
namespace {

constexpr double kStiffnessWithinPlay = 0.01;   ///< of the base's: what keeps its turn determined
constexpr double kPlayOnset = 0.1;              ///< of the play: over which the clamp grips
constexpr double kStiffnessWithinBush = 0.001;  ///< of the base's

/// The moment with which a clamp grips beyond its play, over its stiffness, with derivative and integral.
Ramp grip_of(double angle, double play, bool bush) {
  Ramp ramp(angle - play, kPlayOnset * play);
  if (!bush) return ramp;
  // Hertz: of the same moment as a spring at a tenth of the play.
  const double beyond = std::max(0.0, angle - play), scale = 1.0 / std::sqrt(kPlayOnset * play);
  ramp.value = scale * std::pow(beyond, 1.5);
  ramp.slope = 1.5 * scale * std::sqrt(beyond);
  ramp.integral = 0.4 * scale * std::pow(beyond, 2.5);
  return ramp;
}

}  // namespace

RitzRod::Impl::BaseSpring RitzRod::Impl::base_spring(const Eigen::Vector3d& turn) const {
  const Eigen::Vector3d linear = base_stiffness();
  BaseSpring spring{linear.cwiseProduct(turn), linear.asDiagonal(),
                    0.5 * turn.dot(linear.cwiseProduct(turn))};
  if (params.base_play_rad <= 0.0) return spring;
  const double k = linear.x();
  const Eigen::Vector3d bending(turn.x(), turn.y(), 0.0);
  const double angle = bending.norm();
  const Ramp ramp = grip_of(angle, params.base_play_rad, params.base_bush);
  const double grip = angle > 0.0 ? k * ramp.value / angle : 0.0;
  const double soft = (params.base_bush ? kStiffnessWithinBush : kStiffnessWithinPlay) * k;
  spring.moment.head<2>() = (soft + grip) * bending.head<2>();
  spring.stiffness.topLeftCorner<2, 2>() = (soft + grip) * Eigen::Matrix2d::Identity();
  if (angle > 0.0)
    spring.stiffness += (k * ramp.slope - grip) / (angle * angle) * bending * bending.transpose();
  spring.energy = 0.5 * soft * angle * angle + k * ramp.integral + 0.5 * linear.z() * turn.z() * turn.z();
  return spring;
}

void RitzRod::Impl::add_loads(const Differences& d, double load) {
  for (Eigen::Matrix3d& stiffness : load_stiffness) stiffness.setZero();
  for (const RodLoad& rod_load : params.loads)
    for_each_loaded(rod_load, [&](std::size_t k, double amount) {
      Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
      if (d.dt > 0.0)
        velocity = d.apply<Eigen::Vector3d>(kinematics.positions[k], last.stations[k].x.col(0),
                                            before.stations[k].x.col(0), oldest.stations[k].x.col(0));
      const PointForce force = rod_load.law->at(kinematics.positions[k], velocity);
      forces[k] += load * amount * force.force_n;
      load_stiffness[k] += load * amount * (force.stiffness_n_per_m + d.rate() * force.damping_n_s_per_m);
    });
  const Eigen::Vector3d& draught = inputs.draught_base_n_per_m;
  for (std::size_t k = 0; k < stations && has_draught(); ++k) {
    const Eigen::Vector3d tangent = kinematics.rotations[k].col(2);
    forces[k] += load * exposed_m[k] * (draught - tangent.dot(draught) * tangent);
  }
  if (!payload_off_axis()) return;
  payload_force = inputs.payload_kg * load * params.gravity_base_m_s2;
  if (d.dt > 0.0) {
    const Eigen::Vector3d v = d.apply<Eigen::Vector3d>(payload_position(), last.payload.col(0),
                                                       before.payload.col(0), oldest.payload.col(0));
    payload_force -=
        inputs.payload_kg *
        d.apply<Eigen::Vector3d>(v, last.payload.col(1), before.payload.col(1), oldest.payload.col(1));
  }
  forces[payload_station()] += payload_force;
}

Eigen::Matrix3d RitzRod::Impl::draught_stiffness(std::size_t k) const {
  const Eigen::Vector3d& draught = inputs.draught_base_n_per_m;
  const Eigen::Vector3d tangent = kinematics.rotations[k].col(2);
  const Eigen::Matrix3d by_tangent =
      tangent.dot(draught) * Eigen::Matrix3d::Identity() + tangent * draught.transpose();
  return -exposed_m[k] * by_tangent * cross_matrix(tangent);
}

void RitzRod::Impl::add_payload_moment() {
  const std::size_t k = payload_station();
  moments[k] += (kinematics.rotations[k] * params.payload_offset_section_m).cross(payload_force);
}

void RitzRod::Impl::factorise_payload(double rate2) {
  const auto k = static_cast<int>(payload_station());
  const Eigen::Vector3d arm =
      kinematics.rotations[static_cast<std::size_t>(k)] * params.payload_offset_section_m;
  const auto turn = kinematics.rotation_jacobian.middleRows<3>(3 * k);
  const Eigen::MatrixXd shift = kinematics.position_jacobian.middleRows<3>(3 * k) - cross_matrix(arm) * turn;
  matrix.noalias() += inputs.payload_kg * rate2 * (shift.transpose() * shift);
  const Eigen::Matrix3d lever =
      arm.dot(payload_force) * Eigen::Matrix3d::Identity() - arm * payload_force.transpose();
  matrix.noalias() += turn.transpose() * (lever * turn);
}

double RitzRod::Impl::load_energy() const {
  double energy = 0.0;
  for (const RodLoad& load : params.loads)
    for_each_loaded(load, [&](std::size_t k, double amount) {
      const Station& s = now.stations[k];
      energy += amount * load.law->at(s.x.col(0), s.v.col(0)).stored_j;
    });
  if (payload_off_axis())
    energy += inputs.payload_kg *
              (0.5 * now.payload.col(1).squaredNorm() - params.gravity_base_m_s2.dot(now.payload.col(0)));
  return energy;
}

}  // namespace softarm::rig
