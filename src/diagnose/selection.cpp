#include "selection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using model::Effect;
using model::Present;

constexpr int kBootstraps = 500;  // a probability to two percent
constexpr std::uint64_t kBootstrapSeed = 1;
constexpr int kRefitIterations = 4, kDropIterations = 3;
constexpr double kRefitTolerance = 0.2;  // of a step against the standard deviations

/// Of what an effect moves the bodies by beyond what the constants absorb, rms.
double trivial_m(const JointModel& model) {
  return kPolicy.selection.trivial * model.arm().total_length_m();
}

/// At an end of its range that is not "absent", and determined: one size of several that the trials do not
/// determine may be anywhere.
bool at_limit(const Linearised& at) {
  const Present& present = at.at.effects.back();
  const Eigen::VectorXd variance = math::inverse_of_symmetric(at.information).diagonal() * inflation(at);
  const auto determined = [&](std::size_t k) {
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const JointUnknown& c = at.columns[j];
      if (c.kind != JointUnknown::Kind::kEffect || c.index + 1 != static_cast<int>(at.at.effects.size()) ||
          c.parameter != static_cast<int>(k))
        continue;
      const double sd = c.scale * std::sqrt(variance[static_cast<Eigen::Index>(j)]);
      return std::abs(present.values[static_cast<Eigen::Index>(k)]) > kPolicy.selection.identifiable_sd * sd;
    }
    return true;
  };
  const model::Info& info = present.effect->info();
  for (std::size_t k = 0; k < info.parameters.size(); ++k) {
    const model::Parameter& p = info.parameters[k];
    if (p.counts || k >= static_cast<std::size_t>(info.sizes)) continue;
    const double value = present.values[static_cast<Eigen::Index>(k)];
    const double near = 1e-6 * (p.high - p.low);
    if (((value <= p.low + near && p.low != 0.0) || value >= p.high - near) && determined(k)) return true;
  }
  return false;
}

std::vector<std::size_t> worth_a_refit(const JointModel& model, const std::vector<Screened>& screened,
                                       const Options& options) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    const Screened& s = screened[i];
    if (s.z < kPolicy.selection.screen_z || s.leftover_m < trivial_m(model)) continue;
    list.push_back(i);
  }
  // What falls on unseen trials counts, but a first-order estimate may overshoot there.
  std::stable_sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) {
    const auto worth = [&](std::size_t i) {
      return screened[i].gain + std::max(0.0, screened[i].unseen_gain);
    };
    return worth(a) > worth(b);
  });
  if (list.size() > static_cast<std::size_t>(options.refits))
    list.resize(static_cast<std::size_t>(options.refits));
  // Refits cost most of the time: two always, others where they come near.
  while (list.size() > kPolicy.selection.always_refitted &&
         screened[list.back()].gain < kPolicy.selection.near_best * screened[list.front()].gain)
    list.pop_back();
  return list;
}

/// The last effect's sizes against their own spread: what may as well be 0 is not named.
double z_of_sizes(const Linearised& at) {
  const Present& present = at.at.effects.back();
  std::vector<Eigen::Index> columns;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const JointUnknown& c = at.columns[j];
    if (c.kind == JointUnknown::Kind::kEffect && c.index + 1 == static_cast<int>(at.at.effects.size()) &&
        c.parameter < present.effect->info().sizes)
      columns.push_back(static_cast<Eigen::Index>(j));
  }
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Eigen::MatrixXd all = math::inverse_of_symmetric(at.information);
  const Eigen::VectorXd unknowns = at.unknowns();
  Eigen::VectorXd sizes(n);
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = columns[static_cast<std::size_t>(i)];
    sizes[i] = unknowns[row];
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = all(row, columns[static_cast<std::size_t>(j)]);
  }
  return std::sqrt(std::max(0.0, sizes.dot(math::solve_symmetric(covariance, sizes)) / inflation(at)));
}

/// What the rounds stand upon: the model so far.
struct Standing {
  Linearised fit;
  Unseen unseen;
};

JointModel::FitOptions refit_options(int iterations) {
  JointModel::FitOptions how;
  how.iterations = iterations;
  how.tolerance = kRefitTolerance;
  return how;
}

