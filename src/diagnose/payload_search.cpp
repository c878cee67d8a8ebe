#include "payload_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Something more hangs where the payload does. No effect of the arm, and of no catalogue: what was told is
/// wrong, in one trial or another.
class MorePayload : public model::Effect {
 public:
  const model::Info& info() const override { return info_; }
  bool varies_along() const override { return false; }
  void drive(const arm::Arm&, const model::Values& values, model::Series& series) const override {
    series.payload_kg.array() += values[0];
  }

 private:
  const model::Info info_{"more_payload",
                          "more hangs on the arm than was told",
                          "m = m_told + more",
                          "",
                          model::Family::kLoad,
                          {{"more_kg", "kg", "beside what was told", -1e3, 1e3, 1.0}},
                          1,
                          {},
                          {}};
};

constexpr double kPayloadStep = 0.02;  // of the usual payload: a difference to first order

/// Sums over stretches of trials: of m, by which the usual payload moves the bodies, with the derivatives J
/// by the constants, with residuals, and with itself.
struct PayloadSums {
  VectorXd mixed;  ///< J^T m
  double score = 0.0, own = 0.0;

  /// Those of another stretch, in which it hangs with this sign.
  void add(double sign, const PayloadSums& other) {
    mixed += sign * other.mixed;
    score += sign * other.score;
    own += other.own;
  }
};

/// Sums of one trial up to each of its blocks.
class PayloadSumsTo {
 public:
  PayloadSumsTo(const Linearised& at, const model::TrialData& trial, std::size_t t, const VectorXd& moves)
      : mixed_(MatrixXd::Zero(at.gradient.size(), static_cast<Index>(trial.blocks.size()) + 1)),
        score_(VectorXd::Zero(mixed_.cols())),
        own_(VectorXd::Zero(mixed_.cols())) {
    Index bodies = 0, tangents = 0;  // the first rows of a block
    for (const model::Block& block : trial.blocks) tangents += 3 * static_cast<Index>(block.bodies.size());
    for (Index k = 0; k + 1 < mixed_.cols(); ++k) {
      const model::Block& block = trial.blocks[static_cast<std::size_t>(k)];
      mixed_.col(k + 1) = mixed_.col(k);
      score_[k + 1] = score_[k];
      own_[k + 1] = own_[k];
      for (auto [row, seen] :
           {std::pair<Index&, std::size_t>{bodies, block.bodies.size()}, {tangents, block.tangents.size()}}) {
        const Index rows = 3 * static_cast<Index>(seen);
        const auto own = moves.segment(row, rows);
        mixed_.col(k + 1) += at.derivative[t].middleRows(row, rows).transpose() * own;
        score_[k + 1] += own.dot(at.residual[t].segment(row, rows));
        own_[k + 1] += own.squaredNorm();
        row += rows;
      }
    }
  }
  PayloadSums between(std::size_t first, std::size_t last) const {
    const auto from = static_cast<Index>(first), to = static_cast<Index>(last);
    return {mixed_.col(to) - mixed_.col(from), score_[to] - score_[from], own_[to] - own_[from]};
  }

 private:
  MatrixXd mixed_;
  VectorXd score_, own_;
};

/// Of what hangs beside what was told, over the usual payload.
struct Span {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

/// Normal equations of the constants, and of payloads beside what was told, over the usual one.
class PayloadEquations {
 public:
  explicit PayloadEquations(const Linearised& at)
      : held_(held_at_ends(at)), inflation_(inflation(at)), square_(at.square) {
    information_ = at.information;
    gradient_ = at.gradient;
    hold(held_, information_, gradient_);
    // A payload is as likely as the usual one beforehand, against the misfit as it is.
    before_ = std::max(1.0, at.square / std::max(1, at.rows));
    solve();
  }

  struct Gain {
    double fall = 0.0;  ///< of chi^2
    double more = 0.0;
  };
  /// With one payload more, within what can hang there.
  Gain gain(const PayloadSums& sums, const Span& possible) const {
    const VectorXd with = column(sums);
    const double own = sums.own + before_ - with.dot(covariance_ * with);
    const double score = sums.score - with.dot(move_);
    const double more = std::clamp(score / own, possible.low, possible.high);
    return {more * (2.0 * score - more * own), more};
  }
  /// Of a part of a fall of chi^2: what falls does not count as scatter.
  double z(double part, double fall) const {
    return std::sqrt(std::max(0.0, part) / (inflation_ * std::max(kLeastLeft, 1.0 - fall / square_)));
  }
  /// @param already of it, in the fit
  void add(const PayloadSums& sums, double already) {
    const VectorXd with = column(sums);
    const Index n = gradient_.size();
    information_.conservativeResize(n + 1, n + 1);
    information_.col(n).head(n) = with;
    information_.row(n).head(n) = with.transpose();
    information_(n, n) = sums.own + before_;
    gradient_.conservativeResize(n + 1);
    gradient_[n] = sums.score - before_ * already;
    solve();
  }
  /// Of the payload that was added so many after the first.
  double more(std::size_t payload) const { return move_[place(payload)]; }
  double sd(std::size_t payload) const {
    return std::sqrt(inflation_ * covariance_(place(payload), place(payload)));
  }

