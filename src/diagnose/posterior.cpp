#include "posterior.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "evidence.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

/// Sets that were evaluated, each under the backgrounds that suit it.
class Search {
 public:
  using Corrections = std::map<const Effect*, double>;
  /// @param corrections of the log evidence, by effect
  Search(const LinearGaussianModel& all, Corrections corrections, unsigned jobs)
      : all_(all),
        corrections_(std::move(corrections)),
        jobs_(jobs),
        log_odds_(std::log(kPolicy.posterior.expected / static_cast<double>(all.effects().size()))) {}

  struct Model {
    EffectList effects;
    double tau = 0.0, log = 0.0;  ///< log: with the odds of its effects
    Marginal marginal;
  };

  /// Evaluates these sets in parallel, from a noise near theirs.
  void evaluate(std::vector<Model> list, const std::vector<DirectionNoise>& noise) {
    math::in_parallel(list.size(), jobs_, [&](std::size_t i) {
      list[i].marginal = all_.evaluate(list[i].effects, list[i].tau, noise);
      list[i].log = list[i].marginal.log + before_data(list[i].effects);
    });
    for (Model& model : list) models_.push_back(std::move(model));
  }

  /// What one effect more would bring to a model, under its own noise.
  std::vector<Model> one_more(const Model& from) const {
    const NormalEquations sums = all_.normal_equations(from.marginal.noise);
    std::vector<Model> list;
    Eigen::VectorXd unused;
    for (const Effect* effect : all_.effects()) {
      if (std::find(from.effects.begin(), from.effects.end(), effect) != from.effects.end()) continue;
      EffectList effects = from.effects;
      effects.push_back(effect);
      std::sort(effects.begin(), effects.end(),
                [this](const Effect* a, const Effect* b) { return place(a) < place(b); });
      for (const double tau : kPolicy.posterior.background)
        list.push_back({effects, tau, all_.integrate(sums, effects, tau, unused) + before_data(effects), {}});
    }
    return list;
  }

  const std::vector<Model>& models() const { return models_; }
  bool has(const Model& m) const {
    return std::any_of(models_.begin(), models_.end(),
                       [&](const Model& o) { return o.effects == m.effects && o.tau == m.tau; });
  }
  /// The best models of so many effects, each set once.
  std::vector<Model> best(std::size_t effects, std::size_t count) const {
    std::vector<Model> list;
    for (const Model& m : models_)
      if (m.effects.size() == effects) list.push_back(m);
    return each_once(std::move(list), count);
  }
  static std::vector<Model> each_once(std::vector<Model> list, std::size_t count) {
    std::stable_sort(list.begin(), list.end(), [](const Model& a, const Model& b) { return a.log > b.log; });
    std::vector<Model> out;
    for (Model& m : list) {
      const auto same = [&](const Model& o) { return o.effects == m.effects; };
      if (out.size() < count && std::none_of(out.begin(), out.end(), same)) out.push_back(std::move(m));
    }
    return out;
  }

 private:
  /// What the integral does not know: the odds of the effects, and what refits showed of them.
  double before_data(const EffectList& effects) const {
    double sum = log_odds_ * static_cast<double>(effects.size());
    for (const Effect* effect : effects) {
      const auto found = corrections_.find(effect);
      if (found != corrections_.end()) sum += found->second;
    }
    return sum;
  }
  std::ptrdiff_t place(const Effect* effect) const {
    return std::find(all_.effects().begin(), all_.effects().end(), effect) - all_.effects().begin();
  }

  const LinearGaussianModel& all_;
  const Corrections corrections_;
  const unsigned jobs_;
  const double log_odds_;
  std::vector<Model> models_;
};

