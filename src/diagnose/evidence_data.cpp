#include "evidence_data.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "flexible.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kLeastStep = 0.05;  // of a usual size, of a difference: effects are linear there

/// Where an instant's numbers stand in its trial's vectors.
struct InstantRows {
  std::size_t trial = 0, block = 0;
  Index bodies = 0, tangents = 0;
};

/// What the instants show that show most, in groups of neighbours. A group's rows are the sums of its
/// instants' over the root of their number: all information on what is slow, at the noise of one.
struct Shown {
  std::vector<InstantRows> instants;
  std::vector<Index> group;        ///< of each instant
  Eigen::VectorXd size;            ///< of each group
  Index bodies = 0, tangents = 0;  ///< numbers, three each

  double weight(std::size_t instant) const { return 1.0 / std::sqrt(size[group[instant]]); }
};

Shown whole_instants(const JointModel& model, const Linearised& at) {
  Shown shown;
  const auto counts = [&](std::size_t t, std::size_t k) {
    return model.uses(t, k) && at.predicted[t][k].solved;
  };
  const auto numbers = [](const auto& seen) { return 3 * static_cast<Index>(seen.size()); };
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const std::vector<model::Block>& blocks = model.trials()[t].blocks;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (!counts(t, k)) continue;
      shown.bodies = std::max(shown.bodies, numbers(blocks[k].bodies));
      shown.tangents = std::max(shown.tangents, numbers(blocks[k].tangents));
    }
  }
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const std::vector<model::Block>& blocks = model.trials()[t].blocks;
    InstantRows now{t, 0, 0, 0};
    for (const model::Block& block : blocks) now.tangents += numbers(block.bodies);
    for (; now.block < blocks.size(); ++now.block) {
      const Index bodies = numbers(blocks[now.block].bodies), tangents = numbers(blocks[now.block].tangents);
      if (counts(t, now.block) && bodies == shown.bodies && tangents == shown.tangents)
        shown.instants.push_back(now);
      now.bodies += bodies;
      now.tangents += tangents;
    }
  }
  const std::size_t most =
      (shown.instants.size() + kPolicy.posterior.most_instants - 1) / kPolicy.posterior.most_instants;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < shown.instants.size(); ++i) {
    if (i == 0 || shown.instants[i].trial != shown.instants[i - 1].trial ||
        sizes.back() >= static_cast<double>(most))
      sizes.push_back(0.0);
    sizes.back() += 1.0;
    shown.group.push_back(static_cast<Index>(sizes.size()) - 1);
  }
  shown.size = Eigen::Map<const Eigen::VectorXd>(sizes.data(), static_cast<Index>(sizes.size()));
  return shown;
}

MatrixXd features_at(const JointModel& model, const Linearised& at, const Shown& shown) {
  const Features known = features(model, at);
  MatrixXd values = MatrixXd::Zero(shown.size.size(), known.values.cols());
  std::size_t f = 0;
  for (std::size_t i = 0; i < shown.instants.size(); ++i) {
    const InstantRows& now = shown.instants[i];
    while (f < known.trial.size() && (known.trial[f] != now.trial || known.block[f] != now.block)) ++f;
    if (f < known.trial.size())
      values.row(shown.group[i]) += known.values.row(static_cast<Index>(f)) / shown.size[shown.group[i]];
  }
  return in_spreads(std::move(values));
}

/// A column of a fit, that moves nothing yet.
/// @param at_end how far inside its range it may be, where the trials draw it beyond an end; 0: they do not.
/// What is possible there is a slice of what was beforehand, as wide as the likelihood falls off from the
/// end.
Signature unknown(const JointUnknown& column, double x, double at_end, Index n, Index m) {
  Signature s{nullptr, column.start - x, column.prior_sd, MatrixXd::Zero(n, m)};
  if (!(at_end > 0.0)) return s;
  s.log_weight =
      std::log(at_end / (std::sqrt(2.0 * M_PI) * s.prior_sd)) - 0.5 * std::pow(s.mean / s.prior_sd, 2);
  s.mean = 0.0;
  s.prior_sd = std::min(s.prior_sd, at_end);
  return s;
}

