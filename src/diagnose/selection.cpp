#include "selection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

namespace softarm::diagnose {
namespace {

using effects::Effect;
using effects::Present;

constexpr double kRivalZ = 3.0;  // separation below which two effects are one class
constexpr double kRivalGain = 0.5 * kRivalZ * kRivalZ;
constexpr double kRivalCosine = 0.95;
constexpr double kScreenZ = 3.5;    // of an effect that is worth a refit
constexpr double kNoneOdds = 20.0;  // for none against one effect, before the data
constexpr double kTold = 2.0;       // standard deviations
constexpr std::size_t kAlwaysRefitted = 2;
constexpr double kNearBest = 0.25;  // of the best one's gain in the screen
constexpr int kBootstraps = 2000;
constexpr std::uint64_t kBootstrapSeed = 1;

/// At an end of its range that is not "absent", and told: one size of several that the trials do not tell may
/// be anywhere.
bool at_limit(const Linearised& at) {
  const Present& present = at.at.effects.back();
  const Eigen::VectorXd variance =
      at.information.ldlt()
          .solve(Eigen::MatrixXd::Identity(at.information.rows(), at.information.rows()))
          .diagonal() *
      inflation(at);
  const auto told = [&](std::size_t k) {
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const Column& c = at.columns[j];
      if (c.kind != Column::Kind::kEffect || c.index + 1 != static_cast<int>(at.at.effects.size()) ||
          c.parameter != static_cast<int>(k))
        continue;
      const double sd = c.scale * std::sqrt(variance[static_cast<Eigen::Index>(j)]);
      return std::abs(present.values[static_cast<Eigen::Index>(k)]) > kTold * sd;
    }
    return true;
  };
  const effects::Info& info = present.effect->info();
  for (std::size_t k = 0; k < info.parameters.size(); ++k) {
    const effects::Parameter& p = info.parameters[k];
    if (p.counts || k >= static_cast<std::size_t>(info.sizes)) continue;
    const double value = present.values[static_cast<Eigen::Index>(k)];
    const double near = 1e-6 * (p.high - p.low);
    if (((value <= p.low + near && p.low != 0.0) || value >= p.high - near) && told(k)) return true;
  }
  return false;
}

std::vector<std::size_t> worth_a_refit(const std::vector<Screened>& screened, const Options& options) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    const Screened& s = screened[i];
    if (s.z < kScreenZ || s.leftover_m < options.trivial_m) continue;
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
  while (list.size() > kAlwaysRefitted &&
         screened[list.back()].gain < kNearBest * screened[list.front()].gain)
    list.pop_back();
  return list;
}

/// The last effect's sizes against their own spread: what may as well be 0 is not named.
double z_of_sizes(const Linearised& at) {
  const Present& present = at.at.effects.back();
  std::vector<Eigen::Index> columns;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const Column& c = at.columns[j];
    if (c.kind == Column::Kind::kEffect && c.index + 1 == static_cast<int>(at.at.effects.size()) &&
        c.parameter < present.effect->info().sizes)
      columns.push_back(static_cast<Eigen::Index>(j));
  }
  const auto n = static_cast<Eigen::Index>(columns.size());
  const Eigen::MatrixXd all =
      at.information.ldlt().solve(Eigen::MatrixXd::Identity(at.information.rows(), at.information.rows()));
  const Eigen::VectorXd unknowns = at.unknowns();
  Eigen::VectorXd sizes(n);
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = columns[static_cast<std::size_t>(i)];
    sizes[i] = unknowns[row];
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = all(row, columns[static_cast<std::size_t>(j)]);
  }
  return std::sqrt(std::max(0.0, sizes.dot(covariance.ldlt().solve(sizes)) / inflation(at)));
}

