#include "deciders.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnose/flexible.h"
#include "diagnose/screen.h"
#include "diagnose/unseen.h"
#include "signal.h"

namespace softarm::prove {
namespace {

using diagnose::JointModel;
using diagnose::Linearised;
using diagnose::Screened;
using Eigen::VectorXd;

constexpr double kPerFrameSd = 3.0;   // of the chi^2 of fits frame by frame
constexpr double kLeftover_m = 1e-4;  // as the diagnosis has it for "unknown"
constexpr double kLeftoverShare = 0.1;

VectorXd stacked(const std::vector<VectorXd>& parts) {
  Eigen::Index rows = 0;
  for (const VectorXd& part : parts) rows += part.size();
  VectorXd all(rows);
  rows = 0;
  for (const VectorXd& part : parts) {
    all.segment(rows, part.size()) = part;
    rows += part.size();
  }
  return all;
}

/// Residuals of fits frame by frame, and that effect whose signature in such residuals is most like them.
Decision per_frame(const JointModel& model, const Linearised& at, const std::vector<Screened>& screened) {
  Decision decision;
  decision.method = "per_frame";
  double freedom = 0.0;
  const VectorXd left = per_frame_part(model, at, stacked(at.residual), &freedom);
  decision.alarm = left.squaredNorm() > freedom + kPerFrameSd * std::sqrt(2.0 * freedom);
  std::vector<std::pair<double, std::string>> order;
  for (const Screened& s : screened) {
    const VectorXd signature = per_frame_part(model, at, s.direction, nullptr);
    const double norm = signature.norm();
    order.emplace_back(norm > 1e-9 ? std::abs(signature.dot(left)) / norm : 0.0, s.effect->info().id);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [size, name] : order) decision.ranking.push_back(name);
  if (decision.alarm && !order.empty()) decision.effects.push_back({decision.ranking.front(), std::nullopt});
  return decision;
}

Candidates candidates_of(const Linearised& at, const std::vector<Screened>& screened) {
  Candidates list;
  const VectorXd residual = stacked(at.residual);
  std::vector<const Screened*> usable;
  for (const Screened& s : screened)
    if (s.direction.norm() > 0.5) usable.push_back(&s);
  const auto n = static_cast<Eigen::Index>(usable.size());
  list.gram.resize(n, n);
  list.score.resize(n);
  list.numbers.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Screened& s = *usable[static_cast<std::size_t>(i)];
    list.names.push_back(s.effect->info().id);
    list.score[i] = s.direction.dot(residual);
    list.numbers[i] = static_cast<int>(s.effect->info().parameters.size());
    for (Eigen::Index j = 0; j <= i; ++j)
      list.gram(i, j) = list.gram(j, i) = s.direction.dot(usable[static_cast<std::size_t>(j)]->direction);
  }
  list.rows = at.rows;
  return list;
}

/// A Gaussian process alone: there is something, or there is not.
Decision flexible(const JointModel& model, const Linearised& at, unsigned jobs) {
  Decision decision;
  decision.method = "gp";
  const diagnose::Unseen unseen = diagnose::unseen(model, at);
  const diagnose::Ceiling ceiling = diagnose::ceiling(model, at, unseen.residual, jobs);
  decision.alarm =
      unseen.total_rms_m * std::sqrt(ceiling.share) >= kLeftover_m && ceiling.share >= kLeftoverShare;
  return decision;
}

}  // namespace

std::vector<Decision> decide(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
                             const std::vector<std::string>& held, const std::vector<std::string>& tied) {
  const model::Prepared prepared = model::prepare(arm, trials);
  JointModel model(arm, prepared.trials, jobs, held, tied);
  Linearised at = model.fit(model.start(), {});
  model.allow_for_motion(at.at, at.predicted);
  at = model.fit(at.at, {}, &at.predicted);
  const std::vector<Screened> screened = diagnose::screen(model, at, jobs, [](double) {});
  const Candidates candidates = candidates_of(at, screened);
  return {per_frame(model, at, screened), bic_stepwise(candidates), lasso(candidates),
          flexible(model, at, jobs)};
}

}  // namespace softarm::prove