/// Of what moves that which is seen: how far unknowns of a fit absorb it, within their priors.
class Absorbing {
 public:
  /// @param rows of what is seen, n x m of them
  Absorbing(const std::vector<const Signature*>& unknowns, Index rows)
      : columns_(rows, static_cast<Index>(unknowns.size())), solver_(information(unknowns)) {}

  /// What is left of n x m moves, one column below the other.
  Eigen::VectorXd left_of(const MatrixXd& moves) const {
    const Eigen::Map<const Eigen::VectorXd> all(moves.data(), moves.size());
    return all - columns_ * solver_.solve(columns_.transpose() * all);
  }

 private:
  MatrixXd information(const std::vector<const Signature*>& unknowns) {
    Eigen::VectorXd precision(columns_.cols());
    for (Index c = 0; c < columns_.cols(); ++c) {
      const Signature& s = *unknowns[static_cast<std::size_t>(c)];
      columns_.col(c) = Eigen::Map<const Eigen::VectorXd>(s.moves.data(), s.moves.size());
      precision[c] = 1.0 / (s.prior_sd * s.prior_sd);
    }
    MatrixXd sums = columns_.transpose() * columns_;
    sums.diagonal() += precision;
    return sums;
  }

  MatrixXd columns_;
  const math::SymmetricSolver solver_;
};

/// Unknowns of a fit but for those of one of its effects.
std::vector<const Signature*> unknowns_but_for(const Linearised& at, const EvidenceData& data,
                                               std::size_t effect) {
  std::vector<const Signature*> list;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const JointUnknown& c = at.columns[j];
    if (c.kind != JointUnknown::Kind::kEffect || c.index != static_cast<int>(effect))
      list.push_back(&data.unknowns[j]);
  }
  return list;
}

/// Fills what the effects of the fit do.
void add_done(const Linearised& at, EvidenceData& data) {
  const Index n = data.residual.rows(), m = data.residual.cols();
  const Eigen::VectorXd x = at.unknowns();
  for (std::size_t e = 0; e < at.at.effects.size(); ++e) {
    MatrixXd moves = MatrixXd::Zero(n, m);
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const JointUnknown& c = at.columns[j];
      if (c.kind == JointUnknown::Kind::kEffect && c.index == static_cast<int>(e) &&
          c.parameter < at.at.effects[e].effect->info().sizes)
        moves += x[static_cast<Index>(j)] * data.unknowns[j].moves;
    }
    const Eigen::VectorXd left = Absorbing(unknowns_but_for(at, data, e), moves.size()).left_of(moves);
    data.done.emplace_back(Eigen::Map<const MatrixXd>(left.data(), n, m));
  }
}

/// Residuals and derivatives of a fit at instants, with another one's weights.
EvidenceData of_fit(const Shown& shown, const Linearised& at, const Linearised& weights) {
  const Index n = shown.size.size(), m = shown.bodies + shown.tangents;
  EvidenceData data;
  data.residual.setZero(n, m);
  data.t_s.setZero(n);
  data.trial.resize(static_cast<std::size_t>(n));
  const Eigen::VectorXd x = at.unknowns();
  const Eigen::VectorXd at_end = spread_at_ends(at);
  for (Index c = 0; c < x.size(); ++c)
    data.unknowns.push_back(unknown(at.columns[static_cast<std::size_t>(c)], x[c], at_end[c], n, m));
  for (std::size_t i = 0; i < shown.instants.size(); ++i) {
    const InstantRows& from = shown.instants[i];
    const std::size_t t = from.trial;
    const Index to = shown.group[i];
    data.trial[static_cast<std::size_t>(to)] = t;
    data.t_s[to] += at.predicted[t][from.block].instant.t_s / shown.size[to];
    for (Index r = 0; r < m; ++r) {
      const Index row = r < shown.bodies ? from.bodies + r : from.tangents + r - shown.bodies;
      const double own = at.root_weight[t][row], other = weights.root_weight[t][row];
      const double weight = own > 0.0 ? shown.weight(i) * other / own : 0.0;
      data.residual(to, r) += weight * at.residual[t][row];
      for (std::size_t c = 0; c < data.unknowns.size(); ++c)
        data.unknowns[c].moves(to, r) += weight * at.derivative[t](row, static_cast<Index>(c));
    }
  }
  add_done(at, data);
  return data;
}

