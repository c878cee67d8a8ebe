// Step 5: what the fit says.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator_impl.h"
#include "math/tiny_solver_tolerance.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

}  // namespace

std::string Estimator::Impl::length_hint() const {
  std::vector<const Observation*> along;
  for (const Observation& o : problem.observations()) along.push_back(&o);
  const auto arclength = [&](const Observation* o) {
    return arm.bodies[static_cast<std::size_t>(o->body)].arclength_m;
  };
  std::sort(along.begin(), along.end(),
            [&](const Observation* a, const Observation* b) { return arclength(a) < arclength(b); });
  double measured = 0.0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  for (const Observation* o : along) {
    measured += (o->p - from).norm();
    from = o->p;
  }
  const double expected = along.empty() ? 0.0 : arclength(along.back());
  constexpr double kOther = kPolicy.fit.other_length;
  if (kOther * measured >= expected && measured <= kOther * expected) return "";
  return fmt::format("; from the base through the bodies it is {:.3g} m, by the arm file {:.3g} m: {}",
                     measured, expected, kUnitsHint);
}

void Estimator::Impl::finish() {
  estimate.rms_residual_m = rms();
  estimate.solver.rod_solves = problem.rod_solves();
  if (options.method == arm::Method::kCcEndpoint) estimated = problem.free();
  if (estimate.rms_residual_m > kPolicy.fit.inconsistent * arm.total_length_m()) {
    have_last = false;
    fail(Status::kInconsistent,
         fmt::format("no shape of this arm comes nearer than {:.1f} mm to the bodies{}",
                     1e3 * estimate.rms_residual_m, length_hint()));
    return;
  }
  if (options.method == arm::Method::kCcEndpoint) refresh_covariance();
  residuals_and_chi_square();
  const int dof = estimate.degrees_of_freedom;
  if (dof > 0 && dof < static_cast<int>(inflation_limit.size()) &&
      estimate.reduced_chi_square * dof > inflation_limit[static_cast<std::size_t>(dof - 1)]) {
    covariance.x *= estimate.reduced_chi_square;
    scatter *= estimate.reduced_chi_square;
  }
  if (window || options.method == arm::Method::kCcEndpoint) scatter = covariance.x;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const int c = Problem::column(i, 2);
    const double believed = options.prior.enabled && law.information.size() > 0
                                ? law.information[c] / std::pow(law.shared(c, c), 2)
                                : 0.0;
    fill_segment(problem, i, x, {covariance, scatter}, estimated, believed, options,
                 estimate.segments[static_cast<std::size_t>(i)]);
  }
  // The shape is that of the whole model; where it has no equilibrium at the limits, that of the laws.
  extended = extension && extension->keep(problem, x, laws_at_frame);
  bending_angles();
  payload();
  backbone();
  last_x = x;
  have_last = options.method != arm::Method::kCcEndpoint;
  confirm_stiffness();
}

void Estimator::Impl::confirm_stiffness() {
  if (!model::near_buckling(problem.solver())) return;
  const double moved = 1.0 + 2.0 * options.identifiable_relative_sd;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    SegmentEstimate& segment = estimate.segments[static_cast<std::size_t>(i)];
    if (!segment.identifiable_stiffness) continue;
    const int column = Problem::column(i, 2);
    const Eigen::Quaterniond q_tip = problem.solver().q_tip();
    problem.free()[static_cast<std::size_t>(column)] = false;
    for (const double factor : {moved, 1.0 / moved}) {
      VectorXd y = last_x;
      problem.begin();
      problem.forget();
      problem.evaluate(y, q_tip);
      y[column] *= factor;
      double cost = std::numeric_limits<double>::infinity();
      // Of a fit that has not converged what it may yet come to.
      const auto least_cost = [&](const VectorXd& at) {
        return solver.summary.final_cost - (math::met_tolerance(solver) ? 0.0 : 0.5 * left_to_fall(at));
      };
      if (problem.evaluate(y)) {
        solver.Solve(problem, &y);
        cost = least_cost(y);
      }
      // Without an equilibrium within reach, the shape itself is another start.
      known_flexibility[static_cast<std::size_t>(i)] = start_flexibility[static_cast<std::size_t>(i)] =
          y[column];
      if (start_cold()) {
        solver.Solve(problem, &x);
        cost = std::min(cost, least_cost(x));
      }
      if (2.0 * (cost - estimate.solver.final_cost) < kPolicy.fit.other_direction_chi2) {
        segment.identifiable_stiffness = false;
        segment.stiffness_why_not = WhyNot::kNearBuckling;
      }
    }
    problem.free()[static_cast<std::size_t>(column)] = true;
  }
  problem.forget();
  problem.evaluate(last_x);
  x = last_x;
}

