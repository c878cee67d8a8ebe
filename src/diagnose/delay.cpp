#include "delay.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRidge = 1e-8;         // of the columns' mean square: what is constant says nothing
constexpr Eigen::Index kFewInputs = 3;  // of which products of two are looked at, too

/// One trial: where the outermost body was, and what drove the arm.
struct Answer {
  const model::Series* series = nullptr;
  VectorXd t_s;
  MatrixXd places;          ///< n x 3
  MatrixXd besides;         ///< n x columns: 1, payload and gravity
  VectorXd middle, spread;  ///< of each input over the trial
};

int outermost_of(const arm::Arm& arm) {
  int outermost = 0;
  for (std::size_t i = 0; i < arm.bodies.size(); ++i) {
    if (arm.bodies[i].arclength_m > arm.bodies[static_cast<std::size_t>(outermost)].arclength_m)
      outermost = static_cast<int>(i);
  }
  return outermost;
}

Answer answer_of(const model::TrialData& trial, int outermost) {
  Answer answer;
  answer.series = &trial.series;
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> places;
  std::vector<Eigen::Vector4d> besides;
  for (const model::Block& block : trial.blocks) {
    const auto seen = std::find_if(block.bodies.begin(), block.bodies.end(),
                                   [&](const model::Seen& s) { return s.body == outermost; });
    if (seen == block.bodies.end() || block.last <= block.first) continue;
    const auto first = static_cast<Eigen::Index>(block.first);
    const auto count = static_cast<Eigen::Index>(block.last - block.first);
    t_s.push_back(trial.series.t_s.segment(first, count).mean());
    places.push_back(seen->p_base);
    besides.emplace_back(trial.series.payload_kg.segment(first, count).mean(), block.gravity_base.x(),
                         block.gravity_base.y(), block.gravity_base.z());
  }
  const auto n = static_cast<Eigen::Index>(t_s.size());
  answer.t_s = Eigen::Map<const VectorXd>(t_s.data(), n);
  answer.places.resize(n, 3);
  answer.besides.resize(n, 5);
  for (Eigen::Index k = 0; k < n; ++k) {
    answer.places.row(k) = places[static_cast<std::size_t>(k)];
    answer.besides.row(k) << 1.0, besides[static_cast<std::size_t>(k)].transpose();
  }
  const MatrixXd& inputs = trial.series.inputs;
  answer.middle = inputs.rowwise().mean();
  answer.spread =
      ((inputs.colwise() - answer.middle).rowwise().squaredNorm() / std::max<Eigen::Index>(1, inputs.cols()))
          .cwiseSqrt();
  return answer;
}

/// Straight between the instants; t is within them.
double at_time(const model::Series& series, Eigen::Index row, double t_s) {
  const double* begin = series.t_s.data();
  const auto after = std::clamp<Eigen::Index>(std::upper_bound(begin, begin + series.t_s.size(), t_s) - begin,
                                              1, series.t_s.size() - 1);
  const double w = (t_s - series.t_s[after - 1]) / (series.t_s[after] - series.t_s[after - 1]);
  return (1.0 - w) * series.inputs(row, after - 1) + w * series.inputs(row, after);
}

/// Of the blocks [first, first + count), inputs as late as the delay says.
MatrixXd regressors(const Answer& answer, Eigen::Index first, Eigen::Index count, const Delay& delay) {
  std::vector<VectorXd> inputs;
  for (Eigen::Index row = 0; row < answer.spread.size(); ++row) {
    if (!(answer.spread[row] > 0.0)) continue;
    const bool is_late = delay.input == 0 || delay.input == row + 1;
    VectorXd u(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double t_s = answer.t_s[first + k], late_s = is_late ? delay.at(*answer.series, t_s) : 0.0;
      u[k] = (at_time(*answer.series, row, t_s - late_s) - answer.middle[row]) / answer.spread[row];
    }
    inputs.push_back(std::move(u));
  }
  std::vector<VectorXd> columns = inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::size_t end = static_cast<Eigen::Index>(inputs.size()) <= kFewInputs ? inputs.size() : i + 1;
    for (std::size_t j = i; j < end; ++j) columns.push_back(inputs[i].cwiseProduct(inputs[j]));
  }
  MatrixXd a(count, static_cast<Eigen::Index>(columns.size()) + answer.besides.cols());
  for (std::size_t c = 0; c < columns.size(); ++c) a.col(static_cast<Eigen::Index>(c)) = columns[c];
  a.rightCols(answer.besides.cols()) = answer.besides.middleRows(first, count);
  return a;
}