 private:
  Index place(std::size_t payload) const { return static_cast<Index>(held_.size() + payload); }
  /// With the unknowns so far: the constants, and payloads of other trials, which it has nothing to do with.
  VectorXd column(const PayloadSums& sums) const {
    VectorXd with = VectorXd::Zero(gradient_.size());
    for (std::size_t c = 0; c < held_.size(); ++c)
      if (!held_[c]) with[static_cast<Index>(c)] = sums.mixed[static_cast<Index>(c)];
    return with;
  }
  void solve() {
    covariance_ = math::inverse_of_symmetric(information_);
    move_ = covariance_ * gradient_;
  }

  const std::vector<bool> held_;              ///< constants
  static constexpr double kLeastLeft = 1e-3;  // of chi^2: rounding
  const double inflation_, square_;
  double before_ = 1.0;
  MatrixXd information_, covariance_;
  VectorXd gradient_, move_;
};

/// Sums of all trials.
class PayloadSumsOf {
 public:
  PayloadSumsOf(JointModel& model, Linearised& at, double usual_kg) {
    static const MorePayload kMore;
    model.complete(at);
    JointParameters more = at.at;
    const double step_kg = kPayloadStep * usual_kg;
    more.effects.push_back({&kMore, model::Values::Constant(1, step_kg)});
    for (std::size_t t = 0; t < model.trials().size(); ++t) {
      const VectorXd moves = model.signatures(at, t, {more}, {step_kg}).col(0);
      trials_.emplace_back(at, model.trials()[t], t, usual_kg * at.root_weight[t].cwiseProduct(moves));
    }
  }
  PayloadSums over(const std::vector<TrialStretch>& where) const {
    PayloadSums sums{VectorXd::Zero(trials_.front().between(0, 0).mixed.size())};
    for (const TrialStretch& one : where) sums.add(one.sign, trials_[one.trial].between(one.first, one.last));
    return sums;
  }

 private:
  std::vector<PayloadSumsTo> trials_;
};

/// What can hang there beside what was told, kg: together no less than nothing, and what the arm may bear.
Span possible_kg(const std::vector<TrialStretch>& where, const JointModel& model) {
  Span span;
  for (const TrialStretch& stretch : where) {
    const ToldIn told = told_in(stretch, model.trials()[stretch.trial]);
    const double less = told.least, more = std::max(0.0, model.arm().payload.range_kg.high - told.most);
    span.low = std::max(span.low, stretch.sign > 0.0 ? -less : -more);
    span.high = std::min(span.high, stretch.sign > 0.0 ? more : less);
  }
  return span;
}

struct FoundPayload {
  OtherPayload payload;
  PayloadEquations::Gain gain;
};

/// Payloads that may be other ones, weighed against each other.
class PayloadSearch {
 public:
  PayloadSearch(JointModel& model, Linearised& at, double usual_kg)
      : model_(model),
        usual_kg_(usual_kg),
        sums_(model, at, usual_kg),
        equations_(at),
        is_in_(model.trials().size(), false) {}

  void add(const OtherPayload& payload) {
    for (const TrialStretch& stretch : payload.where) is_in_[stretch.trial] = true;
    equations_.add(sums_.over(payload.where), payload.more_kg / usual_kg_);
    list_.push_back(payload);
  }
  /// The one that gains most beside those; nothing where none is worth a second diagnosis.
  std::optional<OtherPayload> next() const {
    FoundPayload best;
    for (std::size_t t = 0; t < is_in_.size(); ++t) {
      if (is_in_[t]) continue;
      FoundPayload one = in_one_trial(t);
      if (one.gain.fall > best.gain.fall) best = std::move(one);
    }
    FoundPayload alike = among_told_alike();
    if (alike.gain.fall > kPolicy.told.exchanged * best.gain.fall) best = std::move(alike);
    if (equations_.z(best.gain.fall, best.gain.fall) < kPolicy.told.least_z ||
        std::abs(best.gain.more) < kPolicy.told.least_share)
      return std::nullopt;
    return best.payload;
  }
  /// All of them, with what the fit makes of them together.
  std::vector<OtherPayload> list() const {
    std::vector<OtherPayload> list = list_;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Span possible = possible_kg(list[i].where, model_);
      list[i].more_kg += std::clamp(usual_kg_ * equations_.more(i), possible.low, possible.high);
      list[i].sd_kg = usual_kg_ * equations_.sd(i);
    }
    return list;
  }

