#include "published_hybrid.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <functional>

#include "published_shooting.h"
#include "published_single_chamber.h"

namespace softarm::published {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// p, R (by columns), u, v.
using HybridState = std::array<double, 18>;

Matrix3d hat(const Vector3d& x) {
  Matrix3d m;
  m << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  return m;
}

Vector3d place(const HybridTendon& tendon) {
  return tendon.offset_m * Vector3d(std::cos(tendon.azimuth_rad), std::sin(tendon.azimuth_rad), 0.0);
}

bool physical(const HybridArm& arm, const HybridLoad& load) {
  bool good = arm.weight_n.allFinite() && load.tip_force_n.allFinite() && std::isfinite(load.pressure_pa) &&
              std::isfinite(arm.chamber_area_m2) && arm.chamber_area_m2 >= 0.0 &&
              load.tension_n.size() == arm.tendons.size();
  for (const double positive : {arm.length_m, arm.bending_stiffness_nm2, arm.torsional_stiffness_nm2,
                                arm.axial_stiffness_n, arm.shear_stiffness_n}) {
    good = good && std::isfinite(positive) && positive > 0.0;
  }
  for (const HybridTendon& tendon : arm.tendons) good = good && place(tendon).allFinite();
  for (const double tension : load.tension_n) good = good && std::isfinite(tension) && tension >= 0.0;
  return good;
}

class Model {
 public:
  Model(const HybridArm& arm, const HybridLoad& load, HybridLaw law)
      : arm_(arm),
        load_(load),
        printed_(law == HybridLaw::kPrinted),
        shear_extension_(arm.shear_stiffness_n, arm.shear_stiffness_n, arm.axial_stiffness_n),
        bending_twist_(arm.bending_stiffness_nm2, arm.bending_stiffness_nm2, arm.torsional_stiffness_nm2),
        gas_n_(load.pressure_pa * arm.chamber_area_m2) {
    for (const HybridTendon& tendon : arm.tendons) places_.push_back(place(tendon));
  }

  /// (3)-(8) with (9), (10) for n and m: the sums of (8) make a linear system for v' and u', positive
  /// definite.
  void rate(double share, const HybridState& x, HybridState& dx) const {
    const Eigen::Map<const Matrix3d> rotation(x.data() + 3);
    const Eigen::Map<const Vector3d> u(x.data() + 12), v(x.data() + 15);
    const Vector3d n = shear_extension_.cwiseProduct(v - Vector3d::UnitZ());
    const Vector3d m = bending_twist_.cwiseProduct(u);
    const Matrix3d turn = hat(u);
    Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
    system.diagonal() << shear_extension_, bending_twist_;
    const double gas = (printed_ ? -1.0 : 1.0) * share * gas_n_;  // (5), (6)
    Vector6d right;
    right << -turn * n - share / arm_.length_m * (rotation.transpose() * arm_.weight_n) + gas * turn.col(2),
        -turn * m - v.cross(n) + gas * v.cross(Vector3d::UnitZ());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (load_.tension_n[i] == 0.0) continue;
      const Vector3d along = u.cross(places_[i]) + v;
      const double norm = along.norm();
      Matrix3d a = -along * along.transpose();  // hat(along)^2 = along along^T - norm^2
      a.diagonal().array() += norm * norm;
      a *= share * load_.tension_n[i] / (norm * norm * norm);
      const Matrix3d offset = hat(places_[i]);
      const Matrix3d g = -a * offset;
      const Vector3d force = a * (turn * along);  // a_i; r_s = r_ss = 0
      right.head<3>() -= force;
      right.tail<3>() -= offset * force;
      system.topLeftCorner<3, 3>() += a;
      system.topRightCorner<3, 3>() += g;
      system.bottomLeftCorner<3, 3>() += g.transpose();
      system.bottomRightCorner<3, 3>() += offset * g;
    }
    const Vector6d slope = system.llt().solve(right);
    Eigen::Map<Vector3d>(dx.data()) = rotation * v;
    Eigen::Map<Matrix3d>(dx.data() + 3) = rotation * turn;
    Eigen::Map<Vector3d>(dx.data() + 12) = slope.tail<3>();
    Eigen::Map<Vector3d>(dx.data() + 15) = slope.head<3>();
  }

