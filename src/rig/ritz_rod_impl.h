// Data and equations of RitzRod: private to the rig.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "backbone_kinematics.h"
#include "softarm/rig/ritz_rod.h"
#include "strain_basis.h"

namespace softarm::rig {

/// v = (a0 x + a1 x_n + a2 x_(n-1)) / dt: BDF2, or backward Euler in the first step after a change of step.
struct Differences {
  double dt = 0.0;  ///< 0: statics, no rates at all
  double a0 = 0.0, a1 = 0.0, a2 = 0.0;

  double rate() const { return dt > 0.0 ? a0 / dt : 0.0; }
  template <typename Derived>
  Derived apply(const Derived& now, const Derived& last, const Derived& before) const {
    return (a0 * now + a1 * last + a2 * before) / dt;
  }
};

/// Position and two section directors of a station, with their rates.
struct Station {
  Eigen::Matrix3d x = Eigen::Matrix3d::Zero();  ///< columns: position (m), d1, d2
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
};

/// Everything that is remembered of an instant.
struct State {
  Eigen::VectorXd q;  ///< coefficients of L u
  Eigen::VectorXd u;  ///< of u, 1/m
  std::vector<Station> stations;
};

struct RitzRod::Impl {
  Impl(const RitzRodParams& rod_params)
      : params(rod_params),
        basis(params.elements),
        kinematics(basis),
        n(3 * basis.functions()),
        stations(static_cast<std::size_t>(basis.stations())),
        forces(stations),
        moments(stations),
        tangent_forces(stations),
        director_forces(stations),
        residual(n),
        matrix(n, n),
        scratch_a(3 * StrainBasis::kIntervals, n),
        factors(n) {
    now.q = now.u = Eigen::VectorXd::Zero(n);
    now.stations.resize(stations);
    kinematics.update(basis, now.q, inputs.length_m);
    remember(Differences{});
    last = before = now;
  }

  double station_mass(std::size_t k) const {
    double mass = params.mass_kg * basis.weights()[k];
    if (k + 1 == stations) mass += params.tip_mass_kg + inputs.payload_kg;
    return mass;
  }
  double station_drag(std::size_t k) const {
    double drag = params.air_damping_n_s_m2 * inputs.length_m * basis.weights()[k];
    if (k + 1 == stations) drag += inputs.tip_damping_n_s_m;
    return drag;
  }
  /// Inertia of each of the directors d1 and d2: that of a disc about a diameter.
  double station_inertia(std::size_t k) const {
    return params.mass_kg * basis.weights()[k] * params.diameter_m * params.diameter_m / 16.0;
  }
  double stiffness(int component) const {
    return component == 2 ? inputs.torsional_stiffness_nm2 : inputs.bending_stiffness_nm2;
  }

  Eigen::Matrix3d station_x(std::size_t k) const {
    Eigen::Matrix3d x;
    x << kinematics.positions[k], kinematics.rotations[k].leftCols<2>();
    return x;
  }

  /// Fills `now` from the kinematics and the two instants before.
  void remember(const Differences& d) {
    now.u = now.q / inputs.length_m;
    for (std::size_t k = 0; k < stations; ++k) {
      Station& s = now.stations[k];
      s.x = station_x(k);
      if (d.dt > 0.0)
        s.v = d.apply(s.x, last.stations[k].x, before.stations[k].x);
      else
        s.v.setZero();
    }
  }

  /// Residual of the equations of motion for now.q. @param load scale of gravity, actuation and tip force
  void evaluate(const Differences& d, double load);

  /// Adjoint of the position quadrature: forces at stations to forces on unit tangents, to moments on
  /// rotations.
  void gather_moments();

  /// Derivative of the residual, with the geometric stiffness of all forces; the second derivative of a
  /// rotation within one interval is taken at its middle, an error of higher order that only slows Newton's
  /// method a little.
  void factorise(const Differences& d);

  /// What a rotation of station k changes in minus the moment on it.
  Eigen::Matrix3d moment_stiffness(std::size_t k, double rate2) const;

  /// Newton's method on now.q from where it stands. The factors are kept as long as they serve.
  bool solve(const Differences& d, double load, bool factors_valid);

  RitzRodParams params;
  StrainBasis basis;
  BackboneKinematics kinematics;
  int n;
  std::size_t stations;
  RitzRodInputs inputs;
  State now, last, before;
  double step_s = 0.0;  ///< of the last step; 0 after settle()
  bool have_factors = false;
  int iterations = 0;

  BackboneKinematics::Vectors forces, moments, tangent_forces;
  std::vector<Eigen::Matrix<double, 3, 2>> director_forces;
  Eigen::VectorXd residual, correction, strain_work;
  Eigen::MatrixXd matrix, scratch_a;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors;
};

}  // namespace softarm::rig