/// Weights of the candidates, and of none of them, by what each gains on unseen trials: the mean over the
/// Bayesian bootstrap of the trials (pseudo-BMA+; Yao, Vehtari, Simpson and Gelman 2018, section 3.4), so
/// that a lead which rests on one or two trials does not count for certain.
void set_probabilities(std::vector<Refitted>& list) {
  if (list.empty()) return;
  const std::size_t trials = list.front().gains.size();
  const auto count = static_cast<Eigen::Index>(list.size());
  Eigen::MatrixXd gains(count, static_cast<Eigen::Index>(trials));
  for (Eigen::Index i = 0; i < count; ++i) {
    for (std::size_t t = 0; t < trials; ++t)
      gains(i, static_cast<Eigen::Index>(t)) = list[static_cast<std::size_t>(i)].gains[t];
  }
  std::mt19937_64 random(kBootstrapSeed);
  std::exponential_distribution<double> exponential;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);
  for (int n = 0; n < kBootstraps; ++n) {
    Eigen::VectorXd share(static_cast<Eigen::Index>(trials));
    for (double& s : share) s = exponential(random);
    const Eigen::VectorXd sum = gains * share * (static_cast<double>(trials) / share.sum());
    const double best = std::max(0.0, sum.maxCoeff());
    const Eigen::VectorXd odds = (sum.array() - best).exp();
    weights += odds / (odds.sum() + kNoneOdds * std::exp(-best));
  }
  for (Eigen::Index i = 0; i < count; ++i)
    list[static_cast<std::size_t>(i)].probability = weights[i] / kBootstraps;
}

}  // namespace