void Estimator::Impl::residuals_and_chi_square() {
  double chi2 = 0.0;
  int rows = 0;
  for (const Observation& o : problem.observations()) {
    BodyResidual r;
    r.body = o.body;
    r.measured_base = o.p;
    r.estimated_base = problem.position(o);
    r.used = o.used;
    estimate.residuals.push_back(r);
    if (!o.used) continue;
    const double sd = problem.position_sd(o);
    chi2 += (r.estimated_base - r.measured_base).squaredNorm() / (sd * sd);
    rows += 3;
    if (o.tangent) {
      const Vector3d e = problem.tangent(o) - *o.tangent;
      chi2 += e.squaredNorm() / (problem.tangent_sd(o) * problem.tangent_sd(o));
      rows += 2;
    }
  }
  chi2 -= by_common_errors(problem);
  const auto parameters = problem.belief() ? std::lround(determined_by_bodies(problem, x))
                                           : std::count(estimated.begin(), estimated.end(), true);
  estimate.degrees_of_freedom = std::max(0, rows - static_cast<int>(parameters));
  estimate.reduced_chi_square = estimate.degrees_of_freedom > 0 ? chi2 / estimate.degrees_of_freedom : 0.0;
}

void Estimator::Impl::bending_angles() {
  Vector3d from = Vector3d::UnitZ();
  double end_m = 0.0;
  if (extended) from = extension->shape_at(0.0).q * from;
  for (std::size_t i = 0; i < arm.segments.size(); ++i) {
    const int station = static_cast<int>(arm.bodies.size() + i);
    end_m += arm.segments[i].length_m;
    const Eigen::Quaterniond q = extended ? extension->shape_at(std::min(end_m, arm.total_length_m())).q
                                          : problem.solver().station(station).q;
    const Vector3d to = q * Vector3d::UnitZ();
    estimate.segments[i].bending_angle_rad = std::atan2(from.cross(to).norm(), from.dot(to));
    from = to;
  }
}

void Estimator::Impl::payload() {
  if (is_constant_curvature(options.method)) {
    estimate.payload_kg = payload_known;
    return;
  }
  const int column = problem.payload_column();
  estimate.payload_kg = x[column] * Problem::kPayloadUnit;
  if (options.unknown == arm::Unknown::kStiffness || !covariance.determined[static_cast<std::size_t>(column)])
    return;
  estimate.sd_payload_kg = std::sqrt(covariance.x(column, column)) * Problem::kPayloadUnit;
  estimate.identifiable_payload =
      *estimate.sd_payload_kg <= options.identifiable_relative_sd * *estimate.payload_kg;
}

void Estimator::Impl::backbone() {
  const double length = arm.total_length_m();
  for (int i = 0; i < backbone_points; ++i) {
    const double s_m = length * i / std::max(1, backbone_points - 1);
    const rod::RodState state = extended ? extension->shape_at(s_m) : problem.solver().at(s_m);
    estimate.backbone.push_back({state.s_m, state.p, state.q, state.u});
  }
}

}  // namespace softarm::estimate