Refitted refit(JointModel& model, const Standing& current, const Screened& s) {
  Refitted r;
  r.effect = s.effect;
  JointParameters p = current.fit.at;
  p.effects.push_back({s.effect, s.values});
  JointModel::FitOptions how = refit_options(kRefitIterations);
  how.whole = false;
  r.fit = model.fit(p, how, &current.fit.predicted);
  r.unseen = unseen(model, r.fit);
  r.physical = !at_limit(r.fit);
  r.converged = r.fit.converged;
  // Large, and had again where the catalogue is screened.
  for (std::vector<model::Predicted>& trial : r.fit.predicted)
    for (model::Predicted& predicted : trial) predicted.by_rod.resize(0, 0);
  return r;
}

/// Root of the fall of the mean square error on unseen trials.
double moved_m(const Unseen& without, const Unseen& with) {
  return std::sqrt(std::max(0.0, std::pow(without.total_rms_m, 2) - std::pow(with.total_rms_m, 2)));
}

/// Probability of a gain on unseen trials, were others like these recorded: the share of the Bayesian
/// bootstrap of the trials (Rubin 1981). What rests on one trial of many is not there in all of them.
double gains_elsewhere(const Unseen& without, const Unseen& with) {
  std::mt19937_64 random(kBootstrapSeed);
  std::exponential_distribution<double> exponential;
  int gains = 0;
  for (int n = 0; n < kBootstraps; ++n) {
    double sum = 0.0;
    for (std::size_t t = 0; t < with.chi2.size(); ++t)
      sum += exponential(random) * (without.chi2[t] - with.chi2[t]);
    gains += sum > 0.0;
  }
  return static_cast<double>(gains) / kBootstraps;
}

/// What each candidate gains, all against the spread that the best of them leaves; the best comes first.
void compare(const Standing& current, const Posterior& posterior, std::vector<Refitted>& refitted) {
  double least = current.unseen.total_chi2, phi = inflation(current.fit);
  for (const Refitted& r : refitted) {
    if (r.unseen.total_chi2 < least) {
      least = r.unseen.total_chi2;
      phi = inflation(r.fit);
    }
  }
  for (Refitted& r : refitted) {
    const double fall = current.unseen.total_chi2 - r.unseen.total_chi2;
    r.z = std::min(std::sqrt(std::max(0.0, fall / phi)), z_of_sizes(r.fit));
    r.gain = 0.5 * fall / phi;
    r.moved_m = moved_m(current.unseen, r.unseen);
    r.elsewhere = gains_elsewhere(current.unseen, r.unseen);
    r.probability = posterior.of(r.effect) * r.elsewhere;
  }
  std::stable_sort(refitted.begin(), refitted.end(),
                   [](const Refitted& a, const Refitted& b) { return a.gain > b.gain; });
}

/// Whether one tends to be there where the other is not.
bool take_turns(const Posterior& posterior, const Effect* one, const Effect* other) {
  const double instead = posterior.instead(other, one), with = posterior.of(other) - instead;
  const double of_one = posterior.of(one);
  return instead >= kPolicy.posterior.rival &&
         instead * of_one > kPolicy.posterior.turns * with * (1.0 - of_one);
}

/// Probability that it, or one of those that it takes turns with, is there.
double of_class(const Round& round, const Effect* effect) {
  EffectList list{effect};
  for (const Screened& s : round.screened) {
    if (s.effect != effect && take_turns(round.posterior, effect, s.effect)) list.push_back(s.effect);
  }
  return round.posterior.of_any(list);
}

/// The most probable that can be, of a class that is more probable than not; -1: there is none. One whose fit
/// did not converge is only taken where none that did is. One that is not even a rival stands for no class.
int best_of(const JointModel& model, const Round& round) {
  int best = -1, open = -1;
  for (std::size_t i = 0; i < round.refitted.size(); ++i) {
    const Refitted& r = round.refitted[i];
    if (of_class(round, r.effect) * r.elsewhere < kPolicy.posterior.named ||
        r.probability < kPolicy.posterior.rival || !r.physical || r.moved_m < trivial_m(model))
      continue;
    int& leader = r.converged ? best : open;
    if (leader < 0 || r.probability > round.refitted[static_cast<std::size_t>(leader)].probability)
      leader = static_cast<int>(i);
  }
  return best >= 0 ? best : open;
}

