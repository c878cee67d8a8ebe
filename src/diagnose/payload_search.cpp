#include "payload_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "payload_equations.h"
#include "policy.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

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

/// The same over the usual payload, and what is expected: of two that have each other's, just that.
Span span_of(const OtherPayload& payload, const JointModel& model, double usual_kg) {
  Span span = possible_kg(payload.where, model);
  span.low /= usual_kg;
  span.high /= usual_kg;
  if (payload.exchanged_kg) span.exchanged = *payload.exchanged_kg / usual_kg;
  return span;
}

struct FoundPayload {
  OtherPayload payload;
  PayloadEquations::Gain gain;
};

/// Payloads that may be other ones, weighed against each other.
class PayloadSearch {
 public:
  PayloadSearch(JointModel& model, const Linearised& at, double usual_kg)
      : model_(model),
        usual_kg_(usual_kg),
        sums_(model, at, usual_kg),
        equations_(at, sums_.told(), kPolicy.told.offset_sd * model.arm().total_length_m()),
        is_in_(model.trials().size(), false),
        is_all_in_(is_in_) {}

  /// @param beside of it, over the usual one, that is not in the trials
  void add(const OtherPayload& payload, double beside) {
    for (const TrialStretch& stretch : payload.where) {
      is_in_[stretch.trial] = true;
      is_all_in_[stretch.trial] = payload.exchanged_kg ? false : is_all(stretch);
    }
    equations_.add(sums_.over(payload.where), payload.more_kg / usual_kg_, beside,
                   span_of(payload, model_, usual_kg_));
    list_.push_back(payload);
  }
  std::size_t size() const { return list_.size(); }
  /// The one that gains most beside those; nothing where none is worth a second diagnosis.
  std::optional<FoundPayload> next() const {
    FoundPayload best;
    for (FoundPayload& of_trial : in_each_trial()) take_better(std::move(of_trial), best);
    const std::map<double, std::vector<TrialStretch>> groups = told_alike();
    for (const auto& [told_kg, trials] : groups) {
      for (std::vector<TrialStretch>& some : several_of(trials)) {
        // A trial more is to gain something: one that says nothing would join any other.
        FoundPayload one = found(std::move(some));
        if (equations_.z(one.gain.fall - best.gain.fall, one.gain.fall) >= kPolicy.told.least_z)
          best = std::move(one);
      }
    }
    FoundPayload exchanged = exchanged_among(groups);
    if (exchanged.gain.fall > kPolicy.told.exchanged * best.gain.fall &&
        equations_.z(best.gain.fall - exchanged.gain.fall, best.gain.fall) < kPolicy.told.least_z)
      best = std::move(exchanged);
    if (equations_.z(best.gain.fall, best.gain.fall) < kPolicy.told.least_z) return std::nullopt;
    return best;
  }
  /// All of them, with what the fit makes of them together; without those of which it leaves next to nothing.
  OtherPayloads all() const {
    OtherPayloads found{list_, equations_.offset_m()};
    std::vector<OtherPayload>& list = found.list;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i].exchanged_kg) {
        list[i].more_kg = *list[i].exchanged_kg;
        continue;
      }
      const Span possible = possible_kg(list[i].where, model_);
      list[i].more_kg += std::clamp(usual_kg_ * equations_.more(i), possible.low, possible.high);
      list[i].sd_kg = usual_kg_ * equations_.sd(i);
    }
    const double least = least_kg(list);
    list.erase(std::remove_if(list.begin(), list.end(),
                              [&](const OtherPayload& one) { return std::abs(one.more_kg) < least; }),
               list.end());
    return found;
  }

 private:
  /// Below which a difference is an effect's.
  double least_kg(const std::vector<OtherPayload>& list) const {
    double heaviest = usual_kg_;
    for (const OtherPayload& one : list) heaviest = std::max(heaviest, std::abs(one.more_kg));
    return kPolicy.told.least_share * heaviest;
  }
  /// Blocks in which one hangs, of a trial.
  std::size_t fewest_blocks(std::size_t t) const {
    return static_cast<std::size_t>(
        std::ceil(kPolicy.told.least_time * static_cast<double>(model_.trials()[t].blocks.size())));
  }
  bool is_all(const TrialStretch& stretch) const {
    const std::size_t outside = model_.trials()[stretch.trial].blocks.size() - (stretch.last - stretch.first);
    return outside < fewest_blocks(stretch.trial);
  }
  /// Whether something was told right, in some trial: what hangs in all of them is the arm's own.
  bool leaves_some(const std::vector<TrialStretch>& where) const {
    std::vector<bool> all = is_all_in_;
    for (const TrialStretch& stretch : where) all[stretch.trial] = is_all(stretch);
    return std::find(all.begin(), all.end(), false) != all.end();
  }
  FoundPayload found(std::vector<TrialStretch> where, std::optional<double> exchanged_kg = {}) const {
    FoundPayload one;
    one.payload.where = std::move(where);
    one.payload.exchanged_kg = exchanged_kg;
    weigh(span_of(one.payload, model_, usual_kg_), one);
    return one;
  }
  /// Nothing is gained by one that cannot be, or makes too small a difference.
  void weigh(const Span& span, FoundPayload& one) const {
    if (!one.payload.exchanged_kg && !leaves_some(one.payload.where)) return;
    const PayloadEquations::Gain gain = equations_.gain(sums_.over(one.payload.where), span);
    if (std::abs(gain.more) * usual_kg_ >= least_kg(list_)) one.gain = gain;
  }
  /// Of each trial; nothing of those that have one.
  std::vector<FoundPayload> in_each_trial() const {
    std::vector<FoundPayload> list(is_in_.size());
    model_.each_trial([&](std::size_t t) {
      if (!is_in_[t]) list[t] = in_one_trial(t);
    });
    return list;
  }
  /// Of one trial what gains most: another payload in all of it, or in all of it that was told the same, or
  /// there from some time on, or up to one.
  FoundPayload in_one_trial(std::size_t t) const {
    const std::size_t fewest = fewest_blocks(t);
    FoundPayload whole, part;
    for (const TrialStretch& told : told_the_same(t)) {
      if (told.last - told.first < fewest) continue;
      const Span span = span_of({{told}}, model_, usual_kg_);
      take_better(found({told}), whole);
      for (std::size_t k = 1; k + fewest <= told.last - told.first; ++k) {
        for (const TrialStretch& stretch :
             {TrialStretch{t, told.first + k, told.last}, {t, told.first, told.last - k}}) {
          FoundPayload one{{{stretch}}, {}};
          weigh(span, one);
          take_better(std::move(one), part);
        }
      }
    }
    // A time at which it changed is a number more.
    const double more = part.gain.fall - whole.gain.fall;
    return equations_.z(more, part.gain.fall) < kPolicy.told.least_z ? whole : part;
  }
  /// Stretches of a trial in which one payload was told, or nearly: that of a load cell flickers.
  std::vector<TrialStretch> told_the_same(std::size_t t) const {
    std::vector<TrialStretch> stretches;
    const model::TrialData& trial = model_.trials()[t];
    ToldIn here;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const ToldIn told = told_in({t, k, k + 1}, trial);
      here.least = std::min(here.least, told.least);
      here.most = std::max(here.most, told.most);
      if (k > 0 && here.most - here.least <= kPolicy.told.settled * usual_kg_) {
        stretches.back().last = k + 1;
      } else {
        stretches.push_back({t, k, k + 1});
        here = told;
      }
    }
    return stretches;
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
  /// Of those the two payloads that gain most where they have been exchanged, of all that were told them or
  /// of one trial each.
  FoundPayload exchanged_among(const std::map<double, std::vector<TrialStretch>>& groups) const {
    FoundPayload best;
    for (auto light = groups.begin(); light != groups.end(); ++light) {
      for (auto heavy = std::next(light); heavy != groups.end(); ++heavy) {
        const double kg = heavy->first - light->first;
        take_better(found_exchanged(light->second, heavy->second, kg), best);
        for (const TrialStretch& of_light : light->second)
          for (const TrialStretch& of_heavy : heavy->second)
            take_better(found_exchanged({of_light}, {of_heavy}, kg), best);
      }
    }
    return best;
  }
  /// Sets of two trials and more, the smallest first; of very many only all.
  static std::vector<std::vector<TrialStretch>> several_of(const std::vector<TrialStretch>& trials) {
    if (trials.size() > kPolicy.told.most_in_sets) return {trials};
    std::vector<std::vector<TrialStretch>> sets;
    for (std::size_t set = 1; set < std::size_t{1} << trials.size(); ++set) {
      std::vector<TrialStretch> some;
      for (std::size_t i = 0; i < trials.size(); ++i)
        if ((set >> i & 1U) != 0) some.push_back(trials[i]);
      if (some.size() > 1) sets.push_back(std::move(some));
    }
    std::stable_sort(sets.begin(), sets.end(),
                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
    return sets;
  }
  /// Both have to say so.
  FoundPayload found_exchanged(const std::vector<TrialStretch>& light, std::vector<TrialStretch> heavy,
                               double kg) const {
    for (TrialStretch& stretch : heavy) stretch.sign = -1.0;
    std::vector<TrialStretch> where = light;
    where.insert(where.end(), heavy.begin(), heavy.end());
    FoundPayload both = found(std::move(where), kg);
    const double one = std::max(found(light, kg).gain.fall, found(std::move(heavy), kg).gain.fall);
    if (equations_.z(both.gain.fall - one, both.gain.fall) < kPolicy.told.least_z) return {};
    return both;
  }
  static void take_better(FoundPayload other, FoundPayload& best) {
    if (other.gain.fall > best.gain.fall) best = std::move(other);
  }

  const JointModel& model_;
  const double usual_kg_;
  const PayloadSumsOf sums_;
  PayloadEquations equations_;
  std::vector<bool> is_in_, is_all_in_;  ///< trials; all of which hangs as no other was told
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

bool is_settled(const std::vector<OtherPayload>& before, const std::vector<OtherPayload>& after,
                double usual_kg) {
  if (after.size() != before.size()) return false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double small_kg = std::max(kPolicy.told.settled * std::max(usual_kg, std::abs(after[i].more_kg)),
                                     kPolicy.told.settled_sd * after[i].sd_kg);
    if (std::abs(after[i].more_kg - before[i].more_kg) > small_kg) return false;
  }
  return true;
}

OtherPayloads other_payloads(JointModel& model, const Linearised& at, const std::vector<OtherPayload>& known,
                             double usual_kg) {
  // One trial alone says nothing that its own constants would not.
  if (model.trials().size() < 2 || !(usual_kg > 0.0)) return {};
  PayloadSearch search(model, at, usual_kg);
  for (const OtherPayload& payload : known) search.add(payload, 0.0);
  OtherPayloads found = search.all();
  if (is_settled(known, found.list, usual_kg)) {
    while (const std::optional<FoundPayload> next = search.next()) {
      search.add(next->payload, next->gain.more);
      OtherPayloads with = search.all();
      if (with.list.size() < search.size()) break;  // beside it one of them is next to nothing
      found = std::move(with);
    }
  }
  found.offset_m += offset_in(at);
  return found;
}

}  // namespace softarm::diagnose
