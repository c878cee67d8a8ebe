// An independent reference for rods in series: a chain of short straight links.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace softarm::rig {

/// Part of a chain. Stiffnesses 0 in shear or stretch: rigid.
struct ChainPart {
  int links = 1000;
  double length_m = 0.1, mass_kg = 0.1;
  double bending_stiffness_nm2 = 0.03, torsional_stiffness_nm2 = 0.03;
  double shear_stiffness_n = 0.0, axial_stiffness_n = 0.0;
  Eigen::Vector3d moment_section_nm = Eigen::Vector3d::Zero();
  double payload_kg = 0.0;  ///< at its end
};

/// Statics of a clamped chain by damped Picard iteration: shape -> moments of the weights beyond each joint
/// -> turns of the joints -> shape. No splines, no Newton's method, no code of the rig.
struct Chain {
  std::vector<ChainPart> parts;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  double base_stiffness_nm_per_rad = std::numeric_limits<double>::infinity();

  /// Results: positions of the joints from the base on, orientations of the links, moment at the base.
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Matrix3d> orientations;
  Eigen::Vector3d base_moment_nm = Eigen::Vector3d::Zero();

  /// @return whether it converged
  bool solve() {
    struct Link {
      const ChainPart* part;
      double h, mass, payload;
    };
    std::vector<Link> links;
    for (const ChainPart& part : parts)
      for (int i = 0; i < part.links; ++i)
        links.push_back({&part, part.length_m / part.links, part.mass_kg / part.links,
                         i + 1 == part.links ? part.payload_kg : 0.0});
    const std::size_t n = links.size();
    // Curvature of each link; between links' middles the frame turns by the mean of two halves.
    std::vector<Eigen::Vector3d> u(n, Eigen::Vector3d::Zero());
    Eigen::Vector3d base_turn = Eigen::Vector3d::Zero();
    for (int iteration = 0; iteration < 3000; ++iteration) {
      positions.assign(1, Eigen::Vector3d::Zero());
      orientations.clear();
      std::vector<Eigen::Vector3d> forces(n);  // at the links' middles
      Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
      for (std::size_t i = n; i-- > 0;) {
        beyond += (links[i].payload + 0.5 * links[i].mass) * gravity;
        forces[i] = beyond;
        beyond += 0.5 * links[i].mass * gravity;
      }
      Eigen::Matrix3d r = turn(base_turn);
      for (std::size_t i = 0; i < n; ++i) {
        const Link& link = links[i];
        const Eigen::Matrix3d half = turn(0.5 * link.h * u[i]);
        const Eigen::Matrix3d middle = r * half;
        orientations.push_back(middle);
        const Eigen::Vector3d force = middle.transpose() * forces[i];
        Eigen::Vector3d strain = Eigen::Vector3d::UnitZ();
        if (link.part->shear_stiffness_n > 0.0)
          strain.head<2>() += force.head<2>() / link.part->shear_stiffness_n;
        if (link.part->axial_stiffness_n > 0.0) strain.z() += force.z() / link.part->axial_stiffness_n;
        positions.push_back(positions.back() + link.h * (middle * strain));
        r = middle * half;
      }
      // Moments of the weights beyond, about the links' middles.
      double change = 0.0;
      Eigen::Vector3d moment = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();
      for (std::size_t i = n; i-- > 0;) {
        const Link& link = links[i];
        const Eigen::Vector3d edge = 0.5 * (positions[i + 1] - positions[i]);
        // From the link's end to its middle, then on to its start; each half's weight sits in the half's
        // middle.
        const Eigen::Vector3d half_weight = 0.5 * link.mass * gravity;
        force += link.payload * gravity;
        moment += edge.cross(force) + 0.5 * edge.cross(half_weight);
        force += half_weight;
        const Eigen::Vector3d inside = orientations[i].transpose() * moment + link.part->moment_section_nm;
        const Eigen::Vector3d target(inside.x() / link.part->bending_stiffness_nm2,
                                     inside.y() / link.part->bending_stiffness_nm2,
                                     inside.z() / link.part->torsional_stiffness_nm2);
        change = std::max(change, (target - u[i]).cwiseAbs().maxCoeff());
        u[i] += 0.3 * (target - u[i]);
        moment += edge.cross(force) + 0.5 * edge.cross(half_weight);
        force += half_weight;
      }
      base_moment_nm = moment;
      // The spring's potential is K |turn|^2 / 2, so K turn is the moment seen by changes of the rotation
      // vector: the transposed left Jacobian of SO(3) times the moment.
      const double angle = std::max(1e-6, base_turn.norm()), square = angle * angle;
      const Eigen::Vector3d once = base_turn.cross(moment);
      const Eigen::Vector3d conjugate = moment - (1.0 - std::cos(angle)) / square * once +
                                        (angle - std::sin(angle)) / (square * angle) * base_turn.cross(once);
      const Eigen::Vector3d target(conjugate.x() / base_stiffness_nm_per_rad,
                                   conjugate.y() / base_stiffness_nm_per_rad, 0.0);
      change = std::max(change, (target - base_turn).cwiseAbs().maxCoeff());
      base_turn += 0.3 * (target - base_turn);
      if (change < 1e-10) return true;
    }
    return false;
  }

 private:
  static Eigen::Matrix3d turn(const Eigen::Vector3d& rotation_vector) {
    const double angle = rotation_vector.norm();
    if (angle == 0.0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
  }
};

}  // namespace softarm::rig
