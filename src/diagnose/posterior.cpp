#include "posterior.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "evidence.h"
#include "math/parallel.h"
#include "policy.h"
#include "resamples.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

constexpr double kLeastWeight = 1e-3;  // of a set against the best: what is less says nothing

/// The linearised model about each fit that there is: the present one, and one for each effect that was
/// refitted with it. A set of effects is judged about the fit that suits it best of those with one of its
/// effects.
class Expansions {
 public:
  Expansions(const EvidenceData& data, const std::vector<RefitEvidence>& refits, unsigned jobs)
      : bases_(bases_of(data, jobs)), models_(1 + refits.size()) {
    models_[0].emplace(data, bases_, jobs);
    for (std::size_t i = 0; i < refits.size(); ++i) {
      const bool own = !refits[i].data.effects.empty();
      models_[i + 1].emplace(refits[i].data, bases_, jobs, own ? nullptr : &*models_[0], refits[i].effect);
    }
    for (const RefitEvidence& r : refits) refitted_.push_back(r.effect);
    for (const Signature& s : data.effects) log_choices_[s.effect] = s.log_choices;
  }

  const EffectList& effects() const { return models_[0]->effects(); }
  /// Signature::log_choices of a set.
  double log_choices(const EffectList& set) const {
    double sum = 0.0;
    for (const Effect* effect : set) {
      const auto known = log_choices_.find(effect);
      if (known != log_choices_.end()) sum += known->second;
    }
    return sum;
  }

  /// By number: those about a fit with one of these effects; without any, the one about the present fit.
  std::vector<std::size_t> of(const EffectList& set) const {
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < refitted_.size(); ++i)
      if (std::find(set.begin(), set.end(), refitted_[i]) != set.end()) list.push_back(i + 1);
    if (list.empty()) list.push_back(0);
    return list;
  }
  const LinearGaussianModel& model(std::size_t number) const { return *models_[number]; }
  const Bases& bases() const { return bases_; }
  std::size_t count() const { return models_.size(); }
  /// Those of a set that such a model does not have among its unknowns.
  EffectList beside(std::size_t number, EffectList set) const {
    if (number > 0) set.erase(std::remove(set.begin(), set.end(), refitted_[number - 1]), set.end());
    return set;
  }

 private:
  const Bases bases_;
  std::vector<std::optional<LinearGaussianModel>> models_;
  EffectList refitted_;
  std::map<const Effect*, double> log_choices_;
};

/// Effects that would move the bodies by what matters, beyond what the constants absorb, at the largest sizes
/// that are expected. The others are what the constants are: only the priors could tell them from these.
EffectList distinguishable(const EvidenceData& data) {
  EffectList list;
  for (const Signature& s : data.effects) {
    if (s.left * s.prior_sd > kPolicy.selection.trivial && (list.empty() || list.back() != s.effect))
      list.push_back(s.effect);
  }
  return list;
}

/// Sets that were evaluated, each under the backgrounds that suit it.
class Search {
 public:
  /// @param candidates for the sets
  Search(const Expansions& about, EffectList candidates, unsigned jobs)
      : about_(about),
        candidates_(std::move(candidates)),
        jobs_(jobs),
        log_odds_(std::log(kPolicy.posterior.expected / static_cast<double>(about.effects().size()))) {}

  struct Model {
    EffectList effects;
    double background = 0.0, log = 0.0;  ///< log: with the odds of its effects
    Marginal marginal;
    std::size_t about = 0;     ///< which fit, by Expansions' number
    double probability = 0.0;  ///< averaged over resamples of the trials
  };

