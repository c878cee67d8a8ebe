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
  const double begin_s = t_s[0], end_s = t_s[t_s.size() - 1], slower = 1.0 - delay.rate;
  const double from_s = begin_s + std::max(0.0, delay.at(*answer.series, begin_s)) / slower,
               to_s = end_s + std::min(0.0, delay.at(*answer.series, end_s)) / slower;
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

/// All trials that say something of delays.
struct Recorded {
  std::vector<Answer> answers;
  double session_s = 0.0;  ///< as long as clocks drift
  unsigned jobs = 1;

  /// At which a delay grows by one step over the session.
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

/// The likeliest delay that grows over the session, about: as if it grew between the trials alone. Of several
/// that are as likely, as where all trials begin at once, the one that grows least.
/// @param gains of each step of a delay of all inputs in each trial, steps x trials, the middle one of none
Delay roughly_growing(const Recorded& all, const MatrixXd& gains) {
  const Eigen::Index none = gains.rows() / 2;
  Delay best;
  double most = 0.0;
  const auto look_at = [&](const Delay& delay) {
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
  };
  for (Eigen::Index slope = 1; slope <= none; ++slope) {
    const double rate = static_cast<double>(slope) * all.rate_step();
    if (!(rate <= kPolicy.delay.greatest_rate)) break;
    for (const double either_way : {-rate, rate})
      for (Eigen::Index step = -none; step <= none; ++step)
        look_at({static_cast<double>(step) * kPolicy.delay.step_s, 0, either_way});
  }
  return best;
}

struct Likely {
  Delay delay;
  double gain = 0.0;
};

/// From a delay uphill, by steps that are halved: what is apart by part of a step must not seem to grow.
Likely uphill(const Recorded& all, const Delay& from) {
  Likely best{from, gain_of(all, from)};
  for (double step = 1.0; step >= kPolicy.delay.finest; step /= 2.0) {
    for (bool moved = true; moved;) {
      std::vector<Likely> around;
      for (const int slope : {-1, 0, 1}) {
        if (slope != 0 && from.rate == 0.0) continue;
        // About the session's middle: there the delay is what it is, however it grows.
        const double more = slope * step * (from.rate == 0.0 ? 0.0 : all.rate_step());
        for (const int shift : {-1, 0, 1}) {
          if (slope == 0 && shift == 0) continue;
          const double offset_s =
              best.delay.offset_s + shift * step * kPolicy.delay.step_s - 0.5 * more * all.session_s;
          const double rate = best.delay.rate + more;
          if (std::abs(rate) <= kPolicy.delay.greatest_rate && std::abs(offset_s) <= kPolicy.delay.longest_s)
            around.push_back({{offset_s, from.input, rate}, 0.0});
        }
      }
      math::in_parallel(around.size(), all.jobs,
                        [&](std::size_t i) { around[i].gain = gain_of(all, around[i].delay); });
      const auto most = std::max_element(around.begin(), around.end(),
                                         [](const Likely& a, const Likely& b) { return a.gain < b.gain; });
      moved = most != around.end() && most->gain > best.gain;
      if (moved) best = *most;
    }
  }
  return best;
}

/// By the longest of it: whether no screen that is linear about no delay sees it.
bool is_long(const Delay& delay, double session_s) {
  return std::max(std::abs(delay.offset_s), std::abs(delay.offset_s + delay.rate * session_s)) >=
         kPolicy.delay.seen_s;
}

}  // namespace

std::vector<Delay> find_delays(const arm::Arm& arm, const std::vector<model::TrialData>& trials,
                               unsigned jobs) {
  const Recorded all = recorded(arm, trials, jobs);
  const auto inputs = static_cast<int>(arm.inputs.scalars.size());
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
  sums.maxCoeff(&row);
  const Likely constant = uphill(all, delays[static_cast<std::size_t>(row)]);
  const Delay rough = roughly_growing(all, gains.topRows(2 * most_steps + 1));
  const Likely growing = rough.rate != 0.0 ? uphill(all, rough) : Likely{};
  std::vector<Delay> found;
  // What grows by less is seen about a delay that does not.
  if (std::abs(growing.delay.rate) * all.session_s >= kPolicy.delay.seen_s &&
      growing.gain >= std::max(0.0, constant.gain) + kPolicy.delay.least_gain)
    found.push_back(growing.delay);
  if (constant.gain >= kPolicy.delay.least_gain) found.push_back(constant.delay);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [&](const Delay& delay) { return !is_long(delay, all.session_s); }),
              found.end());
  return found;
}

}  // namespace softarm::diagnose
