#include "published_single_chamber.h"

#include <Eigen/Geometry>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <functional>

#include "published_shooting.h"

namespace softarm::published {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// p, R (by columns), n, m.
using ChamberState = std::array<double, 18>;

bool physical(const SingleChamberArm& arm) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  return positive(arm.length_m) && positive(arm.section.outer_diameter_m) &&
         arm.section.inner_diameter_m >= 0.0 && arm.section.inner_diameter_m < arm.section.outer_diameter_m &&
         std::isfinite(arm.density_kg_m3) && arm.density_kg_m3 >= 0.0 && arm.gravity_m_s2.allFinite() &&
         (!arm.modulus_pa || positive(*arm.modulus_pa));
}

/// The right-hand side of the slides and its conditions at both ends.
class ChamberModel {
 public:
  ChamberModel(const SingleChamberArm& arm, const SingleChamberLoad& load, const PressurisedArm& at_pressure,
               ChamberLaw law)
      : length_(arm.length_m), force_(load.tip_force_n) {
    const double area = arm.section.wall_area_m2();
    const double shear_modulus = at_pressure.modulus_pa / 3.0;  // incompressible
    const double twist = 2.0 * shear_modulus * arm.section.second_moment_m4();
    rest_stretch_ = law == ChamberLaw::kPrinted ? 1.0 : at_pressure.stretch;
    pull_n_m_ = law == ChamberLaw::kPrinted ? load.pressure_pa * area : 0.0;
    weight_n_m_ = arm.density_kg_m3 * area * arm.gravity_m_s2;
    extension_compliance_ =
        Vector3d(shear_modulus, shear_modulus, at_pressure.modulus_pa).cwiseInverse() / area;
    // Per s; statics has E_o I per stretched length, the slides per s with v* = 1.
    bending_compliance_ =
        rest_stretch_ *
        Vector3d(at_pressure.bending_stiffness_nm2, at_pressure.bending_stiffness_nm2, twist).cwiseInverse();
  }

  /// n(0) and m(0) of the undeformed arm.
  Eigen::Matrix<double, 6, 1> undeformed_base() const {
    const double length = rest_stretch_ * length_;
    Eigen::Matrix<double, 6, 1> base;
    base << force_ + length_ * (weight_n_m_ + pull_n_m_ * Vector3d::UnitZ()),
        length * Vector3d::UnitZ().cross(force_ + 0.5 * length_ * weight_n_m_);
    return base;
  }

  /// @param visit (step, state) at every node
  ChamberState integrate(const Eigen::Matrix<double, 6, 1>& base, double share, int steps,
                         const std::function<void(int, const ChamberState&)>& visit) const {
    ChamberState state{};
    Eigen::Map<Matrix3d>(state.data() + 3).setIdentity();
    Eigen::Map<Eigen::Matrix<double, 6, 1>>(state.data() + 12) = base;
    boost::numeric::odeint::runge_kutta4<ChamberState> stepper;
    const double step = length_ / steps;
    visit(0, state);
    for (int i = 0; i < steps; ++i) {
      stepper.do_step([&](const ChamberState& x, ChamberState& dx, double) { rate(share, x, dx); }, state,
                      i * step, step);
      visit(i + 1, state);
    }
    return state;
  }

  Vector3d force_error(const ChamberState& tip, double share = 1.0) const {
    return Eigen::Map<const Vector3d>(tip.data() + 12) - share * force_;
  }
  Vector3d moment_error(const ChamberState& tip) const { return Eigen::Map<const Vector3d>(tip.data() + 15); }

  /// Shoots for n(L) = F, m(L) = 0, scaled by the forces and moments that bend the arm by about a radian.
  bool find_base(int steps, Eigen::Matrix<double, 6, 1>& base) const {
    const double moment = 1.0 / (bending_compliance_[0] * length_);
    Eigen::Matrix<double, 6, 1> scale;
    scale << Vector3d::Constant(moment / length_), Vector3d::Constant(moment);
    VectorXd x = VectorXd::Zero(6);
    const bool found = follow_root(
        [&](double share, const VectorXd& at) -> VectorXd {
          const ChamberState tip =
              integrate(at.cwiseProduct(scale), share, steps, [](int, const ChamberState&) {});
          Eigen::Matrix<double, 6, 1> error;
          error << force_error(tip, share), moment_error(tip);
          return error.cwiseQuotient(scale);
        },
        x);
    base = x.cwiseProduct(scale);
    return found;
  }

 private:
  void rate(double share, const ChamberState& x, ChamberState& dx) const {
    const Eigen::Map<const Matrix3d> rotation(x.data() + 3);
    const Eigen::Map<const Vector3d> n(x.data() + 12), m(x.data() + 15);
    const Vector3d v =
        Vector3d(0.0, 0.0, rest_stretch_) + extension_compliance_.cwiseProduct(rotation.transpose() * n);
    const Vector3d u = bending_compliance_.cwiseProduct(rotation.transpose() * m);
    Matrix3d hat;
    hat << 0.0, -u[2], u[1], u[2], 0.0, -u[0], -u[1], u[0], 0.0;
    const Vector3d dp = rotation * v;
    Eigen::Map<Vector3d>(dx.data()) = dp;
    Eigen::Map<Matrix3d>(dx.data() + 3) = rotation * hat;
    Eigen::Map<Vector3d>(dx.data() + 12) = -share * (weight_n_m_ + pull_n_m_ * rotation.col(2));
    Eigen::Map<Vector3d>(dx.data() + 15) = -dp.cross(n);
  }