  /// Evaluates these sets in parallel, from a noise near theirs.
  void evaluate(std::vector<Model> list, const std::vector<DirectionNoise>& noise) {
    std::vector<Evaluated> each;                          // about each fit that may suit it
    std::vector<std::pair<std::size_t, std::size_t>> of;  // place in the list, and number of the fit
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i].marginal.log = kNothing;
      for (const std::size_t number : about_.of(list[i].effects)) {
        each.push_back({&about_.model(number), about_.beside(number, list[i].effects), list[i].background});
        of.emplace_back(i, number);
      }
    }
    diagnose::evaluate(each, noise, jobs_);
    for (std::size_t e = 0; e < each.size(); ++e) {
      Model& m = list[of[e].first];
      if (!(each[e].marginal.log > m.marginal.log)) continue;
      m.marginal = std::move(each[e].marginal);
      m.about = of[e].second;
    }
    for (Model& m : list) {
      m.log = m.marginal.log + before_data(m.effects);
      if (m.marginal.log > kNothing) models_.push_back(std::move(m));
    }
  }

  /// What one effect more would bring to a model, under its own noise.
  std::vector<Model> one_more(const Model& from) const {
    std::vector<NormalEquations> sums(about_.count());
    math::in_parallel(sums.size(), jobs_, [&](std::size_t i) {
      const LinearGaussianModel& model = about_.model(i);
      sums[i] = model.over_effects(model.normal_equations(from.marginal.noise));
    });
    std::vector<EffectList> sets;
    for (const Effect* effect : candidates_) {
      if (std::find(from.effects.begin(), from.effects.end(), effect) != from.effects.end()) continue;
      sets.push_back(from.effects);
      sets.back().push_back(effect);
      std::sort(sets.back().begin(), sets.back().end(),
                [this](const Effect* a, const Effect* b) { return place(a) < place(b); });
    }
    constexpr std::size_t kBackgrounds = std::size(kPolicy.posterior.background);
    std::vector<Model> list(sets.size() * kBackgrounds);
    math::in_parallel(sets.size(), jobs_, [&](std::size_t i) {
      for (std::size_t b = 0; b < kBackgrounds; ++b) {
        const double background = kPolicy.posterior.background[b];
        double log = kNothing;
        for (const std::size_t number : about_.of(sets[i]))
          log = std::max(log, about_.model(number).integrate_effects(
                                  sums[number], about_.beside(number, sets[i]), background));
        list[i * kBackgrounds + b] = {sets[i], background, log + before_data(sets[i]), {}, 0, 0.0};
      }
    });
    return list;
  }

  const std::vector<Model>& models() const { return models_; }
  /// How probable each is.
  /// @param unit of each instant
  void weigh(const std::vector<std::size_t>& unit) {
    const auto count = static_cast<Eigen::Index>(models_.size());
    Eigen::VectorXd log(count);
    Eigen::MatrixXd by_unit = Eigen::MatrixXd::Zero(
        static_cast<Eigen::Index>(1 + *std::max_element(unit.begin(), unit.end())), count);
    math::in_parallel(models_.size(), jobs_, [&](std::size_t i) {
      const Model& m = models_[i];
      const auto column = static_cast<Eigen::Index>(i);
      log[column] = m.log;
      const Eigen::VectorXd by_instant = about_.model(m.about).log_by_instant(m.marginal, about_.bases());
      for (std::size_t k = 0; k < unit.size(); ++k)
        by_unit(static_cast<Eigen::Index>(unit[k]), column) += by_instant[static_cast<Eigen::Index>(k)];
    });
    const Eigen::VectorXd probability = averaged_over_resamples(log, by_unit);
    for (std::size_t i = 0; i < models_.size(); ++i)
      models_[i].probability = probability[static_cast<Eigen::Index>(i)];
  }
  bool has(const Model& m) const {
    return std::any_of(models_.begin(), models_.end(), [&](const Model& o) {
      return o.effects == m.effects && o.background == m.background;
    });
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
  /// What the integral does not know: the odds of the effects, each of the one chamber or body of many.
  double before_data(const EffectList& effects) const {
    double count = 0.0;
    for (const Effect* effect : effects) count += counts_as(*effect);
    return log_odds_ * count - about_.log_choices(effects);
  }
  std::ptrdiff_t place(const Effect* effect) const {
    return std::find(about_.effects().begin(), about_.effects().end(), effect) - about_.effects().begin();
  }

  static constexpr double kNothing = -1e300;  // a log likelihood
  const Expansions& about_;
  const EffectList candidates_;
  const unsigned jobs_;
  const double log_odds_;
  std::vector<Model> models_;
};

Posterior summed(const std::vector<Search::Model>& models) {
  Posterior result;
  for (const Search::Model& m : models) {
    result.background += m.probability * m.background;
    const auto same = std::find_if(result.sets.begin(), result.sets.end(),
                                   [&](const EffectSet& s) { return s.effects == m.effects; });
    if (same == result.sets.end())
      result.sets.push_back({m.effects, m.probability});
    else
      same->probability += m.probability;
  }
  std::stable_sort(result.sets.begin(), result.sets.end(),
                   [](const EffectSet& a, const EffectSet& b) { return a.probability > b.probability; });
  return result;
}

