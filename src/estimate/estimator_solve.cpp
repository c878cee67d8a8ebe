// Steps 2 to 4: starts, the fit, outliers, bounds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator_impl.h"
#include "free_tip.h"
#include "math/linear_algebra.h"
#include "math/tiny_solver_tolerance.h"
#include "policy.h"
#include "start.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

}  // namespace

void Estimator::Impl::impose_knowns(VectorXd& v) const {
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const auto& known = known_flexibility[static_cast<std::size_t>(i)];
    if (known) v[Problem::column(i, 2)] = *known;
  }
  if (options.unknown == arm::Unknown::kStiffness)
    v[problem.payload_column()] = payload_known.value_or(0.0) / Problem::kPayloadUnit;
}

void Estimator::Impl::refresh_covariance() {
  covariance = estimate::covariance(problem, problem.free(), options);
}

double Estimator::Impl::rms() const {
  double sum = 0.0;
  int count = 0;
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    sum += (problem.position(o) - o.p).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / std::max(1, count));
}

bool Estimator::Impl::start_cold(bool free_tip) {
  problem.forget();
  std::vector<std::optional<double>> c = start_flexibility;
  if (is_constant_curvature(options.method)) c.assign(c.size(), 1.0);
  Start start = start_from_shape(arm, problem, c, payload_known.value_or(0.0));
  impose_knowns(start.x);
  if (free_tip && !refine_with_free_tip(problem, start)) return false;
  x = start.x;
  return problem.evaluate(x, start.q_tip) || problem.evaluate(x);
}

void Estimator::Impl::iterate() {
  solver.Solve(problem, &x);
  converged = math::met_tolerance(solver) || left_to_fall(x) < kPolicy.fit.converged_chi2;
  estimate.solver.iterations += solver.summary.iterations;
  if (estimate.solver.initial_cost == 0.0) estimate.solver.initial_cost = solver.summary.initial_cost;
  estimate.solver.final_cost = solver.summary.final_cost;
}

double Estimator::Impl::left_to_fall(const VectorXd& at) const {
  if (!problem.evaluate(at)) return std::numeric_limits<double>::infinity();
  VectorXd residuals(problem.NumResiduals());
  Eigen::MatrixXd j(problem.NumResiduals(), problem.NumParameters());
  problem(at.data(), residuals.data(), j.data());
  const VectorXd gradient = j.transpose() * residuals;
  Eigen::MatrixXd information = j.transpose() * j;
  for (Eigen::Index i = 0; i < information.rows(); ++i) {
    if (!(information(i, i) > 0.0)) information(i, i) = 1.0;  // held
  }
  return gradient.dot(math::solve_symmetric(information, gradient));
}

bool Estimator::Impl::has_converged() {
  if (converged) return true;
  have_last = false;
  const int most = solver.options.max_num_iterations - 1;
  fail(Status::kNoConvergence, fmt::format("the fit had not converged after {} iteration{}{}", most,
                                           most == 1 ? "" : "s", length_hint()));
  return false;
}

bool Estimator::Impl::minimise() {
  move_old_line();
  iterate();
  return problem.evaluate(x) && x.allFinite();
}

bool Estimator::Impl::solve() {
  const double length = arm.total_length_m();
  bool warm = have_last;
  if (warm) {
    x = last_x;
    impose_knowns(x);
    warm = problem.evaluate(x) && rms() < kPolicy.fit.bad_start * length;
  }
  bool good = (warm || start_cold()) && minimise();
  const auto poor = [&] { return !good || !converged || rms() > kPolicy.fit.poor * length; };
  if (warm && poor()) {
    warm = false;
    good = start_cold() && minimise();
  }
  // A standing arm near its buckling load, say: at a stiffness far off it has no equilibrium near its
  // shape, or the fit runs into the load at which it is lost.
  if (good) refresh_covariance();
  if (poor() || !covariance.shape_determined) {
    const VectorXd before = x;
    const bool converged_before = good && converged;
    const double rms_before = good ? rms() : std::numeric_limits<double>::infinity();
    const bool better =
        start_cold(true) && minimise() && (converged == converged_before ? rms() < rms_before : converged);
    if (!better) {
      x = before;
      converged = converged_before;
    }
    good = better || (good && problem.evaluate(x));
    if (good) refresh_covariance();
  }
  estimate.solver.warm_start = warm;
  if (!good) {
    have_last = false;
    fail(Status::kNoConvergence,
         "no shape of this arm that the fit can reach lies near the bodies" + length_hint());
  }
  return good;
}

double Estimator::Impl::distance(const Observation& o) const {
  return (problem.position(o) - o.p).norm() / std::hypot(problem.position_sd(o), problem.displaced_sd(o));
}

Estimator::Impl::Distances Estimator::Impl::distances() const {
  Distances d;
  for (const Observation& o : problem.observations()) {
    if (!o.used) continue;
    d.largest = std::max(d.largest, distance(o));
    d.sum_of_squares += (problem.position(o) - o.p).squaredNorm() / std::pow(problem.position_sd(o), 2);
    ++d.used;
  }
  return d;
}

bool Estimator::Impl::contradicted(bool fitted) const {
  return !fitted || distances().largest >= kPolicy.bodies.outlier;
}

bool Estimator::Impl::solve_without_window() {
  for (Observation& o : problem.observations()) o.used = true;
  window->clear();
  believe();
  problem.begin();
  return solve();
}

