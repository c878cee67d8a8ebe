#include "unseen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "math/linear_algebra.h"
#include "math/parallel.h"
#include "policy.h"
#include "ranges.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A fit's normal equations without some of its trials.
struct Without {
  MatrixXd information;
  VectorXd gradient;
};

Without without_some(const Linearised& at, const std::vector<bool>& without) {
  Without rest{at.information, at.gradient};
  for (const TimeStretch& stretch : at.stretches) {
    if (!without[stretch.trial]) continue;
    rest.information -= stretch.information;
    rest.gradient -= stretch.gradient;
  }
  return rest;
}

/// From the fit's unknowns to those of the trials that are not left out, to first order.
VectorXd step_without(const Linearised& at, const Fold& fold) {
  // One trial alone has no others: its own fit is all there is.
  if (std::all_of(fold.without.begin(), fold.without.end(), [](bool out) { return out; }))
    return VectorXd::Zero(at.gradient.size());
  const Without rest = without_some(at, fold.without);
  VectorXd step;
  least_within(rest.information, rest.gradient, 0.0, rooms_of(at), step);
  return step;
}

JointParameters stepped(const Linearised& at, const VectorXd& step) {
  JointParameters p = at.at;
  const VectorXd x = at.unknowns() + step;
  for (Eigen::Index j = 0; j < x.size(); ++j) set_unknown(p, at.columns[static_cast<std::size_t>(j)], x[j]);
  return p;
}

/// Sums over bodies of one trial or all.
struct Distances {
  double square = 0.0, fitted_square = 0.0, weight = 0.0;  ///< by precision
  double sum_m = 0.0, most_m = 0.0;                        ///< plain, of every frame
  double sum_m2 = 0.0, fitted_sum_m2 = 0.0;
  double frames = 0.0;

  void add(const Distances& other) {
    square += other.square;
    fitted_square += other.fitted_square;
    weight += other.weight;
    sum_m += other.sum_m;
    sum_m2 += other.sum_m2;
    fitted_sum_m2 += other.fitted_sum_m2;
    most_m = std::max(most_m, other.most_m);
    frames += other.frames;
  }
  double rms_m() const { return weight > 0.0 ? std::sqrt(square / weight) : 0.0; }
  double mean_m() const { return frames > 0.0 ? sum_m / frames : 0.0; }
};

/// @param r residuals of a trial, whitened and weighted as the fit's are
/// @param metres gets those of the bodies as they are
Distances distances_of(const JointModel& model, const Linearised& at, std::size_t t, const VectorXd& r,
                       VectorXd& metres) {
  Distances d;
  metres = VectorXd::Zero(r.size());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
    for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
      if (at.root_weight[t][row] > 0.0) {
        const double sd = model.sd_m(t, k, seen), w = 1.0 / (sd * sd);
        const double scale = sd / at.root_weight[t][row];
        metres.segment<3>(row) = scale * r.segment<3>(row);
        const double distance_m = metres.segment<3>(row).norm();
        const double fitted_m2 = scale * scale * at.residual[t].segment<3>(row).squaredNorm();
        d.sum_m += seen.frames * distance_m;
        d.sum_m2 += seen.frames * distance_m * distance_m;
        d.fitted_sum_m2 += seen.frames * fitted_m2;
        d.most_m = std::max(d.most_m, distance_m);
        d.frames += seen.frames;
        d.square += w * distance_m * distance_m;
        d.fitted_square += w * fitted_m2;
        d.weight += w;
      }
      row += 3;
    }
  }
  return d;
}

}  // namespace

Unseen summed(const JointModel& model, const Linearised& at, const std::vector<VectorXd>& residual) {
  Unseen out;
  Distances all;
  for (std::size_t t = 0; t < residual.size(); ++t) {
    out.chi2.push_back(residual[t].squaredNorm());
    out.total_chi2 += out.chi2.back();
    VectorXd metres;
    const Distances d = distances_of(model, at, t, residual[t], metres);
    out.rms_m.push_back(d.rms_m());
    out.residual.push_back(std::move(metres));
    out.mean_of_m.push_back(d.mean_m());
    out.max_of_m.push_back(d.most_m);
    all.add(d);
  }
  out.mean_m = all.mean_m();
  out.max_m = all.most_m;
  if (all.frames > 0.0) {
    out.plain_rms_m = std::sqrt(all.sum_m2 / all.frames);
    out.fitted_plain_rms_m = std::sqrt(all.fitted_sum_m2 / all.frames);
  }
  out.total_rms_m = all.rms_m();
  out.fitted_rms_m = all.weight > 0.0 ? std::sqrt(all.fitted_square / all.weight) : 0.0;
  return out;
}

