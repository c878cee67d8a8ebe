// The baselines that look at residuals alone: of fits frame by frame, and by a flexible model.
#include <algorithm>
#include <cmath>
#include <utility>

#include "deciders.h"
#include "diagnose/flexible.h"
#include "diagnose/policy.h"
#include "signal.h"

namespace softarm::prove {

using diagnose::JointModel;
using diagnose::kPolicy;
using diagnose::Linearised;
using diagnose::Refitted;
using diagnose::Screened;
using diagnose::Standing;
using diagnose::TimeStretch;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

VectorXd stacked(const std::vector<VectorXd>& parts) {
  Index rows = 0;
  for (const VectorXd& part : parts) rows += part.size();
  VectorXd all(rows);
  rows = 0;
  for (const VectorXd& part : parts) {
    all.segment(rows, part.size()) = part;
    rows += part.size();
  }
  return all;
}

/// The number of the stretch that each of the stacked rows belongs to.
std::vector<Index> stretch_of_rows(const Linearised& at) {
  std::vector<Index> of;
  for (std::size_t t = 0; t < at.residual.size(); ++t) {
    for (const bool bodies : {true, false})
      for (std::size_t c = 0; c < at.stretches.size(); ++c)
        if (at.stretches[c].trial == t)
          of.insert(
              of.end(),
              static_cast<std::size_t>(bodies ? at.stretches[c].all_rows : at.stretches[c].tangent_rows),
              static_cast<Index>(c));
  }
  return of;
}

/// Square of a signature's size over its standard deviation: by the residuals' own spread, those of one
/// stretch being correlated.
double square_of_z(const VectorXd& signature, const VectorXd& left, double freedom,
                   const std::vector<Index>& stretch, Index stretches) {
  const double own = signature.squaredNorm();
  if (!(own > 1e-18)) return 0.0;
  const double size = signature.dot(left) / own;
  const VectorXd rest = left - size * signature;
  VectorXd sums = VectorXd::Zero(stretches);
  for (Index i = 0; i < rest.size(); ++i)
    sums[stretch[static_cast<std::size_t>(i)]] += signature[i] * rest[i];
  const double misfit = std::max(1.0, rest.squaredNorm() / std::max(1.0, freedom));
  return size * size * own * own / std::max(sums.squaredNorm(), misfit * own);
}

/// Mean square of what is not known of the motion, by the weights of the fit.
double motion_m2(const JointModel& model) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      if (!model.uses(t, k)) continue;
      for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
        const double w = 1.0 / std::pow(model.sd_m(t, k, seen), 2);
        sum += 3.0 * w * std::pow(model.motion_sd_m(t, k), 2);
        weight += w;
      }
    }
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

/// Whether the fit to all trials with an effect is better than without, by a size that matters.
bool is_supported(JointModel& model, const Look& look, const model::Effect* effect) {
  const Refitted* known = refit_of(look, effect);
  const Linearised fit = known != nullptr ? known->fit : refit_with(model, look, {effect});
  return weighed(model, look, fit).bic < look.bic->none().bic &&
         diagnose::moved_m(look.standing.unseen, diagnose::unseen(model, fit)) >= diagnose::trivial_m(model);
}

}  // namespace

Decision per_frame(JointModel& model, const Look& first) {
  begin_at(model, first.standing.fit);
  Decision decision;
  decision.method = "per_frame";
  decision.ranking = ranking_of(first, {});
  if (!first.bic) return decision;
  const Linearised& at = first.standing.fit;
  double freedom = 0.0;
  const VectorXd left = per_frame_part(model, at, stacked(at.residual), &freedom);
  const std::vector<Index> stretch = stretch_of_rows(at);
  std::vector<Weighed> models(1);
  for (const Screened& s : first.round.screened) {
    const VectorXd signature = per_frame_part(model, at, s.direction, nullptr);
    models.emplace_back();
    models.back().effects = {s.effect};
    models.back().bic =
        price(first.bic->data(), {s.effect}) -
        square_of_z(signature, left, freedom, stretch, static_cast<Index>(at.stretches.size()));
  }
  const diagnose::Posterior posterior = weights(models);
  decision.ranking = ranking_of(first, posterior);
  const diagnose::EffectList& best = posterior.sets.front().effects;
  if (!best.empty() && is_supported(model, first, best.front()))
    decision.effects.push_back(
        {best.front()->info().id, posterior.of(best.front()), instead_of(first, posterior, best.front())});
  decision.alarm = !decision.effects.empty() ||
                   left.squaredNorm() > kPolicy.verdict.as_noise_chi2 * std::max(1.0, freedom);
  return decision;
}

Decision flexible(const JointModel& model, const Look& first, unsigned jobs) {
  Decision decision;
  decision.method = "gp";
  const diagnose::Unseen& unseen = first.standing.unseen;
  const double share = diagnose::ceiling(model, first.standing.fit, unseen.residual, jobs);
  const double learnt_m2 = unseen.total_rms_m * unseen.total_rms_m * share - motion_m2(model);
  const double least_m = kPolicy.verdict.flexible * model.arm().total_length_m();
  const bool learns = share >= kPolicy.verdict.flexible_share && learnt_m2 >= least_m * least_m;
  const int rows = std::max(1, first.standing.fit.rows);
  decision.alarm = learns || unseen.total_chi2 >= kPolicy.verdict.as_noise_chi2 * rows;
  return decision;
}

}  // namespace softarm::prove