  double length_;
  Vector3d force_;
  double rest_stretch_ = 1.0;
  double pull_n_m_ = 0.0;
  Vector3d weight_n_m_;
  Vector3d extension_compliance_, bending_compliance_;  ///< section frame, z along the axis
};

/// The production model's rod: lengths, moduli and weight of the pressurised arm. A force stretches the wall
/// from there by E_o A per s, which is E_o A stretch per stretched length.
rod::Rod statics_rod(const SingleChamberArm& arm, const SingleChamberLoad& load,
                     const PressurisedArm& at_pressure) {
  const double area = arm.section.wall_area_m2();
  rod::Rod rod;
  rod.gravity_m_s2 = arm.gravity_m_s2;
  rod::Segment segment;
  segment.rest_length_m = arm.length_m;
  segment.length_m = arm.length_m * at_pressure.stretch;
  segment.mass_kg = arm.density_kg_m3 * area * arm.length_m;
  segment.bending_compliance = 1.0 / at_pressure.bending_stiffness_nm2;
  segment.torsional_compliance = 1.5 * segment.bending_compliance;  // 2 G I, G = E / 3
  segment.axial_compliance = 1.0 / (at_pressure.modulus_pa * area * at_pressure.stretch);
  segment.shear_compliance = 3.0 * segment.axial_compliance;
  rod.segments.push_back(segment);
  rod::PointLoad tip;
  tip.s_m = arm.length_m;
  tip.force_n = load.tip_force_n;
  rod.loads.push_back(tip);
  return rod;
}

VectorXd nodes(double length, int steps) {
  return VectorXd::LinSpaced(steps + 1, 0.0, length);
}

SingleChamberShape solve_statics(const SingleChamberArm& arm, const SingleChamberLoad& load,
                                 const PressurisedArm& at_pressure, int steps) {
  SingleChamberShape shape;
  const rod::Rod rod = statics_rod(arm, load, at_pressure);
  rod::Solver solver(rod, {arm.length_m}, {});
  shape.status = solver.solve(rod);
  if (shape.status != rod::SolveStatus::kConverged) return shape;
  shape.s_m = nodes(arm.length_m, steps);
  shape.p_m.resize(3, steps + 1);
  for (int i = 0; i <= steps; ++i) shape.p_m.col(i) = solver.at(shape.s_m[i]).p;
  return shape;
}

/// d tip / d force along the direction.
std::optional<Vector3d> tip_compliance(const SingleChamberArm& arm, const SingleChamberLoad& load,
                                       const Vector3d& along, ChamberLaw law, ChamberSolution solution,
                                       const ChamberOptions& options) {
  const std::optional<PressurisedArm> at_pressure = pressurise(arm, load.pressure_pa);
  if (!at_pressure) return std::nullopt;
  if (law == ChamberLaw::kStatics && solution == ChamberSolution::kBoundaryValue) {
    const rod::Rod rod = statics_rod(arm, load, *at_pressure);
    rod::Solver solver(rod, {arm.length_m},
                       {{rod::ParameterKind::kLoadForce, 0, 0},
                        {rod::ParameterKind::kLoadForce, 0, 1},
                        {rod::ParameterKind::kLoadForce, 0, 2}});
    if (solver.solve(rod) != rod::SolveStatus::kConverged) return std::nullopt;
    return Vector3d(solver.dp(0) * along);
  }
  // 1e-4 of the force that bends the arm by about a radian: the error is of the order of its square.
  const double step = 1e-4 * at_pressure->bending_stiffness_nm2 / (arm.length_m * arm.length_m);
  SingleChamberLoad more = load, less = load;
  more.tip_force_n += step * along;
  less.tip_force_n -= step * along;
  const SingleChamberShape above = solve_single_chamber(arm, more, law, solution, options);
  const SingleChamberShape below = solve_single_chamber(arm, less, law, solution, options);
  if (above.status != rod::SolveStatus::kConverged || below.status != rod::SolveStatus::kConverged)
    return std::nullopt;
  return Vector3d((above.p_m.rightCols<1>() - below.p_m.rightCols<1>()) / (2.0 * step));
}

}  // namespace

double Tube::chamber_area_m2() const {
  return 0.25 * kPi * inner_diameter_m * inner_diameter_m;
}

double Tube::wall_area_m2() const {
  return 0.25 * kPi * outer_diameter_m * outer_diameter_m - chamber_area_m2();
}

double Tube::second_moment_m4() const {
  return kPi / 64.0 * (std::pow(outer_diameter_m, 4) - std::pow(inner_diameter_m, 4));
}

SingleChamberArm slides_arm() {
  SingleChamberArm arm;
  arm.section = {0.012, 0.0035};
  arm.length_m = 0.085;
  arm.material = {277e3, -209e3};
  arm.density_kg_m3 = 1040.0;
  return arm;
}