bool Estimator::Impl::solve_with_window() {
  bool fitted = solve();
  if (!window || window->frames() == 0 || !contradicted(fitted)) {
    contradictions = 0;
    return set_outliers_aside(fitted);
  }
  // Either a body is wrong, or what the window's frames share has changed. Without them the bodies fit each
  // other after a change, but few bodies fit each other with a wrong one among them as well: where a body may
  // be the reason, it is in the first such frame, and a change in the next.
  const Window before = *window;
  const VectorXd x_before = x;
  const bool may_have_changed = !contradicted(solve_without_window());
  if (may_have_changed && ++contradictions > 1) {
    contradictions = 0;
    return true;
  }
  *window = before;
  believe();
  problem.begin();
  last_x = x_before;
  have_last = fitted;
  fitted = set_outliers_aside(solve());
  if (!contradicted(fitted) || !may_have_changed) return fitted;
  contradictions = 0;
  return solve_without_window();
}

bool Estimator::Impl::set_one_aside(bool fitted) {
  std::vector<Observation>& observations = problem.observations();
  const VectorXd x_before = x;
  const Eigen::Quaterniond tip_before = problem.solver().q_tip();
  const bool converged_before = converged;
  bool best_converged = false;
  Observation* outlier = nullptr;
  VectorXd best_x;
  Eigen::Quaterniond best_tip;
  double least = std::numeric_limits<double>::infinity(), least_cost = least;
  for (Observation& o : observations) {
    if (!o.used) continue;
    o.used = false;
    problem.begin();
    for (const bool cold : {false, true}) {
      if (!cold && !fitted) continue;
      x = x_before;
      if (!(cold ? start_cold() : problem.evaluate(x, tip_before)) || !minimise()) continue;
      const Distances rest = distances();
      // Few bodies fit each other whichever is left out: what is believed decides.
      const double cost = problem.belief() ? solver.summary.final_cost : rest.sum_of_squares;
      if (cost < least_cost) {
        least_cost = cost;
        least = rest.sum_of_squares;
        outlier = &o;
        best_x = x;
        best_converged = converged;
        best_tip = problem.solver().q_tip();
      }
      if (rest.largest < kPolicy.bodies.outlier) break;
    }
    o.used = true;
  }
  if (outlier != nullptr) {
    outlier->used = false;
    problem.begin();
    x = best_x;
    converged = best_converged;
    if (problem.evaluate(x, best_tip)) {
      const double rest = std::sqrt(least / distances().used);
      if (distance(*outlier) > std::max(kPolicy.bodies.outlier, kPolicy.bodies.outlier_against_rest * rest))
        return true;
    }
    outlier->used = true;
  }
  problem.begin();
  x = x_before;
  converged = converged_before;
  if (fitted) problem.evaluate(x, tip_before);
  return false;
}

bool Estimator::Impl::set_outliers_aside(bool fitted) {
  if (!options.robust) return fitted;
  while (true) {
    const Distances now = fitted ? distances() : Distances();
    const auto& observations = problem.observations();
    const auto used =
        std::count_if(observations.begin(), observations.end(), [](const Observation& o) { return o.used; });
    // Where the laws are believed, they stand in for bodies.
    const int parameters = problem.belief() ? 2 : estimated_parameters();
    if ((fitted && now.largest < kPolicy.bodies.outlier) || 3 * (static_cast<int>(used) - 1) - parameters < 1)
      return fitted;
    if (!set_one_aside(fitted)) return fitted;
    fitted = true;
    refresh_covariance();
  }
}

int Estimator::Impl::estimated_parameters() const {
  return static_cast<int>(std::count(problem.free().begin(), problem.free().end(), true));
}

std::vector<arm::Range> Estimator::Impl::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<arm::Range> ranges(static_cast<std::size_t>(x.size()), {-kInfinity, kInfinity});
  const auto at = [&](int column) -> arm::Range& { return ranges[static_cast<std::size_t>(column)]; };
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const arm::Segment& segment = arm.segments[static_cast<std::size_t>(i)];
    const double reference = problem.reference_stiffness(i), rest = problem.rest_length(i);
    at(Problem::column(i, 2)) = {reference / segment.bending_stiffness_range_nm2.high,
                                 reference / segment.bending_stiffness_range_nm2.low};
    const arm::Range& length = segment.length_range_m;
    if (length.high > 0.0) at(Problem::column(i, 3)) = {length.low / rest, length.high / rest};
  }
  at(problem.payload_column()) = {arm.payload.range_kg.low / Problem::kPayloadUnit,
                                  arm.payload.range_kg.high / Problem::kPayloadUnit};
  return ranges;
}

bool Estimator::Impl::keep_to_bounds() {
  estimated = problem.free();
  bool moved = false;
  const std::vector<arm::Range> ranges = bounds();
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    double& value = x[static_cast<Eigen::Index>(i)];
    if (!estimated[i] || (value >= ranges[i].low && value <= ranges[i].high)) continue;
    value = std::clamp(value, ranges[i].low, ranges[i].high);
    problem.free()[i] = false;
    moved = true;
  }
  if (!moved) return true;
  problem.begin();
  bool good = problem.evaluate(x) && minimise() && converged;
  if (!good) {
    // Too far for a step: from the measured shape, with what is held as known.
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      const int column = Problem::column(i, 2);
      if (problem.free()[static_cast<std::size_t>(column)]) continue;
      known_flexibility[static_cast<std::size_t>(i)] = start_flexibility[static_cast<std::size_t>(i)] =
          x[column];
    }
    good = start_cold() && minimise();
  }
  problem.free() = estimated;  // what is identifiable is asked of all of them
  problem.begin();
  if (!good || !problem.evaluate(x)) {
    have_last = false;
    fail(Status::kNoConvergence,
         "no shape with stiffness, length and payload in their ranges was found" + length_hint());
    return false;
  }
  refresh_covariance();
  return true;
}

}  // namespace softarm::estimate