Posterior summed(const std::vector<Search::Model>& models) {
  double best = -1e300;
  for (const Search::Model& m : models) best = std::max(best, m.log);
  Posterior result;
  double sum = 0.0;
  for (const Search::Model& m : models) {
    const double weight = std::exp(m.log - best);
    sum += weight;
    const auto same = std::find_if(result.sets.begin(), result.sets.end(),
                                   [&](const EffectSet& s) { return s.effects == m.effects; });
    if (same == result.sets.end())
      result.sets.push_back({m.effects, weight});
    else
      same->probability += weight;
  }
  for (EffectSet& set : result.sets) set.probability /= sum;
  std::stable_sort(result.sets.begin(), result.sets.end(),
                   [](const EffectSet& a, const EffectSet& b) { return a.probability > b.probability; });
  return result;
}

bool holds(const EffectSet& set, const Effect* effect) {
  return std::find(set.effects.begin(), set.effects.end(), effect) != set.effects.end();
}

/// Log evidence of a model under the background that suits it best.
double best_evidence(const LinearGaussianModel& all, const EffectList& present) {
  double best = -1e300;
  for (const double tau : kPolicy.posterior.background) best = std::max(best, all.evaluate(present, tau).log);
  return best;
}

/// By which the evidence of each refitted effect alone, about its own fit, is more than the linear one.
Search::Corrections corrections_of(const EvidenceData& data, const LinearGaussianModel& all,
                                   const Bases& bases, const std::vector<RefitEvidence>& refits,
                                   unsigned jobs) {
  std::vector<double> more(refits.size(), 0.0);
  math::in_parallel(refits.size(), jobs, [&](std::size_t i) {
    EvidenceData own = refits[i].data;
    for (const Signature& s : data.effects)
      if (s.effect != refits[i].effect) own.effects.push_back(s);
    more[i] = best_evidence(LinearGaussianModel(own, bases), {}) - best_evidence(all, {refits[i].effect});
  });
  Search::Corrections corrections;
  for (std::size_t i = 0; i < refits.size(); ++i) corrections[refits[i].effect] = more[i];
  return corrections;
}

}  // namespace

double Posterior::of(const Effect* effect) const {
  return of_any({effect});
}

double Posterior::of_any(const EffectList& effects) const {
  double sum = 0.0;
  for (const EffectSet& set : sets) {
    if (std::any_of(effects.begin(), effects.end(), [&](const Effect* e) { return holds(set, e); }))
      sum += set.probability;
  }
  return sum;
}

double Posterior::instead(const Effect* other, const Effect* effect) const {
  double sum = 0.0;
  for (const EffectSet& set : sets)
    if (holds(set, other) && !holds(set, effect)) sum += set.probability;
  return sum;
}

Posterior posterior(const EvidenceData& data, const std::vector<RefitEvidence>& refits, unsigned jobs) {
  if (data.residual.rows() < kPolicy.posterior.fewest_instants || data.effects.empty()) return {};
  const Bases bases = bases_of(data);
  const LinearGaussianModel all(data, bases);
  Search search(all, corrections_of(data, all, bases, refits, jobs), jobs);
  std::vector<Search::Model> none;
  for (const double tau : kPolicy.posterior.background) none.push_back({{}, tau, 0.0, {}});
  search.evaluate(std::move(none), {});
  for (std::size_t size = 0; size < kPolicy.posterior.most_effects; ++size) {
    for (const Search::Model& from : search.best(size, size == 0 ? 1 : kPolicy.posterior.grown_from)) {
      std::vector<Search::Model> more = search.one_more(from);
      std::vector<Search::Model> leaders;
      for (const Search::Model& leader : Search::each_once(more, kPolicy.posterior.leaders)) {
        // Under the background that suits it, and those beside.
        for (const Search::Model& m : more) {
          if (m.effects == leader.effects && m.log > leader.log - kPolicy.posterior.beside && !search.has(m))
            leaders.push_back(m);
        }
      }
      search.evaluate(std::move(leaders), from.marginal.noise);
    }
  }
  return summed(search.models());
}

}  // namespace softarm::diagnose