/// By which rows grow per metre that a body is off; 0: rows of tangents.
MatrixXd rows_per_m(const JointModel& model, const Shown& shown, const Linearised& at) {
  MatrixXd rows = MatrixXd::Zero(shown.size.size(), shown.bodies + shown.tangents);
  for (std::size_t i = 0; i < shown.instants.size(); ++i) {
    const InstantRows& from = shown.instants[i];
    const std::vector<model::Seen>& bodies = model.trials()[from.trial].blocks[from.block].bodies;
    for (Index r = 0; r < shown.bodies; ++r)
      rows(shown.group[i], r) += shown.weight(i) * at.root_weight[from.trial][from.bodies + r] /
                                 model.sd_m(from.trial, from.block, bodies[static_cast<std::size_t>(r / 3)]);
  }
  return rows;
}

/// Takes out effects of which the model cannot say what they do to this arm.
void drop_unknown(std::vector<Signature>& effects) {
  std::vector<const model::Effect*> unknown;
  for (const Signature& s : effects)
    if (!s.moves.allFinite()) unknown.push_back(s.effect);
  const auto is_unknown = [&](const Signature& s) {
    return std::find(unknown.begin(), unknown.end(), s.effect) != unknown.end();
  };
  effects.erase(std::remove_if(effects.begin(), effects.end(), is_unknown), effects.end());
}

/// Fills Signature::left of the effects.
void add_left(const MatrixXd& rows_per_m, double length_m, EvidenceData& data) {
  const Index n = data.residual.size();
  std::vector<const Signature*> unknowns;
  for (const Signature& s : data.unknowns) unknowns.push_back(&s);
  const Absorbing absorbing(unknowns, n);
  for (Signature& effect : data.effects) {
    const Eigen::VectorXd left = absorbing.left_of(effect.moves);
    double sum = 0.0, bodies = 0.0;
    for (Index i = 0; i < n; ++i) {
      const double per_m = rows_per_m.data()[i];
      if (!(per_m > 0.0)) continue;
      sum += std::pow(left[i] / per_m, 2);
      bodies += 1.0 / 3.0;
    }
    effect.left = bodies > 0.0 ? std::sqrt(sum / bodies) / length_m : 0.0;
  }
}

/// Of as many values of what its numbers count.
double log_choices(const JointModel& model, const model::Effect& effect) {
  const std::vector<model::Parameter>& parameters = effect.info().parameters;
  std::set<std::vector<double>> choices;
  for (const model::Values& values : effect.grid(model.arm(), model.rod())) {
    std::vector<double> numbers;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      if (parameters[k].counts) numbers.push_back(values[static_cast<Index>(k)]);
    choices.insert(std::move(numbers));
  }
  return choices.empty() ? 0.0 : std::log(static_cast<double>(choices.size()));
}

/// Fills the effects: by their signatures about a fit, with another one's weights.
void add_effects(JointModel& model, const Shown& shown, Linearised& at, const Linearised& like,
                 const std::vector<model::Present>& candidates, unsigned jobs, EvidenceData& data) {
  model.complete(at);
  const Index n = data.residual.rows(), m = data.residual.cols();
  const std::vector<SizeStep> steps = size_steps(candidates);
  for (const SizeStep& step : steps) {
    data.effects.push_back({step.present.effect, 0.0, kPolicy.fit.size_sd, MatrixXd::Zero(n, m)});
    data.effects.back().unknown_sd =
        unknown_sd(model.unknown_inertia(), *step.present.effect, step.present.values / step.step);
    data.effects.back().log_choices = log_choices(model, *step.present.effect);
  }
  model.each_trial(jobs, [&](std::size_t t) {
    const Eigen::VectorXd weight =
        (at.root_weight[t].array() > 0.0).select(like.root_weight[t].cwiseQuotient(at.root_weight[t]), 0.0);
    const MatrixXd moves = weight.asDiagonal() * signatures_of(model, at, t, steps);
    for (std::size_t i = 0; i < shown.instants.size(); ++i) {
      const InstantRows& from = shown.instants[i];
      if (from.trial != t) continue;
      for (std::size_t c = 0; c < data.effects.size(); ++c) {
        const auto column = moves.col(static_cast<Index>(c));
        auto to = data.effects[c].moves.row(shown.group[i]);
        to.head(shown.bodies) += shown.weight(i) * column.segment(from.bodies, shown.bodies).transpose();
        to.tail(shown.tangents) +=
            shown.weight(i) * column.segment(from.tangents, shown.tangents).transpose();
      }
    }
  });
  drop_unknown(data.effects);
  add_left(rows_per_m(model, shown, like), model.arm().total_length_m(), data);
}

}  // namespace

