// The fit with effects of the arm file in the model.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "estimator_impl.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

constexpr int kOneStep = 2;  // TinySolver counts its start
constexpr int kMostPasses = 8, kOldDerivativePasses = 2;

}  // namespace

bool Estimator::Impl::solve_with_effects() {
  if (!extension) return solve_with_window();
  line_is_old = false;
  const std::optional<Window> window_before = window;
  const int contradictions_before = contradictions;
  const auto begin_again = [&] {
    for (Observation& o : problem.observations()) o.used = true;
    window = window_before;
    contradictions = contradictions_before;
    believe();
  };
  VectorXd at;
  if (have_last) {
    at = last_x;
    impose_knowns(at);
  } else if (start_cold()) {
    at = x;
  } else if (solve_with_window()) {
    at = x;
    begin_again();
  } else {
    return false;
  }
  const auto lost = [&](const char* where) {
    have_last = false;
    fail(Status::kNoConvergence,
         fmt::format("with its effects the arm has no equilibrium near the {}", where));
    return false;
  };
  line_is_old = have_last && extension->line_reaches(problem, at);
  if (!line_is_old && !extension->linearise(problem, at, laws_at_frame, false)) return lost("bodies");
  problem.set_effects(&extension->at());
  const auto done = [&] {
    if (extension->renew_errors(problem, x, laws_at_frame)) refresh_covariance();
    return true;
  };
  if (!fit_again(true)) return false;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    // What a line is off by grows with the way: after a short one it need not be looked at again.
    const std::optional<double> expected_sd = extension->expected_off_sd(problem, x);
    if (expected_sd && *expected_sd < kPolicy.effects.agrees_sd) return done();
    const std::optional<double> off_sd = extension->move_line(problem, x, laws_at_frame);
    if (!off_sd) return lost("fit");
    if (*off_sd < kPolicy.effects.agrees_sd) return done();
    const bool whole = *off_sd >= kPolicy.bodies.look_again_sd;
    if (whole) begin_again();
    if (pass >= kOldDerivativePasses && !extension->linearise(problem, x, laws_at_frame, true))
      return lost("fit");
    if (!fit_again(whole)) return false;
  }
  have_last = false;
  fail(Status::kNoConvergence, "the fit and the arm's effects do not converge together");
  return false;
}

void Estimator::Impl::move_old_line() {
  if (!line_is_old) return;
  line_is_old = false;
  const int iterations = solver.options.max_num_iterations;
  solver.options.max_num_iterations = kOneStep;
  iterate();
  solver.options.max_num_iterations = iterations;
  extension->move_line(problem, x, laws_at_frame);
}

bool Estimator::Impl::fit_again(bool whole) {
  if (whole) {
    problem.begin();
    return solve_with_window();
  }
  if (!problem.evaluate(x)) x = extension->at().x;  // where the line is there is a shape
  if (!problem.evaluate(x) || !minimise()) {
    have_last = false;
    fail(Status::kNoConvergence, "the fit was lost when the arm's effects were computed again");
    return false;
  }
  refresh_covariance();
  return true;
}

void Estimator::Impl::take_effects_out() {
  frame_by_laws = extension->frame();
  frame_by_laws.inputs = extension->moment_inputs();
  estimate_by_laws = estimate;
  const double length = arm.total_length_m();
  for (BackbonePoint& point : estimate_by_laws.backbone) {
    const rod::RodState state = problem.solver().at(std::min(point.arclength_m, length));
    point = {state.s_m, state.p, state.q, state.u};
  }
  for (std::size_t i = 0; i < estimate_by_laws.residuals.size(); ++i) {
    BodyResidual& body = estimate_by_laws.residuals[i];
    const Eigen::Vector3d off = body.measured_base - body.estimated_base;
    body.estimated_base = problem.position_by_laws(problem.observations()[i]);
    body.measured_base = body.estimated_base + off;
  }
}

}  // namespace softarm::estimate
