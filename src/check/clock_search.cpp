#include "clock_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "clock_problem.h"
#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::check {
namespace {

constexpr const Policy::Clocks& kBy = kPolicy.clocks;

/// How much something changed in each of the bins of a time; absent: nobody saw it.
using Activity = std::vector<std::optional<double>>;

struct Bins {
  double from_s = 0.0, width_s = 0.0;
  std::size_t count = 0;
};

Bins bins_of(double from_s, double to_s) {
  Bins bins{from_s, 0.0, 0};
  bins.width_s = std::max(kBy.bin_s, (to_s - from_s) / kBy.most_bins);
  bins.count = static_cast<std::size_t>((to_s - from_s) / bins.width_s) + 1;
  return bins;
}

/// A few large steps would be all that a correlation sees.
double damped(double change) {
  return std::sqrt(change);
}

Activity activity_of(const Track& track, const Bins& bins) {
  std::vector<Eigen::Vector3d> sums(bins.count, Eigen::Vector3d::Zero());
  std::vector<int> counts(bins.count, 0);
  for (const TrackPose& pose : track.poses) {
    const double at = (pose.t_s - bins.from_s) / bins.width_s;
    if (!pose.good || !(at >= 0.0) || at >= static_cast<double>(bins.count)) continue;
    sums[static_cast<std::size_t>(at)] += pose.p;
    ++counts[static_cast<std::size_t>(at)];
  }
  Activity activity(bins.count);
  for (std::size_t k = 1; k < bins.count; ++k) {
    if (counts[k] > 0 && counts[k - 1] > 0)
      activity[k] = damped((sums[k] / counts[k] - sums[k - 1] / counts[k - 1]).norm());
  }
  return activity;
}

/// Of all inputs together, each in its range.
Activity activity_of(const std::vector<const Signal*>& signals, const Bins& bins) {
  Activity activity(bins.count);
  for (std::size_t k = 1; k < bins.count; ++k) {
    const double t_s = bins.from_s + bins.width_s * (static_cast<double>(k) + 0.5);
    double change = 0.0;
    bool seen = true;
    for (const Signal* signal : signals) {
      seen = seen && t_s - bins.width_s >= signal->points.front().t_s && t_s <= signal->points.back().t_s;
      change += std::abs(signal->at(t_s) - signal->at(t_s - bins.width_s)) / signal->range();
    }
    if (seen) activity[k] = damped(change);
  }
  return activity;
}

/// Of the bins that both have; nothing where these are too few.
std::optional<double> correlation(const Activity& bodies, const Activity& inputs, long shift,
                                  std::size_t least_bins) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  const long count = static_cast<long>(bodies.size());
  for (long k = std::max(0L, shift); k < std::min(count, count + shift); ++k) {
    const auto &a = bodies[static_cast<std::size_t>(k)], &b = inputs[static_cast<std::size_t>(k - shift)];
    if (!a || !b) continue;
    n += 1.0;
    x += *a;
    y += *b;
    xx += *a * *a;
    yy += *b * *b;
    xy += *a * *b;
  }
  if (n < static_cast<double>(least_bins)) return std::nullopt;
  const double spread = (xx - x * x / n) * (yy - y * y / n);
  return spread > 0.0 ? std::optional((xy - x * y / n) / std::sqrt(spread)) : std::nullopt;
}

struct Peak {
  double shift_s = 0.0, height = 0.0;
};

/// The highest peaks of the correlation, no two close together, none within what is looked at anyway.
std::vector<Peak> peaks_of(const Activity& bodies, const Activity& inputs, const Bins& bins,
                           double least_overlap_s) {
  const auto least_bins = static_cast<std::size_t>(least_overlap_s / bins.width_s);
  std::vector<Peak> all;
  const long count = static_cast<long>(bins.count);
  for (long shift = -count + 1; shift < count; ++shift) {
    const double shift_s = static_cast<double>(shift) * bins.width_s;
    if (std::abs(shift_s) <= kBy.most_shift_s) continue;
    if (const auto height = correlation(bodies, inputs, shift, least_bins)) all.push_back({shift_s, *height});
  }
  std::stable_sort(all.begin(), all.end(), [](const Peak& a, const Peak& b) { return a.height > b.height; });
  std::vector<Peak> peaks;
  for (const Peak& peak : all) {
    if (peaks.size() == kBy.most_peaks) break;
    const bool near = std::any_of(peaks.begin(), peaks.end(), [&](const Peak& p) {
      return std::abs(p.shift_s - peak.shift_s) < kBy.most_shift_s;
    });
    if (!near) peaks.push_back(peak);
  }
  return peaks;
}