namespace {

/// Residuals of trials as the model itself predicts them, weighted as the fit's are; to first order where it
/// has no equilibrium.
void predict_into(const JointModel& model, const Linearised& at, const VectorXd& step, std::size_t trial,
                  const std::vector<model::Predicted>& predicted, VectorXd& residual) {
  const VectorXd there = model.residual(trial, predicted);
  residual = at.residual[trial] - at.derivative[trial] * step;
  for (Eigen::Index row = 0; row < there.size(); row += 3) {
    if (!there.segment<3>(row).isZero())
      residual.segment<3>(row) = at.root_weight[trial][row] * there.segment<3>(row);
  }
}

}  // namespace

std::vector<Fold> unseen_folds(const JointModel& model) {
  std::map<std::vector<bool>, std::vector<std::size_t>> groups;
  const std::vector<std::vector<bool>>& without = model.predicted_without();
  for (std::size_t t = 0; t < without.size(); ++t) groups[without[t]].push_back(t);
  std::vector<Fold> folds;
  for (auto& [set, tried] : groups) folds.push_back({set, std::move(tried)});
  return folds;
}

namespace {

/// By trial its sequence; where all are of one, itself: what is unseen then is another payload or attitude.
std::vector<std::size_t> commands_of(const std::vector<std::size_t>& sequence) {
  std::vector<std::size_t> commands = sequence;
  if (std::set<std::size_t>(sequence.begin(), sequence.end()).size() == 1)
    std::iota(commands.begin(), commands.end(), std::size_t{0});
  return commands;
}

}  // namespace

std::vector<std::size_t> sessions_of(const std::vector<double>& session_s) {
  std::vector<std::size_t> order(session_s.size()), session(session_s.size(), 0);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return session_s[a] < session_s[b]; });
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool pause = session_s[order[i]] - session_s[order[i - 1]] > kPolicy.unseen.session_pause_s;
    session[order[i]] = session[order[i - 1]] + pause;
  }
  return session;
}

std::vector<std::vector<bool>> predicted_without(const std::vector<std::size_t>& sequence,
                                                 const std::vector<double>& session_s) {
  const std::size_t trials = sequence.size();
  const std::vector<std::size_t> commands = commands_of(sequence), session = sessions_of(session_s);
  const std::size_t sessions = trials > 0 ? *std::max_element(session.begin(), session.end()) + 1 : 0;
  std::vector<std::vector<bool>> list(trials, std::vector<bool>(trials, false));
  for (std::size_t t = 0; t < trials; ++t) {
    for (std::size_t other = 0; other < trials; ++other)
      list[t][other] = commands[other] == commands[t] ||
                       (sessions >= kPolicy.unseen.fewest_sessions && session[other] == session[t]);
    // Every other trial has its commands or its session.
    if (std::all_of(list[t].begin(), list[t].end(), [](bool out) { return out; })) {
      list[t].assign(trials, false);
      list[t][t] = true;
    }
  }
  return list;
}

namespace {

/// Fits without one fold of trials after the other against the fit to all, to first order.
class Jackknife {
 public:
  Jackknife(const Linearised& at, const std::vector<bool>& held)
      : at_(at), held_(held), rooms_(rooms_of(at)) {
    known_ = step({at.information, at.gradient}, of_all_);
  }
  /// @param fold by trial
  /// @param fewest folds that say something
  Spread over(const std::vector<std::size_t>& fold, std::size_t fewest) const {
    const std::set<std::size_t> folds(fold.begin(), fold.end());
    if (folds.size() < fewest) return {};
    const Eigen::ArrayXd none = Eigen::ArrayXd::Zero(known_.size());
    // Sums over folds of what each of them alone knows, and of powers that the freedom goes by.
    Eigen::ArrayXd variance = none, own_sum = none, own_squares = none, ratios = none, pairs = none;
    for (const std::size_t one : folds) {
      std::vector<bool> without;
      for (const std::size_t of_trial : fold) without.push_back(of_trial == one);
      VectorXd to;
      const VectorXd less_known = step(without_some(at_, without), to);
      Eigen::ArrayXd kept = (known_.array() / less_known.array()).max(1e-9).min(1.0);
      for (Eigen::Index j = 0; j < kept.size(); ++j)
        if (held_[static_cast<std::size_t>(j)]) kept[j] = 1.0;  // no fold tells it
      variance += kept * (to - of_all_).array().square();
      const Eigen::ArrayXd own = 1.0 - kept;
      own_sum += own;
      own_squares += own.square();
      pairs += 2.0 * ratios * own.square() / kept;
      ratios += own.square() / kept;
    }
    // Of white errors a fold's deviation is less_known - known, and so weighted its own share of known. In
    // one dimension the sum's variance is 2 / freedom of its square.
    return {variance, own_sum, (own_sum.square() / (own_squares + pairs).max(1e-300)).max(1.0)};
  }