  /// (15), (16): what is left of them, section frame, N and N m.
  Vector6d tip_error(double share, const HybridState& tip) const {
    const Eigen::Map<const Matrix3d> rotation(tip.data() + 3);
    const Eigen::Map<const Vector3d> u(tip.data() + 12), v(tip.data() + 15);
    const double gas = share * gas_n_;
    Vector3d force = share * (rotation.transpose() * load_.tip_force_n) + gas * Vector3d::UnitZ();
    Vector3d moment = printed_ ? Vector3d(gas * v.cross(Vector3d::UnitZ())) : Vector3d::Zero();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Vector3d pull = share * load_.tension_n[i] * (u.cross(places_[i]) + v).normalized();
      force -= pull;
      moment -= places_[i].cross(pull);
    }
    Vector6d error;
    error << shear_extension_.cwiseProduct(v - Vector3d::UnitZ()) - force,
        bending_twist_.cwiseProduct(u) - moment;
    return error;
  }

  /// @param unknowns u(0) L and v(0) - v*
  HybridState integrate(double share, const VectorXd& unknowns, int steps,
                        const std::function<void(int, const HybridState&)>& visit) const {
    HybridState state{};
    Eigen::Map<Matrix3d>(state.data() + 3).setIdentity();
    Eigen::Map<Vector3d>(state.data() + 12) = unknowns.head<3>() / arm_.length_m;
    Eigen::Map<Vector3d>(state.data() + 15) = unknowns.tail<3>() + Vector3d::UnitZ();
    boost::numeric::odeint::runge_kutta4<HybridState> stepper;
    const double step = arm_.length_m / steps;
    visit(0, state);
    for (int i = 0; i < steps; ++i) {
      stepper.do_step([&](const HybridState& x, HybridState& dx, double) { rate(share, x, dx); }, state,
                      i * step, step);
      visit(i + 1, state);
    }
    return state;
  }

  bool find_base(int steps, VectorXd& unknowns) const {
    const double moment = arm_.bending_stiffness_nm2 / arm_.length_m;
    Vector6d scale;
    scale << Vector3d::Constant(moment / arm_.length_m), Vector3d::Constant(moment);
    unknowns = VectorXd::Zero(6);
    return follow_root(
        [&](double share, const VectorXd& at) -> VectorXd {
          const HybridState tip = integrate(share, at, steps, [](int, const HybridState&) {});
          return tip_error(share, tip).cwiseQuotient(scale);
        },
        unknowns);
  }

 private:
  HybridArm arm_;
  HybridLoad load_;
  bool printed_;
  Vector3d shear_extension_, bending_twist_;  ///< (11), (12)
  double gas_n_;                              ///< P A^ch
  std::vector<Vector3d> places_;
};

}  // namespace

HybridArm hybrid_paper_arm(double modulus_pa) {
  const Tube section{0.012, 0.003};
  HybridArm arm;
  arm.length_m = 0.085;
  arm.bending_stiffness_nm2 = modulus_pa * section.second_moment_m4();
  arm.torsional_stiffness_nm2 = modulus_pa / 3.0 * 2.0 * section.second_moment_m4();
  arm.axial_stiffness_n = modulus_pa * section.wall_area_m2();
  arm.shear_stiffness_n = modulus_pa / 3.0 * section.wall_area_m2();
  arm.chamber_area_m2 = section.chamber_area_m2();
  for (int i = 0; i < 3; ++i) arm.tendons.push_back({i * 2.0 * kPi / 3.0, 0.004});
  return arm;
}

HybridShape solve_hybrid(const HybridArm& arm, const HybridLoad& load, HybridLaw law,
                         const HybridOptions& options) {
  HybridShape shape;
  if (!physical(arm, load) || options.steps < 4 || options.steps > 100000) return shape;
  const Model model(arm, load, law);
  VectorXd unknowns;
  shape.status = rod::SolveStatus::kNoConvergence;
  if (!model.find_base(options.steps, unknowns)) return shape;
  const int count = options.steps + 1;
  shape.status = rod::SolveStatus::kConverged;
  shape.s_m = VectorXd::LinSpaced(count, 0.0, arm.length_m);
  shape.p_m.resize(3, count);
  shape.u_per_m.resize(3, count);
  shape.v.resize(3, count);
  model.integrate(1.0, unknowns, options.steps, [&](int i, const HybridState& state) {
    shape.p_m.col(i) = Eigen::Map<const Vector3d>(state.data());
    shape.u_per_m.col(i) = Eigen::Map<const Vector3d>(state.data() + 12);
    shape.v.col(i) = Eigen::Map<const Vector3d>(state.data() + 15);
  });
  return shape;
}

rod::Rod linear_rod(const HybridArm& arm, const HybridLoad& load) {
  double sum_n = 0.0, twist_nm2 = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < arm.tendons.size(); ++i) {
    const Vector3d offset = place(arm.tendons[i]);
    sum_n += load.tension_n[i];
    twist_nm2 += load.tension_n[i] * offset.squaredNorm();
    moment -= load.tension_n[i] * offset.cross(Vector3d::UnitZ());
  }
  const double stretch = 1.0 + (load.pressure_pa * arm.chamber_area_m2 - sum_n) / arm.axial_stiffness_n;
  rod::Rod rod;
  rod.gravity_m_s2 = arm.weight_n;
  rod::Segment segment;
  segment.rest_length_m = arm.length_m;
  segment.length_m = arm.length_m * stretch;
  segment.mass_kg = 1.0;
  segment.bending_compliance = 1.0 / (arm.bending_stiffness_nm2 * stretch);
  segment.torsional_compliance = 1.0 / (arm.torsional_stiffness_nm2 * stretch + twist_nm2);
  segment.axial_compliance = 1.0 / (arm.axial_stiffness_n * stretch);
  segment.shear_compliance = 1.0 / (arm.shear_stiffness_n * stretch + sum_n);
  segment.moment_nm = moment;
  rod.segments.push_back(segment);
  rod::PointLoad tip;
  tip.s_m = arm.length_m;
  tip.force_n = load.tip_force_n;
  rod.loads.push_back(tip);
  return rod;
}

}  // namespace softarm::published
