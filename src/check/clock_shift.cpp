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

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::check {
namespace {

constexpr double kScanS = kPolicy.clocks.scan_s;
constexpr double kStepS = kPolicy.clocks.sample_s;
constexpr double kBlockS = kPolicy.clocks.block_s;

struct Problem {
  std::vector<double> t_s;
  Eigen::MatrixXd y;     // samples x 3, m
  Eigen::MatrixXd hats;  // orthonormal columns
  std::vector<int> block;
  std::vector<const Signal*> signals;
  bool with_plays = true;
};

/// Mean place of the track about a time, and the mean of the times; absent where it was not seen.
std::optional<std::pair<double, Eigen::Vector3d>> place_at(const Track& track, std::size_t& at, double t_s) {
  while (at < track.poses.size() && track.poses[at].t_s < t_s - 0.5 * kStepS) ++at;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double time = 0.0;
  int count = 0;
  for (std::size_t i = at; i < track.poses.size() && track.poses[i].t_s < t_s + 0.5 * kStepS; ++i) {
    if (!track.poses[i].good) continue;
    sum += track.poses[i].p;
    time += track.poses[i].t_s;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return std::make_pair(time / count, Eigen::Vector3d(sum / count));
}

void add_plays(const Eigen::VectorXd& u, double range, std::vector<Eigen::VectorXd>* columns) {
  for (const double width : kPolicy.clocks.plays) {
    Eigen::VectorXd play(u.size());
    double x = u(0);
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      const double half = 0.5 * width * range;
      x = std::clamp(x, u(k) - half, u(k) + half);
      play(k) = x;
    }
    columns->push_back(play);
  }
}

/// The regressors at a shift: the arm at t answers to the inputs at t - shift. Hats are projected out.
Eigen::MatrixXd regressors(const Problem& problem, double shift_s) {
  const auto n = static_cast<Eigen::Index>(problem.t_s.size());
  std::vector<Eigen::VectorXd> linear;
  std::vector<Eigen::VectorXd> columns;
  for (const Signal* signal : problem.signals) {
    Eigen::VectorXd u(n);
    const double middle = 0.5 * (signal->low + signal->high), half = std::max(0.5 * signal->range(), 1e-12);
    for (Eigen::Index k = 0; k < n; ++k) {
      u(k) = (signal->at(problem.t_s[static_cast<std::size_t>(k)] - shift_s) - middle) / half;
    }
    linear.push_back(u);
    columns.push_back(u);
    if (problem.with_plays) add_plays(u, 2.0, &columns);
  }
  // A place on a bent arm is no linear function of its bending: without the cubes the plays would stand in.
  const bool few = linear.size() <= kPolicy.clocks.few_inputs;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const Eigen::VectorXd square = linear[i].cwiseProduct(linear[i]);
    for (std::size_t j = 0; j < linear.size(); ++j) {
      if (j >= i && (i == j || linear.size() <= kPolicy.clocks.some_inputs))
        columns.push_back(linear[i].cwiseProduct(linear[j]));
      if (i == j || few) columns.push_back(square.cwiseProduct(linear[j]));
    }
  }
  Eigen::MatrixXd a(n, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) a.col(static_cast<Eigen::Index>(c)) = columns[c];
  a -= problem.hats * (problem.hats.transpose() * a);
  return a;
}

struct Fit {
  double cost = 0.0;
  Eigen::MatrixXd residual, coefficients;
};

Fit fit(const Problem& problem, const Eigen::MatrixXd& a) {
  // A small ridge: inputs that move together leave the split between them open, not the fit.
  Eigen::MatrixXd normal = a.transpose() * a;
  normal.diagonal().array() += 1e-8 * (1.0 + normal.diagonal().maxCoeff());
  Fit result;
  result.coefficients = math::SymmetricSolver(normal).solve_columns(a.transpose() * problem.y);
  result.residual = problem.y - a * result.coefficients;
  result.cost = result.residual.squaredNorm();
  return result;
}

/// The body farthest along the arm; null where none is seen often enough.
const Track* outermost(const Context& context) {
  const Track* tip = nullptr;
  for (const Track& track : context.tracks) {
    if (!track.is_base() && track.poses.size() > kPolicy.clocks.least_poses &&
        (!tip || track.arclength_m >= tip->arclength_m))
      tip = &track;
  }
  return tip;
}

bool drives(const Signal& signal) {
  if (signal.points.size() < kPolicy.clocks.least_values) return false;
  if (signal.range() <= kPolicy.clocks.driven_noises * signal.noise_sd || signal.range() == 0.0) return false;
  return signal.input->kind != arm::InputKind::kPressure || signal.range() >= kPolicy.clocks.driven_pa;
}

/// Hat functions over the time of the samples, one per column: they take up what is slow.
Eigen::MatrixXd hat_functions(const std::vector<double>& t_s, const CheckSpan& span) {
  const double length_s = span.to_s - span.from_s;
  const int hats =
      std::max(2, std::min(kPolicy.clocks.most_slow, static_cast<int>(length_s / kPolicy.clocks.slow_s) + 1));
  const double spacing = length_s / (hats - 1);
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(t_s.size()), hats);
  for (Eigen::Index k = 0; k < h.rows(); ++k) {
    const double x = (t_s[static_cast<std::size_t>(k)] - span.from_s) / spacing;
    const int i = std::min(hats - 2, static_cast<int>(x));
    h(k, i) = 1.0 - (x - i);
    h(k, i + 1) = x - i;
  }
  return h;
}