 private:
  /// @param to gets where the unknowns go
  /// @return their variances
  VectorXd step(Without rest, VectorXd& to) const {
    hold(held_, rest.information, rest.gradient);
    least_within(rest.information, rest.gradient, 0.0, rooms_, to);
    return math::inverse_of_symmetric(rest.information).diagonal();
  }

  const Linearised& at_;
  const std::vector<bool>& held_;
  const std::vector<Room> rooms_;
  VectorXd of_all_, known_;
};

}  // namespace

Spreads between_folds(const Linearised& at, const std::vector<std::size_t>& sequence,
                      const std::vector<std::size_t>& session, const std::vector<bool>& held) {
  const std::size_t trials = sequence.size();
  const std::vector<std::size_t> commands = commands_of(sequence);
  std::vector<std::size_t> both(trials);
  for (std::size_t t = 0; t < trials; ++t) both[t] = commands[t] * trials + session[t];
  const Jackknife jackknife(at, held);
  return {jackknife.over(commands, kPolicy.unseen.fewest_sequences),
          jackknife.over(session, kPolicy.unseen.fewest_sessions),
          jackknife.over(both, kPolicy.unseen.fewest_sessions)};
}

Spreads between_folds(const JointModel& model, const Linearised& at, const std::vector<bool>& held) {
  std::vector<double> session_s;
  for (const model::TrialData& trial : model.trials()) session_s.push_back(trial.series.session_s);
  return between_folds(at, model.sequences(), sessions_of(session_s), held);
}

Unseen unseen(const JointModel& model, const Linearised& at) {
  std::vector<VectorXd> residual(model.trials().size());
  for (const Fold& fold : unseen_folds(model)) {
    const VectorXd step = step_without(at, fold);
    for (const std::size_t t : fold.tried) residual[t] = at.residual[t] - at.derivative[t] * step;
  }
  return summed(model, at, residual);
}

Unseen refitted_unseen(JointModel& model, const Linearised& at) {
  const std::vector<Fold> folds = unseen_folds(model);
  const std::size_t trials = model.trials().size();
  std::vector<VectorXd> step(trials), residual(trials);
  for (const Fold& fold : folds) {
    const VectorXd of_fold = step_without(at, fold);
    for (const std::size_t t : fold.tried) step[t] = of_fold;
  }
  math::in_parallel(trials, model.jobs(), [&](std::size_t t) {
    predict_into(model, at, step[t], t, model.predict_trial(stepped(at, step[t]), t, &at.predicted[t]),
                 residual[t]);
  });
  std::size_t refits = 0;
  for (const Fold& fold : folds) {
    double chi2 = 0.0, expected = 0.0;
    for (const std::size_t t : fold.tried) {
      chi2 += residual[t].squaredNorm();
      expected += (at.residual[t] - at.derivative[t] * step[t]).squaredNorm();
    }
    if (std::abs(chi2 - expected) <= kPolicy.unseen.first_order * expected) continue;
    ++refits;
    const Linearised anew = model.fit_without(stepped(at, step[fold.tried.front()]), fold.without, at);
    for (const std::size_t t : fold.tried)
      predict_into(model, at, step[t], t, model.predict_trial(anew.at, t, &at.predicted[t]), residual[t]);
  }
  Unseen out = summed(model, at, residual);
  out.refits = refits;
  return out;
}

}  // namespace softarm::diagnose