/// Of a mixture of normals with these weights.
class Mixture {
 public:
  explicit Mixture(Eigen::Index n) : mean_(Eigen::VectorXd::Zero(n)), square_(Eigen::MatrixXd::Zero(n, n)) {}
  void add(double weight, const Gaussian& part) {
    mean_ += weight * part.mean;
    square_ += weight * (part.covariance + part.mean * part.mean.transpose());
    weight_ += weight;
  }
  Gaussian sum() const {
    if (!(weight_ > 0.0)) return {};
    const Eigen::VectorXd mean = mean_ / weight_;
    return {mean, square_ / weight_ - mean * mean.transpose()};
  }

 private:
  Eigen::VectorXd mean_;
  Eigen::MatrixXd square_;
  double weight_ = 0.0;
};

/// What a set about the present fit says of its unknowns.
struct OfUnknowns {
  double weight = 0.0;
  Gaussian all;
  std::vector<Gaussian> on_its_law;
};

OfUnknowns of_unknowns(const LinearGaussianModel& about, const Search::Model& m, const EvidenceData& data) {
  const auto unknowns = static_cast<Eigen::Index>(data.unknowns.size());
  const auto first = [unknowns](const Gaussian& g) {
    return Gaussian{g.mean.head(unknowns), g.covariance.topLeftCorner(unknowns, unknowns)};
  };
  const Gaussian all = about.estimate(about.normal_equations(m.marginal.noise), m.effects, m.background);
  OfUnknowns of;
  of.all = first(all);
  for (std::size_t e = 0; e < data.done.size(); ++e) of.on_its_law.push_back(first(about.on_its_law(all, e)));
  return of;
}

/// What the sets about the present fit say of its unknowns, each as probable as it is.
void add_unknowns(const Expansions& about, const std::vector<Search::Model>& models, const EvidenceData& data,
                  unsigned jobs, Posterior& result) {
  const auto is_about_the_fit = [&](const Search::Model& m) { return about.of(m.effects).front() == 0; };
  double best = 0.0, best_log = -std::numeric_limits<double>::infinity();
  for (const Search::Model& m : models) {
    if (!is_about_the_fit(m)) continue;
    best = std::max(best, m.probability);
    best_log = std::max(best_log, m.log);
  }
  // Beside a refit that is far more probable all of them may be less than a double can say: then by their
  // evidence itself.
  const bool said = best >= std::numeric_limits<double>::min();
  std::vector<OfUnknowns> list(models.size());
  math::in_parallel(models.size(), jobs, [&](std::size_t i) {
    const Search::Model& m = models[i];
    if (!is_about_the_fit(m)) return;
    const double weight = said ? m.probability / best : std::exp(m.log - best_log);
    if (!(weight > kLeastWeight)) return;
    list[i] = of_unknowns(about.model(0), m, data);
    list[i].weight = weight;
  });
  const auto unknowns = static_cast<Eigen::Index>(data.unknowns.size());
  Mixture all(unknowns);
  std::vector<Mixture> on_its_law(data.done.size(), Mixture(unknowns));
  for (const OfUnknowns& of : list) {
    if (!(of.weight > 0.0)) continue;
    all.add(of.weight, of.all);
    for (std::size_t e = 0; e < on_its_law.size(); ++e) on_its_law[e].add(of.weight, of.on_its_law[e]);
  }
  result.unknowns = all.sum();
  for (const Mixture& one : on_its_law) result.on_its_law.push_back(one.sum());
}

bool holds(const EffectSet& set, const Effect* effect) {
  return std::find(set.effects.begin(), set.effects.end(), effect) != set.effects.end();
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
  const Expansions about(data, refits, jobs);
  Search search(about, distinguishable(data), jobs);
  std::vector<Search::Model> none;
  for (const double background : kPolicy.posterior.background)
    none.push_back({{}, background, 0.0, {}, 0, 0.0});
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
  if (search.models().empty()) return {};
  search.weigh(resampled_units(data.trial));
  Posterior result = summed(search.models());
  add_unknowns(about, search.models(), data, jobs, result);
  return result;
}

}  // namespace softarm::diagnose
