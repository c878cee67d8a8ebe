// The place of the body farthest along the arm as an answer to the inputs at a shifted time.
#include "clock_problem.h"

#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::check {
namespace {

constexpr double kBlockS = kPolicy.clocks.block_s;

/// Mean place of the track about a time, and the mean of the times; absent where it was not seen.
std::optional<std::pair<double, Eigen::Vector3d>> place_at(const Track& track, std::size_t& at, double t_s,
                                                           double step_s) {
  while (at < track.poses.size() && track.poses[at].t_s < t_s - 0.5 * step_s) ++at;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double time = 0.0;
  int count = 0;
  for (std::size_t i = at; i < track.poses.size() && track.poses[i].t_s < t_s + 0.5 * step_s; ++i) {
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

}  // namespace

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

Eigen::MatrixXd regressors(const ClockProblem& problem, double shift_s) {
  shift_s += problem.centre_s;
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
      if (problem.with_cubes && (i == j || few)) columns.push_back(square.cwiseProduct(linear[j]));
    }
  }
  Eigen::MatrixXd a(n, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) a.col(static_cast<Eigen::Index>(c)) = columns[c];
  a -= problem.hats * (problem.hats.transpose() * a);
  return a;
}

std::optional<ClockProblem> clock_problem(const Context& context, double centre_s, double step_s,
                                          bool without_slow) {
  ClockProblem problem;
  problem.centre_s = centre_s;
  const Track* tip = outermost(context);
  if (!tip) return std::nullopt;
  CheckSpan span{tip->poses.front().t_s, tip->poses.back().t_s};
  for (const Signal& signal : context.signals) {
    if (!drives(signal)) continue;
    problem.signals.push_back(&signal);
    span.from_s = std::max(span.from_s, signal.points.front().t_s + centre_s);
    span.to_s = std::min(span.to_s, signal.points.back().t_s + centre_s);
  }
  if (problem.signals.empty() || span.to_s - span.from_s < kPolicy.clocks.least_s) return std::nullopt;
  std::vector<Eigen::Vector3d> places;
  std::size_t at = 0;
  for (double t = span.from_s; t <= span.to_s; t += step_s) {
    const auto place = place_at(*tip, at, t, step_s);
    if (!place) continue;
    problem.t_s.push_back(place->first);
    problem.block.push_back(static_cast<int>((t - span.from_s) / kBlockS));
    places.push_back(place->second);
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  if (n < kPolicy.clocks.least_samples) return std::nullopt;
  problem.y.resize(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) problem.y.row(k) = places[static_cast<std::size_t>(k)].transpose();
  const Eigen::MatrixXd hats = without_slow ? hat_functions(problem.t_s, span) : Eigen::MatrixXd::Ones(n, 1);
  const Eigen::MatrixXd steps = payload_steps(problem.t_s, context.payload);
  Eigen::MatrixXd h(n, hats.cols() + steps.cols());
  h << hats, steps;
  problem.hats = math::basis_of_columns(h);
  problem.y -= problem.hats * (problem.hats.transpose() * problem.y);
  return problem;
}

}  // namespace softarm::check