double unknown_sd(double share, const model::Effect& effect, const model::Values& step) {
  const double moved = effect.sluggishness(step).mass_share;
  return moved != 0.0 ? share / std::abs(moved) : 0.0;
}

std::vector<SizeStep> size_steps(const std::vector<model::Present>& candidates) {
  std::vector<SizeStep> steps;
  for (const model::Present& candidate : candidates) {
    const model::Info& info = candidate.effect->info();
    for (int k = 0; k < info.sizes; ++k) {
      const model::Parameter& size = info.parameters[static_cast<std::size_t>(k)];
      double step = std::clamp(candidate.values[k] / size.usual, -1.0, 1.0);
      if (std::abs(step) < kLeastStep) step = size.high > 0.0 ? kLeastStep : -kLeastStep;
      model::Present one = candidate;
      one.values.head(info.sizes).setZero();
      one.values[k] = step * size.usual;
      steps.push_back({std::move(one), step});
    }
  }
  return steps;
}

MatrixXd signatures_of(JointModel& model, const Linearised& at, std::size_t trial,
                       const std::vector<SizeStep>& steps) {
  std::vector<JointParameters> changed(steps.size(), at.at);
  std::vector<double> sizes;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    changed[s].effects.push_back(steps[s].present);
    sizes.push_back(steps[s].step);
  }
  return at.root_weight[trial].asDiagonal() * model.signatures(at, trial, changed, sizes);
}

EvidenceData evidence_of_refit(const JointModel& model, const Linearised& refit, const Linearised& like) {
  return of_fit(whole_instants(model, like), refit, like);
}

EvidenceData evidence_of_refit(JointModel& model, Linearised& refit, const Linearised& like,
                               const std::vector<model::Present>& candidates, unsigned jobs) {
  const Shown shown = whole_instants(model, like);
  EvidenceData data = of_fit(shown, refit, like);
  std::vector<model::Present> others;
  for (const model::Present& candidate : candidates)
    if (candidate.effect != refit.at.effects.back().effect) others.push_back(candidate);
  add_effects(model, shown, refit, like, others, jobs, data);
  return data;
}

std::vector<Alike> alike_to(const Linearised& at, const EvidenceData& data, std::size_t effect) {
  const MatrixXd& done = data.done.at(effect);
  const Eigen::Map<const Eigen::VectorXd> wanted(done.data(), done.size());
  const Absorbing absorbing(unknowns_but_for(at, data, effect), done.size());
  std::vector<Alike> list;
  for (std::size_t c = 0; c < data.effects.size();) {
    const model::Effect* other = data.effects[c].effect;
    std::vector<Eigen::VectorXd> columns;
    for (; c < data.effects.size() && data.effects[c].effect == other; ++c)
      columns.push_back(absorbing.left_of(data.effects[c].moves));
    MatrixXd moves(done.size(), static_cast<Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) moves.col(static_cast<Index>(k)) = columns[k];
    const double left = (wanted - moves * math::least_squares(moves, wanted)).squaredNorm(),
                 all = wanted.squaredNorm();
    list.push_back({other, all > 0.0 ? std::sqrt(std::max(0.0, 1.0 - left / all)) : 0.0});
  }
  return list;
}

EvidenceData evidence_data(JointModel& model, Linearised& at, const std::vector<model::Present>& candidates,
                           unsigned jobs) {
  const Shown shown = whole_instants(model, at);
  EvidenceData data = of_fit(shown, at, at);
  add_effects(model, shown, at, at, candidates, jobs, data);
  data.features = features_at(model, at, shown);
  return data;
}

}  // namespace softarm::diagnose