/// Those that may be there in its place, or are the same in these trials.
std::vector<const Effect*> rivals_of(const Round& round) {
  std::vector<const Effect*> rivals;
  const Refitted& first = round.refitted[static_cast<std::size_t>(round.taken)];
  const auto own = std::find_if(round.screened.begin(), round.screened.end(),
                                [&](const Screened& s) { return s.effect == first.effect; });
  for (const Screened& s : round.screened) {
    if (s.effect == first.effect) continue;
    const double cosine = std::abs(s.direction.dot(own->direction));
    const bool as_good = std::any_of(round.refitted.begin(), round.refitted.end(), [&](const Refitted& r) {
      return r.effect == s.effect && r.physical && first.gain - r.gain < kPolicy.selection.rival_gain;
    });
    if (as_good || take_turns(round.posterior, first.effect, s.effect) ||
        (cosine > kPolicy.selection.rival_cosine &&
         first.z * std::sqrt(1.0 - cosine * cosine) < kPolicy.selection.rival_z))
      rivals.push_back(s.effect);
  }
  return rivals;
}

/// Takes the round's best into the model.
void take(JointModel& model, const Refitted& best, Standing& current) {
  current = {best.fit, best.unseen};
  if (!model.has_configuration_dependent_load(current.fit.at)) return;
  current.fit = model.linearise(best.fit.at, &best.fit.predicted, JointModel::Derivatives::kWhole);
  current.fit.converged = best.converged;
  current.unseen = unseen(model, current.fit);
}

/// The posterior over what was screened, each at the values of its refit where it had one.
Posterior posterior_of(JointModel& model, Standing& current, const Round& round, unsigned jobs) {
  std::vector<Present> candidates;
  for (const Screened& s : round.screened) {
    Present candidate{s.effect, s.values};
    for (const Refitted& r : round.refitted)
      if (r.effect == s.effect) candidate = r.fit.at.effects.back();
    candidates.push_back(std::move(candidate));
  }
  std::vector<RefitEvidence> refits;
  for (const Refitted& r : round.refitted)
    refits.push_back({r.effect, evidence_of_refit(model, r.fit, current.fit)});
  return posterior(evidence_data(model, current.fit, candidates, jobs), refits, jobs);
}

/// One round: screen, refits of what explains most, the posterior, refits of what is more probable than not.
Round look(JointModel& model, Standing& current, bool refits, const Options& options,
           const std::function<void(double, const std::string&)>& progress) {
  Round round;
  model.set_misfit(std::max(1.0, current.fit.square / std::max(1, current.fit.rows)));
  progress(0.0, "screening the catalogue");
  round.screened = screen(model, current.fit, options.jobs, [](double) {});
  const std::vector<std::size_t> worth =
      refits ? worth_a_refit(model, round.screened, options) : std::vector<std::size_t>{};
  for (std::size_t i = 0; i < worth.size(); ++i) {
    const Screened& s = round.screened[worth[i]];
    progress(0.1 + 0.8 * static_cast<double>(i) / static_cast<double>(worth.size()),
             "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s));
  }
  progress(0.9, "how probable all of them are");
  round.posterior = posterior_of(model, current, round, options.jobs);
  for (const Screened& s : round.screened) {
    const bool known = std::any_of(round.refitted.begin(), round.refitted.end(),
                                   [&](const Refitted& r) { return r.effect == s.effect; });
    if (!refits || known || round.posterior.of(s.effect) < kPolicy.posterior.rival ||
        of_class(round, s.effect) < kPolicy.posterior.named)
      continue;
    progress(0.95, "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s));
  }
  compare(current, round.posterior, round.refitted);
  round.taken = best_of(model, round);
  if (round.taken >= 0) round.rivals = rivals_of(round);
  return round;
}

/// Takes out of the model again what has become superfluous.
/// @return whether there was any
bool drop_superfluous(JointModel& model, Standing& current, std::vector<std::size_t>& round_of) {
  bool dropped = false;
  for (std::size_t e = 0; current.fit.at.effects.size() > 1 && e < current.fit.at.effects.size();) {
    JointParameters p = current.fit.at;
    p.effects.erase(p.effects.begin() + static_cast<std::ptrdiff_t>(e));
    Standing without;
    without.fit = model.fit(p, refit_options(kDropIterations), &current.fit.predicted);
    without.unseen = unseen(model, without.fit);
    if (moved_m(without.unseen, current.unseen) >= trivial_m(model)) {
      ++e;
      continue;
    }
    current = std::move(without);
    round_of.erase(round_of.begin() + static_cast<std::ptrdiff_t>(e));
    dropped = true;
    e = 0;
  }
  return dropped;
}

/// Log density at nothing of sizes that lie anywhere between those of the fit and those of the posterior
/// about it, which knows of correlated errors and small departures: where the two differ, neither is known to
/// be the better.
double log_density_at_nothing(const Eigen::VectorXd& fitted, const Eigen::VectorXd& posterior,
                              const Eigen::MatrixXd& covariance) {
  constexpr int kSteps = 8;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  std::vector<double> logs;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::VectorXd size = fitted + (posterior - fitted) * i / kSteps;
    logs.push_back(-0.5 * size.dot(factor.solve(size)));
  }
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double log : logs) sum += std::exp(log - most);
  return most + std::log(sum / (kSteps + 1)) - factor.matrixLLT().diagonal().array().log().sum();
}

