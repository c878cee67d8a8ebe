#include "sequences.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kStep_s = 0.1;        // of the time at which inputs are compared
constexpr double kLeastSpread = 0.02;  // of an input's range: inputs that rest have none
constexpr Index kMostShifts = 600;     // tried of one pair, evenly over those that there are

/// Inputs at equal times, one row each.
MatrixXd sampled(const model::Series& series) {
  const Index frames = series.t_s.size(), inputs = series.inputs.rows();
  if (frames == 0) return MatrixXd(inputs, 0);
  const double begin_s = series.t_s[0];
  const auto count = static_cast<Index>(std::floor((series.t_s[frames - 1] - begin_s) / kStep_s)) + 1;
  MatrixXd out(inputs, count);
  Index after = 0;
  for (Index i = 0; i < count; ++i) {
    const double t_s = begin_s + kStep_s * static_cast<double>(i);
    while (after + 1 < frames && series.t_s[after] < t_s) ++after;
    const Index before = std::max<Index>(0, after - 1);
    const double span_s = series.t_s[after] - series.t_s[before];
    const double share = span_s > 0.0 ? std::clamp((t_s - series.t_s[before]) / span_s, 0.0, 1.0) : 0.0;
    out.col(i) = (1.0 - share) * series.inputs.col(before) + share * series.inputs.col(after);
  }
  return out;
}

/// As shares of what each input ranges over in all trials; those that never change drop out.
void scale(std::vector<MatrixXd>& trials) {
  const Index inputs = trials.empty() ? 0 : trials.front().rows();
  for (Index r = 0; r < inputs; ++r) {
    double low = 1e300, high = -1e300;
    for (const MatrixXd& one : trials) {
      if (one.cols() == 0) continue;
      low = std::min(low, one.row(r).minCoeff());
      high = std::max(high, one.row(r).maxCoeff());
    }
    const double range = high > low ? high - low : 1e300;
    for (MatrixXd& one : trials) one.row(r).array() = (one.row(r).array() - low) / range;
  }
}

double mean_variance(const MatrixXd& part) {
  return (part.colwise() - part.rowwise().mean()).squaredNorm() / static_cast<double>(part.size());
}

/// Whether a stretch of one trial is the other one over again, or the other way round.
bool same_commands(const MatrixXd& a, const MatrixXd& b) {
  if (a.cols() == 0 || b.cols() == 0 || a.rows() == 0) return a.cols() == b.cols();
  const MatrixXd &brief = a.cols() <= b.cols() ? a : b, &lasting = a.cols() <= b.cols() ? b : a;
  const Index least = std::max<Index>(
      1, static_cast<Index>(std::ceil(kPolicy.sequences.overlap * static_cast<double>(brief.cols()))));
  const Index first = least - brief.cols(), last = lasting.cols() - least;
  const Index stride = 1 + (last - first) / kMostShifts;
  for (Index shift = first; shift <= last; shift += stride) {
    const Index from = std::max<Index>(0, shift);
    const Index count = std::min(lasting.cols(), shift + brief.cols()) - from;
    const auto one = brief.middleCols(from - shift, count), other = lasting.middleCols(from, count);
    const double spread2 =
        std::max(0.5 * (mean_variance(one) + mean_variance(other)), kLeastSpread * kLeastSpread);
    const double off2 = (one - other).squaredNorm() / static_cast<double>(one.size());
    if (off2 < kPolicy.sequences.same * kPolicy.sequences.same * spread2) return true;
  }
  return false;
}

}  // namespace

std::vector<std::size_t> sequences_of(const std::vector<model::TrialData>& trials) {
  std::vector<MatrixXd> inputs;
  for (const model::TrialData& trial : trials) inputs.push_back(sampled(trial.series));
  scale(inputs);
  std::vector<std::size_t> sequence, first;  // of each sequence its first trial
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const auto same = std::find_if(first.begin(), first.end(), [&](std::size_t other) {
      return same_commands(inputs[other], inputs[t]);
    });
    sequence.push_back(static_cast<std::size_t>(same - first.begin()));
    if (same == first.end()) first.push_back(t);
  }
  return sequence;
}

std::vector<std::vector<std::size_t>> folds_of(const std::vector<std::size_t>& sequences,
                                               const std::vector<std::size_t>& trials, std::size_t most) {
  std::map<std::size_t, std::vector<std::size_t>> by_sequence;
  for (const std::size_t t : trials) by_sequence[sequences[t]].push_back(t);
  std::vector<std::vector<std::size_t>> members;
  for (auto& [sequence, list] : by_sequence) members.push_back(std::move(list));
  if (members.size() == 1) {
    members.clear();
    for (const std::size_t t : trials) members.push_back({t});
  }
  // The large ones first, each to the fold that has least.
  std::stable_sort(members.begin(), members.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<std::vector<std::size_t>> folds(std::min(most, members.size()));
  for (const std::vector<std::size_t>& sequence : members) {
    auto& fold = *std::min_element(folds.begin(), folds.end(),
                                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
    fold.insert(fold.end(), sequence.begin(), sequence.end());
  }
  for (std::vector<std::size_t>& fold : folds) std::sort(fold.begin(), fold.end());
  return folds;
}

}  // namespace softarm::diagnose
