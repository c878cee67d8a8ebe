// The clock of the inputs against that of the bodies, from the motion that the inputs cause.
//
// The place of the body farthest along the arm is regressed on the inputs at a shifted time: a constant, the
// inputs, their squares, cubes and products, plays of two widths (rate-independent hysteresis, which at one
// speed looks like a lag), the known payload, and hat functions over some seconds that take up what is slow
// (creep, drift, payloads that nobody announced). The shift of least residual is found by a scan and
// Gauss-Newton; its variance is that of a least-squares estimate whose residuals are correlated within blocks
// of two seconds (a sandwich, clustered).
#include "clock_shift.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "clock_problem.h"
#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::check {
namespace {

constexpr double kScanS = kPolicy.clocks.scan_s;

struct Fit {
  double cost = 0.0;
  Eigen::MatrixXd residual, coefficients;
};

Fit fit(const ClockProblem& problem, const Eigen::MatrixXd& a) {
  // A small ridge: inputs that move together leave the split between them open, not the fit.
  Eigen::MatrixXd normal = a.transpose() * a;
  normal.diagonal().array() += kPolicy.clocks.ridge * (1e-12 + normal.diagonal().mean());
  Fit result;
  result.coefficients = math::SymmetricSolver(normal).solve_columns(a.transpose() * problem.y);
  result.residual = problem.y - a * result.coefficients;
  result.cost = result.residual.squaredNorm();
  return result;
}

ClockShift solve(const ClockProblem& problem) {
  ClockShift result;
  double least = -1.0;
  for (double shift = -kPolicy.clocks.most_shift_s; shift <= kPolicy.clocks.most_shift_s + 1e-9;
       shift += kScanS) {
    const double cost = fit(problem, regressors(problem, shift)).cost;
    if (least < 0.0 || cost < least) {
      least = cost;
      result.shift_s = shift;
    }
  }
  result.at_edge = std::abs(result.shift_s) > kPolicy.clocks.most_shift_s - 0.5 * kScanS;
  constexpr double kDelta = 0.005;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const Eigen::MatrixXd a = regressors(problem, result.shift_s);
    const Fit now = fit(problem, a);
    const Eigen::MatrixXd slope =
        (regressors(problem, result.shift_s + kDelta) - regressors(problem, result.shift_s - kDelta)) /
        (2.0 * kDelta);
    // Change of the model with the shift, less what the coefficients could make of it.
    Eigen::MatrixXd d = slope * now.coefficients;
    Eigen::MatrixXd normal = a.transpose() * a;
    normal.diagonal().array() += kPolicy.clocks.ridge * (1e-12 + normal.diagonal().mean());
    d -= a * math::SymmetricSolver(normal).solve_columns(a.transpose() * d);
    const double information = d.squaredNorm();
    result.explained = 1.0 - now.cost / std::max(problem.y.squaredNorm(), 1e-300);
    if (!(information > 0.0)) {
      result.sd_s = 1e9;
      return result;
    }
    const Eigen::VectorXd products = d.cwiseProduct(now.residual).rowwise().sum();
    std::vector<double> blocks(static_cast<std::size_t>(problem.block.back()) + 1, 0.0);
    for (std::size_t k = 0; k < problem.block.size(); ++k) {
      blocks[static_cast<std::size_t>(problem.block[k])] += products(static_cast<Eigen::Index>(k));
    }
    double meat = 0.0;
    for (const double b : blocks) meat += b * b;
    const double few = static_cast<double>(blocks.size());
    result.sd_s = std::sqrt(meat * few / std::max(few - 4.0, 1.0)) / information;
    const double step = std::clamp(products.sum() / information, -kScanS, kScanS);
    result.shift_s += step;
    if (std::abs(step) < 2e-4) break;
  }
  return result;
}

/// One half of it.
ClockProblem half_of(const ClockProblem& problem, bool second) {
  const auto n = static_cast<Eigen::Index>(problem.t_s.size());
  const Eigen::Index from = second ? n / 2 : 0, count = second ? n - n / 2 : n / 2;
  ClockProblem half = problem;
  half.t_s.assign(problem.t_s.begin() + from, problem.t_s.begin() + from + count);
  half.block.assign(problem.block.begin() + from, problem.block.begin() + from + count);
  for (int& block : half.block) block -= problem.block[static_cast<std::size_t>(from)];
  half.hats = math::basis_of_columns(problem.hats.middleRows(from, count));
  half.y = problem.y.middleRows(from, count);
  half.y -= half.hats * (half.hats.transpose() * half.y);
  return half;
}

}  // namespace

std::optional<ClockShift> clock_shift(const Context& context, double centre_s) {
  const auto problem = clock_problem(context, centre_s, kPolicy.clocks.sample_s);
  if (!problem) return std::nullopt;
  if (problem->block.back() + 1 < kPolicy.clocks.least_blocks) {
    ClockShift nothing;
    nothing.too_short = true;
    return nothing;
  }
  ClockShift shift = solve(*problem);
  // How much hysteresis there is nobody knows: with and without it differ by what the model leaves open.
  ClockProblem plain = *problem;
  plain.with_plays = false;
  shift.sd_s =
      std::hypot(shift.sd_s, kPolicy.clocks.hysteresis_share * (solve(plain).shift_s - shift.shift_s));
  // What the model leaves unexplained may pull: the halves of the trial then disagree.
  if (shift.explained < kPolicy.clocks.explained_well) {
    double sum = 0.0, weights = 0.0;
    for (const bool second : {false, true}) {
      const ClockShift half = solve(half_of(*problem, second));
      const double weight = 1.0 / std::max(half.sd_s * half.sd_s, 1e-6);
      sum += weight * (half.shift_s - shift.shift_s) * (half.shift_s - shift.shift_s);
      weights += weight;
    }
    shift.sd_s = std::hypot(shift.sd_s, std::sqrt(0.5 * sum / weights));
  }
  shift.shift_s += centre_s;
  return shift;
}

}  // namespace softarm::check