/// Probability of an effect of the fit given all the others that are in it: the density that its sizes have
/// at nothing, before the data and after them (Savage and Dickey; Dickey 1971), and the odds of an effect.
double still_there(const Linearised& at, std::size_t e, std::size_t catalogue, const Posterior& posterior) {
  std::vector<Eigen::Index> rows;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const JointUnknown& c = at.columns[j];
    if (c.kind == JointUnknown::Kind::kEffect && c.index == static_cast<int>(e) &&
        c.parameter < at.at.effects[e].effect->info().sizes)
      rows.push_back(static_cast<Eigen::Index>(j));
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  const Eigen::VectorXd x = at.unknowns();
  Eigen::VectorXd fitted(n), later(n);
  Eigen::MatrixXd covariance(n, n);
  double log_before = 0.0;  // density at nothing
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    const JointUnknown& c = at.columns[static_cast<std::size_t>(row)];
    fitted[i] = x[row];
    // What is linear knows of no range.
    later[i] = std::clamp(x[row] + posterior.shift[row], c.low / c.scale, c.high / c.scale);
    log_before -= std::log(c.prior_sd);
    for (Eigen::Index k = 0; k < n; ++k)
      covariance(i, k) = posterior.covariance(row, rows[static_cast<std::size_t>(k)]);
  }
  const double log_odds = log_before - log_density_at_nothing(fitted, later, covariance) +
                          std::log(kPolicy.posterior.expected / static_cast<double>(catalogue));
  return 1.0 / (1.0 + std::exp(-log_odds));
}

/// How well the unknowns of the last model are known, and whether its effects still are.
void add_doubt(const Linearised& at, const Posterior& posterior, std::size_t catalogue,
               Selection& selection) {
  selection.still_there.assign(at.at.effects.size(), 1.0);
  if (posterior.covariance.rows() != at.information.rows()) {
    selection.covariance = inflation(at) * math::inverse_of_symmetric(at.information);
    return;
  }
  selection.covariance = posterior.covariance + posterior.shift * posterior.shift.transpose();
  for (std::size_t e = 0; e < selection.still_there.size(); ++e)
    selection.still_there[e] = still_there(at, e, catalogue, posterior);
}

}  // namespace

Selection select(JointModel& model, Linearised baseline, const Options& options,
                 const std::function<void(double, const std::string&)>& progress) {
  Selection selection;
  selection.baseline_unseen = unseen(model, baseline);
  selection.baseline = baseline;
  Standing current{std::move(baseline), selection.baseline_unseen};
  const double share = 1.0 / (options.most_effects + 1);
  for (int n = 0; n <= options.most_effects; ++n) {
    Round round = look(model, current, n < options.most_effects, options,
                       [&](double done, const std::string& what) { progress((n + done) * share, what); });
    const bool taken = round.taken >= 0;
    if (taken) {
      take(model, round.refitted[static_cast<std::size_t>(round.taken)], current);
      selection.round_of.push_back(selection.rounds.size());
    }
    for (Refitted& r : round.refitted) {
      JointParameters at = std::move(r.fit.at);
      r.fit = {};
      r.fit.at = std::move(at);
      r.unseen.residual.clear();
    }
    selection.rounds.push_back(std::move(round));
    if (!taken) break;
  }
  const Round& last = selection.rounds.back();
  const std::size_t catalogue = selection.rounds.front().screened.size();
  if (drop_superfluous(model, current, selection.round_of)) {
    Round anew;
    anew.screened = last.screened;
    add_doubt(current.fit, posterior_of(model, current, anew, options.jobs), catalogue, selection);
  } else {
    add_doubt(current.fit, last.posterior, catalogue, selection);
  }
  selection.extended = std::move(current.fit);
  selection.extended_unseen = std::move(current.unseen);
  selection.inflation = inflation(selection.extended);
  return selection;
}

}  // namespace softarm::diagnose