double left_of(const Answer& answer, Eigen::Index first, Eigen::Index count, const Delay& delay) {
  const MatrixXd a = regressors(answer, first, count, delay);
  const MatrixXd y = answer.places.middleRows(first, count);
  MatrixXd normal = a.transpose() * a;
  normal.diagonal().array() += kRidge * normal.diagonal().mean();
  return (y - a * math::SymmetricSolver(normal).solve_columns(a.transpose() * y)).squaredNorm();
}

/// By which the log likelihood of one trial's places rises against no delay, over the blocks whose inputs at
/// either time are known; residuals within a stretch are one.
double gain_of(const Answer& answer, const Delay& delay) {
  if (answer.t_s.size() < kPolicy.delay.fewest_blocks) return 0.0;
  const VectorXd& t_s = answer.series->t_s;
  const double begin_s = t_s[0], end_s = t_s[t_s.size() - 1];
  const double from_s = begin_s + std::max(0.0, delay.at(*answer.series, begin_s)),
               to_s = end_s + std::min(0.0, delay.at(*answer.series, end_s));
  const double* begin = answer.t_s.data();
  const double* end = begin + answer.t_s.size();
  const auto first = static_cast<Eigen::Index>(std::lower_bound(begin, end, from_s) - begin);
  const auto count = static_cast<Eigen::Index>(std::upper_bound(begin, end, to_s) - begin) - first;
  if (count < kPolicy.delay.fewest_blocks) return 0.0;
  const double before = left_of(answer, first, count, {}), after = left_of(answer, first, count, delay);
  if (!(before > 0.0) || !(after > 0.0)) return 0.0;
  const double stretches = std::max(1.0, (to_s - from_s) / kPolicy.fit.stretch_s);
  return 0.5 * 3.0 * stretches * std::log(before / after);
}

/// What is recorded, and how far apart delays of all inputs are that are compared.
struct Recorded {
  std::vector<Answer> answers;
  double session_s = 0.0;  ///< as long as clocks drift
  unsigned jobs = 1;

  double rate_step() const { return kPolicy.delay.step_s / session_s; }
};

Recorded recorded(const arm::Arm& arm, const std::vector<model::TrialData>& trials, unsigned jobs) {
  Recorded all;
  all.jobs = jobs;
  const int outermost = outermost_of(arm);
  for (const model::TrialData& trial : trials) {
    const model::Series& series = trial.series;
    if (series.t_s.size() <= 1) continue;
    all.answers.push_back(answer_of(trial, outermost));
    if (series.session_s <= effects::kClocksDrift_s)
      all.session_s = std::max(all.session_s, series.session_s + series.t_s[series.t_s.size() - 1]);
  }
  return all;
}

double gain_of(const Recorded& all, const Delay& delay) {
  double sum = 0.0;
  for (const Answer& answer : all.answers) sum += gain_of(answer, delay);
  return sum;
}