 private:
  FoundPayload found(std::vector<TrialStretch> where) const {
    Span possible = possible_kg(where, model_);
    possible.low /= usual_kg_;
    possible.high /= usual_kg_;
    const PayloadEquations::Gain gain = equations_.gain(sums_.over(where), possible);
    return {{std::move(where)}, gain};
  }
  /// Of one trial what gains most: another payload in all of it, from some time on, or up to one.
  FoundPayload in_one_trial(std::size_t t) const {
    const std::size_t blocks = model_.trials()[t].blocks.size();
    const auto fewest =
        static_cast<std::size_t>(std::ceil(kPolicy.told.least_time * static_cast<double>(blocks)));
    const FoundPayload whole = found({{t, 0, blocks}});
    FoundPayload best = whole;
    for (std::size_t k = 1; k + fewest <= blocks; ++k) {
      for (const TrialStretch& stretch : {TrialStretch{t, k, blocks}, TrialStretch{t, 0, blocks - k}}) {
        FoundPayload one = found({stretch});
        if (one.gain.fall > best.gain.fall) best = std::move(one);
      }
    }
    // A time at which it changed is a number more.
    return equations_.z(best.gain.fall - whole.gain.fall, best.gain.fall) < kPolicy.told.least_z ? whole
                                                                                                 : best;
  }
  /// Trials that were told one payload all along, and are not spoken for, by what was told.
  std::map<double, std::vector<TrialStretch>> told_alike() const {
    std::map<double, std::vector<TrialStretch>> groups;
    for (std::size_t t = 0; t < is_in_.size(); ++t) {
      const model::TrialData& trial = model_.trials()[t];
      const VectorXd& told_kg = trial.series.payload_kg;
      if (!is_in_[t] && told_kg.minCoeff() == told_kg.maxCoeff())
        groups[told_kg[0]].push_back({t, 0, trial.blocks.size()});
    }
    return groups;
  }
  /// Of those what gains most: another payload in all that were told the same, or, where that gains nearly as
  /// much, two payloads that were exchanged.
  FoundPayload among_told_alike() const {
    const std::map<double, std::vector<TrialStretch>> groups = told_alike();
    FoundPayload one, exchanged;
    for (auto light = groups.begin(); light != groups.end(); ++light) {
      if (light->second.size() > 1) {
        FoundPayload alone = found(light->second);
        if (alone.gain.fall > one.gain.fall) one = std::move(alone);
      }
      for (auto heavy = std::next(light); heavy != groups.end(); ++heavy) {
        std::vector<TrialStretch> where = light->second;
        for (TrialStretch stretch : heavy->second) {
          stretch.sign = -1.0;
          where.push_back(stretch);
        }
        FoundPayload both = found(std::move(where));
        both.payload.exchanged_kg = heavy->first - light->first;
        if (both.gain.more > 0.0 && both.gain.fall > exchanged.gain.fall) exchanged = std::move(both);
      }
    }
    return exchanged.gain.fall > kPolicy.told.exchanged * one.gain.fall ? exchanged : one;
  }

  const JointModel& model_;
  const double usual_kg_;
  const PayloadSumsOf sums_;
  PayloadEquations equations_;
  std::vector<bool> is_in_;  ///< trials
  std::vector<OtherPayload> list_;
};

}  // namespace

ToldIn told_in(const TrialStretch& stretch, const model::TrialData& trial) {
  ToldIn told;
  double frames = 0.0;
  for (const bool with_hand : {false, true}) {
    for (std::size_t k = stretch.first; k < stretch.last; ++k) {
      const model::Block& block = trial.blocks[k];
      if (block.set_aside && !with_hand) continue;
      const auto of_block = trial.series.payload_kg.segment(static_cast<Index>(block.first),
                                                            static_cast<Index>(block.last - block.first));
      told.least = std::min(told.least, of_block.minCoeff());
      told.most = std::max(told.most, of_block.maxCoeff());
      told.mean += of_block.sum();
      frames += static_cast<double>(of_block.size());
    }
    if (frames > 0.0) break;  // else a hand was on it all the time
  }
  told.mean /= std::max(1.0, frames);
  return told;
}

double usual_payload_kg(const arm::Arm& arm, const std::vector<model::TrialData>& trials) {
  double heaviest = 0.0;
  for (const model::TrialData& trial : trials)
    heaviest = std::max(heaviest, trial.series.payload_kg.maxCoeff());
  return heaviest > 0.0 ? heaviest : kPolicy.experiment.payload_share * mass_kg(arm);
}

std::vector<OtherPayload> other_payloads(JointModel& model, Linearised& at,
                                         const std::vector<OtherPayload>& known, double usual_kg) {
  // One trial alone says nothing that its own constants would not.
  if (model.trials().size() < 2 || !(usual_kg > 0.0)) return {};
  PayloadSearch search(model, at, usual_kg);
  for (const OtherPayload& payload : known) search.add(payload);
  while (const std::optional<OtherPayload> next = search.next()) search.add(*next);
  return search.list();
}

}  // namespace softarm::diagnose