/// What a fit to some samples explains of others.
double explained_of(const ClockProblem& problem, const Eigen::MatrixXd& a,
                    const std::vector<Eigen::Index>& fitted, const std::vector<Eigen::Index>& judged) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(a.cols(), a.cols());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(a.cols(), problem.y.cols());
  for (const Eigen::Index k : fitted) {
    normal.selfadjointView<Eigen::Lower>().rankUpdate(a.row(k).transpose());
    right += a.row(k).transpose() * problem.y.row(k);
  }
  normal = normal.selfadjointView<Eigen::Lower>();
  // What a piece hardly has it must not say much of.
  normal.diagonal().array() += kBy.ridge * (1e-12 + normal.diagonal().mean());
  const Eigen::MatrixXd x = math::SymmetricSolver(normal).solve_columns(right);
  double left = 0.0, all = 1e-300;
  for (const Eigen::Index k : judged) {
    left += (problem.y.row(k) - a.row(k) * x).squaredNorm();
    all += problem.y.row(k).squaredNorm();
  }
  return 1.0 - left / all;
}

struct Explained {
  double across =
      0.0;  ///< by a fit to one half of the recording's pieces of the other, the worse of both ways
  double within = 0.0;  ///< by a fit to all of it
};

Explained explained_at(const ClockProblem& problem, double shift_s) {
  const Eigen::MatrixXd a = regressors(problem, shift_s);
  const int blocks = static_cast<int>(kBy.piece_s / kBy.block_s);
  std::vector<Eigen::Index> halves[2], all;
  for (std::size_t k = 0; k < problem.block.size(); ++k) {
    all.push_back(static_cast<Eigen::Index>(k));
    halves[(problem.block[k] / blocks) % 2].push_back(all.back());
  }
  return {std::min(explained_of(problem, a, halves[0], halves[1]),
                   explained_of(problem, a, halves[1], halves[0])),
          explained_of(problem, a, all, all)};
}

struct Candidate {
  double shift_s = 0.0;
  double explained = -std::numeric_limits<double>::infinity();  ///< across the halves
  double within = 0.0;                                          ///< at most, at any of the shifts
};

/// The best shift within a second of a centre.
std::optional<Candidate> best_about(const Context& context, double centre_s, double step_s) {
  auto problem = clock_problem(context, centre_s, step_s);
  if (!problem || problem->block.back() + 1 < kBy.least_blocks) return std::nullopt;
  problem->with_plays = false;
  Candidate best;
  for (double shift = -kBy.most_shift_s; shift <= kBy.most_shift_s + 1e-9; shift += kBy.scan_s) {
    const Explained here = explained_at(*problem, shift);
    if (here.across > best.explained) {
      best.shift_s = centre_s + shift;
      best.explained = here.across;
    }
    best.within = std::max(best.within, here.within);
  }
  return best;
}

}  // namespace

std::optional<ClockSearch> clock_search(const Context& context) {
  const double step_s = std::max(kBy.sample_s, context.duration_s / kBy.most_samples);
  const auto near = best_about(context, 0.0, step_s);
  if (!near) return std::nullopt;
  ClockSearch found;
  found.as_stamped = near->explained;
  // A short recording may have too little in either half to predict the other. Where one answer to the inputs
  // as they are stamped fits all of it, that is no reason to look elsewhere.
  if (std::max(near->explained, near->within) >= kBy.explained_as_stamped) return found;
  std::vector<const Signal*> signals;
  for (const Signal& signal : context.signals) {
    if (drives(signal)) signals.push_back(&signal);
  }
  const Track* tip = outermost(context);
  const Bins bins = bins_of(0.0, context.duration_s);
  const double least_overlap_s = std::max(kBy.least_overlap_s, kBy.least_overlap * context.duration_s);
  std::vector<Candidate> candidates;
  for (const Peak& peak :
       peaks_of(activity_of(*tip, bins), activity_of(signals, bins), bins, least_overlap_s)) {
    const auto candidate = best_about(context, peak.shift_s, step_s);
    if (candidate && std::abs(candidate->shift_s) > kBy.most_shift_s) candidates.push_back(*candidate);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.explained > b.explained; });
  if (candidates.empty()) return found;
  const Candidate& best = candidates.front();
  const double left = 1.0 - best.explained;
  if (best.explained < kBy.explained_elsewhere || left > kBy.left_elsewhere * (1.0 - near->explained))
    return found;
  found.shift_s = best.shift_s;
  found.explained = best.explained;
  for (const Candidate& other : candidates) {
    if (std::abs(other.shift_s - best.shift_s) < kBy.apart_s || 1.0 - other.explained > kBy.as_good * left)
      continue;
    found.other_s = other.shift_s;
    found.other_explained = other.explained;
    break;
  }
  return found;
}

}  // namespace softarm::check