/// The likeliest delay that grows over the session, about: as if it grew between the trials alone.
/// @param gains of each step of a delay of all inputs in each trial, steps x trials, the middle one of none
Delay roughly_growing(const Recorded& all, const MatrixXd& gains) {
  const Eigen::Index none = gains.rows() / 2;
  Delay best;
  double most = 0.0;
  for (Eigen::Index slope = -none; slope <= none; ++slope) {
    const double rate = static_cast<double>(slope) * all.rate_step();
    if (slope == 0 || std::abs(rate) > kPolicy.delay.greatest_rate) continue;
    for (Eigen::Index step = -none; step <= none; ++step) {
      const Delay delay{static_cast<double>(step) * kPolicy.delay.step_s, 0, rate};
      double sum = 0.0;
      for (std::size_t i = 0; i < all.answers.size(); ++i) {
        const model::Series& series = *all.answers[i].series;
        const double late_s = delay.at(series, 0.5 * (series.t_s[0] + series.t_s[series.t_s.size() - 1]));
        const Eigen::Index row = none + std::lround(late_s / kPolicy.delay.step_s);
        if (row >= 0 && row < gains.rows()) sum += gains(row, static_cast<Eigen::Index>(i));
      }
      if (sum > most) {
        most = sum;
        best = delay;
      }
    }
  }
  return best;
}

/// The same, and by how much the log likelihood rises: step by step uphill from there.
std::pair<Delay, double> growing(const Recorded& all, const MatrixXd& gains) {
  Delay best = roughly_growing(all, gains);
  double most = gain_of(all, best);
  for (bool moved = best.rate != 0.0; moved;) {
    moved = false;
    std::vector<Delay> around;
    for (int step = -1; step <= 1; ++step) {
      for (int slope = -1; slope <= 1; ++slope) {
        const Delay next{best.offset_s + step * kPolicy.delay.step_s, 0, best.rate + slope * all.rate_step()};
        if (std::abs(next.rate) <= kPolicy.delay.greatest_rate &&
            std::abs(next.offset_s) <= kPolicy.delay.longest_s)
          around.push_back(next);
      }
    }
    std::vector<double> here(around.size(), 0.0);
    math::in_parallel(around.size(), all.jobs, [&](std::size_t i) { here[i] = gain_of(all, around[i]); });
    const auto greatest = std::max_element(here.begin(), here.end());
    if (*greatest > most) {
      most = *greatest;
      best = around[static_cast<std::size_t>(greatest - here.begin())];
      moved = true;
    }
  }
  return {best, most};
}

}  // namespace

std::optional<Delay> find_delay(const arm::Arm& arm, const std::vector<model::TrialData>& trials,
                                unsigned jobs) {
  const Recorded all = recorded(arm, trials, jobs);
  const auto inputs = static_cast<Eigen::Index>(arm.inputs.scalars.size());
  const auto most_steps = static_cast<int>(std::lround(kPolicy.delay.longest_s / kPolicy.delay.step_s));
  std::vector<Delay> delays;  // first those of all inputs
  for (int input = 0; input <= (inputs > 1 ? inputs : 0); ++input) {
    for (int step = -most_steps; step <= most_steps; ++step)
      delays.push_back({step * kPolicy.delay.step_s, input, 0.0});
  }
  MatrixXd gains(static_cast<Eigen::Index>(delays.size()), static_cast<Eigen::Index>(all.answers.size()));
  math::in_parallel(delays.size(), jobs, [&](std::size_t i) {
    for (std::size_t k = 0; k < all.answers.size(); ++k)
      gains(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = gain_of(all.answers[k], delays[i]);
  });
  Eigen::Index row = 0;
  const VectorXd sums = gains.rowwise().sum();
  double most = sums.maxCoeff(&row);
  Delay best = delays[static_cast<std::size_t>(row)];
  const auto [drifting, with_rate] = growing(all, gains.topRows(2 * most_steps + 1));
  if (with_rate > most + kPolicy.delay.least_gain) {
    most = with_rate;
    best = drifting;
  }
  const double longest_s =
      std::max(std::abs(best.offset_s), std::abs(best.offset_s + best.rate * all.session_s));
  if (most < kPolicy.delay.least_gain || longest_s < kPolicy.delay.seen_s) return std::nullopt;
  return best;
}

}  // namespace softarm::diagnose