Selection select(JointModel& model, Linearised baseline, const Options& options,
                 const std::function<void(double, const std::string&)>& progress) {
  Selection selection;
  selection.baseline_unseen = unseen(model, baseline);
  selection.baseline = baseline;
  Linearised current = std::move(baseline);
  Unseen current_unseen = selection.baseline_unseen;
  const double share = 1.0 / (options.most_effects + 1);
  for (int n = 0; n <= options.most_effects; ++n) {
    Round round;
    model.set_misfit(std::max(1.0, current.square / std::max(1, current.rows)));
    const double begun = n * share;
    progress(begun, "screening the catalogue");
    round.screened = screen(model, current, options.jobs, [&](double) {});
    const std::vector<std::size_t> worth =
        n < options.most_effects ? worth_a_refit(round.screened, options) : std::vector<std::size_t>{};
    for (std::size_t i = 0; i < worth.size(); ++i) {
      const Screened& s = round.screened[worth[i]];
      progress(begun + share * (0.1 + 0.9 * static_cast<double>(i) / static_cast<double>(worth.size())),
               "refitting with " + s.effect->info().id);
      Refitted r;
      r.effect = s.effect;
      Parameters p = current.at;
      p.effects.push_back({s.effect, s.values});
      JointModel::FitOptions how;
      how.iterations = 4;
      how.tolerance = 0.2;
      how.whole = false;
      r.fit = model.fit(p, how, &current.predicted);
      r.unseen = unseen(model, r.fit);
      r.physical = !at_limit(r.fit);
      // Large, and had again where the catalogue is screened.
      for (std::vector<effects::Predicted>& trial : r.fit.predicted)
        for (effects::Predicted& predicted : trial) predicted.by_rod.resize(0, 0);
      round.refitted.push_back(std::move(r));
    }
    // All against the spread that the best of them leaves.
    double least = current_unseen.total_chi2, phi = inflation(current);
    for (const Refitted& r : round.refitted) {
      if (r.unseen.total_chi2 < least) {
        least = r.unseen.total_chi2;
        phi = inflation(r.fit);
      }
    }
    for (Refitted& r : round.refitted) {
      const double fall = current_unseen.total_chi2 - r.unseen.total_chi2;
      r.z = std::min(std::sqrt(std::max(0.0, fall / phi)), z_of_sizes(r.fit));
      r.gain = 0.5 * fall / phi;
      r.gains.clear();
      for (std::size_t t = 0; t < r.unseen.chi2.size(); ++t)
        r.gains.push_back(0.5 * (current_unseen.chi2[t] - r.unseen.chi2[t]) / phi);
      r.moved_m = std::sqrt(
          std::max(0.0, std::pow(current_unseen.total_rms_m, 2) - std::pow(r.unseen.total_rms_m, 2)));
    }
    std::stable_sort(round.refitted.begin(), round.refitted.end(),
                     [](const Refitted& a, const Refitted& b) { return a.gain > b.gain; });
    set_probabilities(round.refitted);
    for (std::size_t i = 0; i < round.refitted.size() && round.taken < 0; ++i) {
      const Refitted& r = round.refitted[i];
      // A worse one is not named in the place of a better one that cannot be right; one as good is.
      if (round.refitted.front().gain - r.gain >= kRivalGain) break;
      if (r.z >= options.least_z && r.physical && r.moved_m >= options.trivial_m)
        round.taken = static_cast<int>(i);
    }
    const bool taken = round.taken >= 0;
    if (taken) {
      const Refitted& first = round.refitted[static_cast<std::size_t>(round.taken)];
      const auto screened_of = [&](const Effect* effect) {
        return std::find_if(round.screened.begin(), round.screened.end(),
                            [&](const Screened& s) { return s.effect == effect; });
      };
      const auto own = screened_of(first.effect);
      for (const Refitted& r : round.refitted) {
        if (r.effect != first.effect && r.physical && first.gain - r.gain < kRivalGain)
          round.rivals.push_back(r.effect);
      }
      for (const Screened& s : round.screened) {
        const bool refitted = std::any_of(round.refitted.begin(), round.refitted.end(),
                                          [&](const Refitted& r) { return r.effect == s.effect; });
        if (refitted || own == round.screened.end()) continue;
        const double cosine = std::abs(s.direction.dot(own->direction));
        if (cosine > kRivalCosine && first.z * std::sqrt(1.0 - cosine * cosine) < kRivalZ)
          round.rivals.push_back(s.effect);
      }
      current = first.fit;
      current_unseen = first.unseen;
      if (model.answers_itself(current.at)) {
        current = model.linearise(first.fit.at, &first.fit.predicted, JointModel::Derivatives::kWhole);
        current_unseen = unseen(model, current);
      }
      selection.round_of.push_back(selection.rounds.size());
    }
    for (Refitted& r : round.refitted) {
      Parameters at = std::move(r.fit.at);
      r.fit = {};
      r.fit.at = std::move(at);
      r.unseen.residual.clear();
    }
    selection.rounds.push_back(std::move(round));
    if (!taken) break;
  }
  // What has become superfluous goes.
  for (std::size_t e = 0; current.at.effects.size() > 1 && e < current.at.effects.size();) {
    Parameters p = current.at;
    p.effects.erase(p.effects.begin() + static_cast<std::ptrdiff_t>(e));
    JointModel::FitOptions how;
    how.iterations = 3;
    how.tolerance = 0.2;
    const Linearised without = model.fit(p, how, &current.predicted);
    const Unseen left = unseen(model, without);
    const double z2 = (left.total_chi2 - current_unseen.total_chi2) / inflation(current);
    const double moved =
        std::sqrt(std::max(0.0, std::pow(left.total_rms_m, 2) - std::pow(current_unseen.total_rms_m, 2)));
    if (z2 >= options.least_z * options.least_z && moved >= options.trivial_m) {
      ++e;
      continue;
    }
    current = without;
    current_unseen = left;
    selection.round_of.erase(selection.round_of.begin() + static_cast<std::ptrdiff_t>(e));
    e = 0;
  }
  selection.extended = std::move(current);
  selection.extended_unseen = std::move(current_unseen);
  selection.inflation = inflation(selection.extended);
  return selection;
}

}  // namespace softarm::diagnose