/// Known payloads: a step each. (Hats take up what is slow, not what is sudden.)
Eigen::MatrixXd payload_steps(const std::vector<double>& t_s, const std::vector<ValuePoint>& payload) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < payload.size(); ++i) {
    if (payload[i].value != payload[i - 1].value) steps.push_back(payload[i].t_s);
  }
  if (steps.size() >= kPolicy.clocks.most_steps) steps.clear();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(t_s.size()), static_cast<Eigen::Index>(steps.size()));
  for (Eigen::Index s = 0; s < columns.cols(); ++s) {
    for (Eigen::Index k = 0; k < columns.rows(); ++k) {
      columns(k, s) = t_s[static_cast<std::size_t>(k)] >= steps[static_cast<std::size_t>(s)] ? 1.0 : 0.0;
    }
  }
  return columns;
}

std::optional<Problem> pose_problem(const Context& context) {
  Problem problem;
  const Track* tip = outermost(context);
  if (!tip) return std::nullopt;
  CheckSpan span{tip->poses.front().t_s, tip->poses.back().t_s};
  for (const Signal& signal : context.signals) {
    if (!drives(signal)) continue;
    problem.signals.push_back(&signal);
    span.from_s = std::max(span.from_s, signal.points.front().t_s);
    span.to_s = std::min(span.to_s, signal.points.back().t_s);
  }
  if (problem.signals.empty() || span.to_s - span.from_s < kPolicy.clocks.least_s) return std::nullopt;
  std::vector<Eigen::Vector3d> places;
  std::size_t at = 0;
  for (double t = span.from_s; t <= span.to_s; t += kStepS) {
    const auto place = place_at(*tip, at, t);
    if (!place) continue;
    problem.t_s.push_back(place->first);
    problem.block.push_back(static_cast<int>((t - span.from_s) / kBlockS));
    places.push_back(place->second);
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  if (n < kPolicy.clocks.least_samples) return std::nullopt;
  problem.y.resize(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) problem.y.row(k) = places[static_cast<std::size_t>(k)].transpose();
  const Eigen::MatrixXd hats = hat_functions(problem.t_s, span);
  const Eigen::MatrixXd steps = payload_steps(problem.t_s, context.payload);
  Eigen::MatrixXd h(n, hats.cols() + steps.cols());
  h << hats, steps;
  problem.hats = math::basis_of_columns(h);
  problem.y -= problem.hats * (problem.hats.transpose() * problem.y);
  return problem;
}

ClockShift solve(const Problem& problem) {
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
    normal.diagonal().array() += 1e-8 * (1.0 + normal.diagonal().maxCoeff());
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
Problem half_of(const Problem& problem, bool second) {
  const auto n = static_cast<Eigen::Index>(problem.t_s.size());
  const Eigen::Index from = second ? n / 2 : 0, count = second ? n - n / 2 : n / 2;
  Problem half = problem;
  half.t_s.assign(problem.t_s.begin() + from, problem.t_s.begin() + from + count);
  half.block.assign(problem.block.begin() + from, problem.block.begin() + from + count);
  for (int& block : half.block) block -= problem.block[static_cast<std::size_t>(from)];
  half.hats = math::basis_of_columns(problem.hats.middleRows(from, count));
  half.y = problem.y.middleRows(from, count);
  half.y -= half.hats * (half.hats.transpose() * half.y);
  return half;
}

}  // namespace

std::optional<ClockShift> clock_shift(const Context& context) {
  const auto problem = pose_problem(context);
  if (!problem) return std::nullopt;
  if (problem->block.back() + 1 < kPolicy.clocks.least_blocks) {
    ClockShift nothing;
    nothing.too_short = true;
    return nothing;
  }
  ClockShift shift = solve(*problem);
  // How much hysteresis there is nobody knows: with and without it differ by what the model leaves open.
  Problem plain = *problem;
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
  return shift;
}

}  // namespace softarm::check
