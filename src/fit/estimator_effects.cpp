// The fit with effects of the arm file in the model.
#include <algorithm>
#include <optional>

#include "estimator_impl.h"

namespace softarm {
namespace {

using fit::Observation;

constexpr double kAgrees_sd = 0.03;  // between the line of the effects and what they do at the fit
constexpr double kAnother_sd = 1.0;  // beyond which another body may be an outlier
constexpr int kMostPasses = 8, kOldDerivativePasses = 2;

}  // namespace

bool Estimator::Impl::solve_with_effects() {
  if (!extension) return solve_with_window();
  const std::optional<fit::Window> window_before = window;
  const int contradictions_before = contradictions;
  Eigen::VectorXd at;
  if (have_last) {
    at = last_x;
    impose_knowns(at);
  } else if (start_cold()) {
    at = x;
  } else {
    return solve_with_window();
  }
  double off_sd = kAnother_sd;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    if (!extension->linearise(problem, at, laws_at_frame, pass >= kOldDerivativePasses)) {
      have_last = false;
      fail(Status::kNoConvergence, "with its effects the arm has no equilibrium near the bodies");
      return false;
    }
    problem.set_effects(&extension->at());
    const bool whole = pass == 0 || off_sd >= kAnother_sd;
    if (whole) {
      for (Observation& o : problem.observations()) o.used = true;
      window = window_before;
      contradictions = contradictions_before;
      believe();
    }
    if (!fit_again(whole)) return false;
    const std::optional<double> off = extension->off_sd(problem, x, laws_at_frame);
    if (!off) {
      have_last = false;
      fail(Status::kNoConvergence, "with its effects the arm has no equilibrium near the fit");
      return false;
    }
    off_sd = *off;
    if (off_sd < kAgrees_sd) break;
    at = x;
  }
  return true;
}

bool Estimator::Impl::fit_again(bool whole) {
  problem.begin();
  if (whole) return solve_with_window();
  if (!problem.evaluate(x) || !minimise()) {
    have_last = false;
    fail(Status::kNoConvergence, "the fit was lost when the arm's effects were worked out anew");
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

}  // namespace softarm