std::optional<PressurisedArm> pressurise(const SingleChamberArm& arm, double pressure_pa) {
  if (!physical(arm) || !std::isfinite(pressure_pa)) return std::nullopt;
  const double stress = pressure_pa * arm.section.chamber_area_m2() / arm.section.wall_area_m2();
  PressurisedArm at_pressure;
  if (arm.modulus_pa) {
    at_pressure.stretch = 1.0 + stress / *arm.modulus_pa;
    at_pressure.modulus_pa = *arm.modulus_pa;
  } else {
    const std::optional<double> stretch = arm.material.stretch_at(stress);
    if (!stretch) return std::nullopt;
    at_pressure.stretch = *stretch;
    at_pressure.modulus_pa = arm.material.tangent_modulus_pa(*stretch);
  }
  at_pressure.bending_stiffness_nm2 = at_pressure.modulus_pa * arm.section.second_moment_m4();
  if (!(at_pressure.stretch > 0.0) || !(at_pressure.bending_stiffness_nm2 > 0.0)) return std::nullopt;
  return at_pressure;
}

SingleChamberShape solve_single_chamber(const SingleChamberArm& arm, const SingleChamberLoad& load,
                                        ChamberLaw law, ChamberSolution solution,
                                        const ChamberOptions& options) {
  SingleChamberShape shape;
  if (!load.tip_force_n.allFinite() || options.steps < 4 || options.steps > 100000) return shape;
  const std::optional<PressurisedArm> at_pressure = pressurise(arm, load.pressure_pa);
  if (!at_pressure) return shape;
  if (law == ChamberLaw::kStatics && solution == ChamberSolution::kBoundaryValue) {
    return solve_statics(arm, load, *at_pressure, options.steps);
  }
  const ChamberModel model(arm, load, *at_pressure, law);
  shape.status = rod::SolveStatus::kNoConvergence;
  Eigen::Matrix<double, 6, 1> base = model.undeformed_base();
  if (solution == ChamberSolution::kBoundaryValue && !model.find_base(options.steps, base)) return shape;
  Matrix3Xd points(3, options.steps + 1);
  const ChamberState tip = model.integrate(base, 1.0, options.steps, [&](int i, const ChamberState& state) {
    points.col(i) = Eigen::Map<const Vector3d>(state.data());
  });
  if (!points.allFinite()) return shape;
  shape.status = rod::SolveStatus::kConverged;
  shape.s_m = nodes(arm.length_m, options.steps);
  shape.p_m = points;
  shape.tip_force_error_n = model.force_error(tip);
  shape.tip_moment_error_nm = model.moment_error(tip);
  return shape;
}

std::optional<TipStiffness> tip_stiffness(const SingleChamberArm& arm, const Vector3d& direction,
                                          double force_n, double pressure_pa, ChamberLaw law,
                                          ChamberSolution solution, const ChamberOptions& options) {
  if (!direction.allFinite() || !(direction.norm() > 0.0) || !std::isfinite(force_n) || force_n < 0.0) {
    return std::nullopt;
  }
  const Vector3d along = direction.normalized();
  const SingleChamberLoad none{Vector3d::Zero(), pressure_pa};
  const SingleChamberLoad load{force_n * along, pressure_pa};
  const SingleChamberShape before = solve_single_chamber(arm, none, law, solution, options);
  const SingleChamberShape after = solve_single_chamber(arm, load, law, solution, options);
  const std::optional<Vector3d> compliance = tip_compliance(arm, load, along, law, solution, options);
  if (before.status != rod::SolveStatus::kConverged || after.status != rod::SolveStatus::kConverged ||
      !compliance) {
    return std::nullopt;
  }
  TipStiffness stiffness;
  stiffness.displacement_m = after.p_m.rightCols<1>() - before.p_m.rightCols<1>();
  const double moved = stiffness.displacement_m.norm();
  if (force_n > 0.0 && !(moved > 0.0)) return std::nullopt;
  const double per_force =
      force_n > 0.0 ? compliance->dot(stiffness.displacement_m) / moved : compliance->norm();
  if (!std::isfinite(1.0 / per_force)) return std::nullopt;
  stiffness.tangent_n_m = 1.0 / per_force;
  stiffness.secant_n_m = force_n > 0.0 ? force_n / moved : stiffness.tangent_n_m;
  return stiffness;
}

std::vector<std::vector<std::optional<TipStiffness>>> stiffness_surface(
    const SingleChamberArm& arm, const Vector3d& direction, const std::vector<double>& forces_n,
    const std::vector<double>& pressures_pa, ChamberLaw law, ChamberSolution solution,
    const ChamberOptions& options) {
  std::vector<std::vector<std::optional<TipStiffness>>> surface;
  for (const double pressure : pressures_pa) {
    std::vector<std::optional<TipStiffness>>& row = surface.emplace_back();
    for (const double force : forces_n) {
      row.push_back(tip_stiffness(arm, direction, force, pressure, law, solution, options));
    }
  }
  return surface;
}

}  // namespace softarm::published
