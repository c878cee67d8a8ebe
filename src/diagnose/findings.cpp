#include "findings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "contribution.h"
#include "effects/catalogue.h"
#include "policy.h"
#include "ranking.h"
#include "refits.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using model::Present;

std::vector<EffectValue> values_of(const arm::Arm& arm, const Linearised& at, std::size_t effect,
                                   const MatrixXd& covariance) {
  std::vector<EffectValue> list;
  const Present& present = at.at.effects[effect];
  const model::Info& info = present.effect->info();
  for (std::size_t k = 0; k < info.parameters.size(); ++k) {
    if (!present.effect->has_parameter(arm, static_cast<int>(k))) continue;
    const model::Parameter& parameter = info.parameters[k];
    EffectValue value;
    value.symbol = parameter.symbol;
    value.unit = parameter.unit;
    value.description = parameter.description;
    value.fitted = !parameter.held;
    value.value = value.low = value.high = present.values[static_cast<Eigen::Index>(k)];
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const JointUnknown& c = at.columns[j];
      if (c.kind != JointUnknown::Kind::kEffect || c.index != static_cast<int>(effect) ||
          c.parameter != static_cast<int>(k))
        continue;
      const double sd =
          c.scale * std::sqrt(covariance(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j)));
      value.low = std::max(c.low, value.value - kPolicy.words.interval_sd * sd);
      value.high = std::min(c.high, value.value + kPolicy.words.interval_sd * sd);
    }
    list.push_back(std::move(value));
  }
  return list;
}

/// The effects of the model, with what they are worth and where they are.
std::vector<NamedEffect> named_effects(JointModel& model, const Selection& selection) {
  const auto taken_of = [](const Round& round) -> const Refitted& {
    return round.refitted[static_cast<std::size_t>(round.taken)];
  };
  std::vector<NamedEffect> list;
  for (std::size_t e = 0; e < selection.extended.at.effects.size(); ++e) {
    const Present& present = selection.extended.at.effects[e];
    const Round& round = selection.rounds[selection.round_of[e]];
    const Refitted& r = taken_of(round);
    NamedEffect named;
    named.id = present.effect->info().id;
    named.description = present.effect->info().description;
    named.law = present.effect->info().law;
    named.source = present.effect->info().source;
    named.probability = std::min(r.probability, selection.doubt.still_there[e]);
    named.parameters = values_of(model.arm(), selection.extended, e, selection.doubt.covariance);
    named.where = where_is(model, selection.extended, present, contribution(model, selection.extended, e));
    const double without = e == 0 ? selection.first_order_rms_m
                                  : taken_of(selection.rounds[selection.round_of[e - 1]]).unseen.total_rms_m;
    named.held_out_gain_m = without - r.unseen.total_rms_m;
    named.share = std::max(0.0, without * without - r.unseen.total_rms_m * r.unseen.total_rms_m);
    for (const model::Effect* rival : round.rivals) named.confusable_with.push_back(rival->info().id);
    for (const model::Effect* other : round.nearly_as_good) {
      const bool beside =
          std::any_of(selection.extended.at.effects.begin(), selection.extended.at.effects.end(),
                      [&](const Present& one) { return one.effect == other; });
      const bool known = std::find(round.rivals.begin(), round.rivals.end(), other) != round.rivals.end();
      if (!beside && !known) named.confusable_with.push_back(other->info().id);
    }
    list.push_back(std::move(named));
  }
  double sum = 0.0;
  for (const NamedEffect& named : list) sum += named.share;
  for (NamedEffect& named : list) named.share = sum > 0.0 ? named.share / sum : 0.0;
  return list;
}

/// Whether weights are what was said as nearly as anybody knows them. The arm's own and that of payloads
/// cannot be told apart: EI and the gains go with the former.
bool is_weighed_well(const Present& present) {
  const model::Info& info = present.effect->info();
  if (info.family != model::Family::kLoad) return false;
  for (int k = 0; k < info.sizes; ++k) {
    if (info.parameters[static_cast<std::size_t>(k)].unit != "1" ||
        std::abs(present.values[k]) > kPolicy.words.weight)
      return false;
  }
  return true;
}

/// Whether bodies or the base are no further from where the arm file has them than it says to be usual.
bool is_placed_well(const arm::Arm& arm, const Present& present) {
  const model::Info& info = present.effect->info();
  if (!info.of_placement) return false;
  double length2 = 0.0, angle2 = 0.0;
  for (int k = 0; k < info.sizes; ++k) {
    const std::string& unit = info.parameters[static_cast<std::size_t>(k)].unit;
    const double value2 = present.values[k] * present.values[k];
    (unit == "m" ? length2 : angle2) += value2;
  }
  const auto most = [&](double arm::MeasuredBody::*sd) {
    double largest = 0.0;
    for (const arm::MeasuredBody& body : arm.bodies) largest = std::max(largest, body.*sd);
    return largest * largest;
  };
  return length2 <= most(&arm::MeasuredBody::placement_sd_m) &&
         angle2 <= most(&arm::MeasuredBody::placement_sd_rad);
}

/// Whether it is no more inertia and lag than nobody knows of an arm that swings: it counts as noise.
bool is_of_unknown_motion(const JointModel& model, const Linearised& at, const Present& present) {
  const model::Sluggishness own = present.effect->sluggishness(present.values);
  const double share = model.unknown_inertia();
  return !(own == model::Sluggishness()) && std::abs(own.mass_share) <= share &&
         std::abs(own.lag_s) <= share * at.at.viscoelastic_lag_s;
}

/// Whether it is that, or little of what is explained, or little beside what is left.
/// @param explained_m rms distance of a body that all effects explain on unseen trials
bool is_small(const JointModel& model, const Selection& selection, std::size_t e, const NamedEffect& effect,
              const Diagnosis& d, double explained_m, bool adequate) {
  const Round& round = selection.rounds[selection.round_of[e]];
  const double moved_m = round.refitted[static_cast<std::size_t>(round.taken)].moved_m;
  const bool beside = !adequate && effect.share * d.explained_share < kPolicy.words.small_part &&
                      moved_m < kPolicy.words.small * model.arm().total_length_m();
  return beside || is_small_share(effect.share, explained_m, model.arm().total_length_m()) ||
         is_usual(model, selection.extended, selection.extended.at.effects[e]);
}

/// Probability of an effect, or of what it may be mistaken for.
double of_it_or_a_rival(const Diagnosis& d, const NamedEffect& effect) {
  double neither = 1.0 - effect.probability;
  for (const std::string& rival : effect.confusable_with)
    for (const Candidate& candidate : d.ranking)
      if (candidate.id == rival) neither *= 1.0 - candidate.probability;
  return 1.0 - neither;
}

}  // namespace

double beyond_m(double whole_m, double part_m) {
  return std::sqrt(std::max(0.0, whole_m * whole_m - part_m * part_m));
}

bool is_usual(const JointModel& model, const Linearised& at, const Present& present) {
  return is_weighed_well(present) || is_placed_well(model.arm(), present) ||
         is_of_unknown_motion(model, at, present);
}

bool is_short_delay(const Present& present) {
  return present.effect->info().delays && std::abs(present.values[0]) <= kPolicy.delay.alike_s;
}

bool is_of_sensors_alone(const model::Info& info, bool short_delay) {
  return info.family == model::Family::kSensor && (info.of_placement || (info.delays && !short_delay));
}

bool is_small_share(double share, double explained_m, double length_m) {
  return share < kPolicy.words.small_share && std::sqrt(share) * explained_m < kPolicy.words.small * length_m;
}

double is_no_stand_in(double part_m, double left_m, double length_m, bool of_sensors) {
  const double all = kPolicy.posterior.no_stand_in * (of_sensors ? kPolicy.posterior.sensors : 1.0) * part_m *
                     kPolicy.words.small * length_m;
  return left_m > 0.0 ? all / (all + left_m * left_m) : 1.0;
}

void weigh_left_aside(const std::vector<Screened>& screened, double left_m, double length_m,
                      std::vector<Candidate>& ranking) {
  for (const Screened& s : screened) {
    for (Candidate& candidate : ranking) {
      const bool aside = candidate.finding == Finding::kAbsent || candidate.finding == Finding::kTrivial ||
                         candidate.finding == Finding::kCannotTell;
      if (aside && candidate.id == s.effect->info().id)
        candidate.probability *=
            is_no_stand_in(s.leftover_m, beyond_m(left_m, s.leftover_m), length_m,
                           is_of_sensors_alone(s.effect->info(), is_short_delay({s.effect, s.values})));
    }
  }
}

void mistake_mutually(std::vector<NamedEffect>& effects) {
  const auto has = [](const NamedEffect& effect, const std::string& id) {
    return std::find(effect.confusable_with.begin(), effect.confusable_with.end(), id) !=
           effect.confusable_with.end();
  };
  for (const NamedEffect& one : effects) {
    for (NamedEffect& other : effects) {
      if (has(one, other.id) && !has(other, one.id)) other.confusable_with.push_back(one.id);
    }
  }
}

void mistake_short_delays(const arm::Arm& arm, const std::vector<Present>& values,
                          std::vector<NamedEffect>& effects) {
  for (std::size_t e = 0; e < effects.size(); ++e) {
    if (!is_short_delay(values[e])) continue;
    EffectValue& delay = effects[e].parameters.front();
    const double hidden = kPolicy.words.interval_sd * kPolicy.delay.hidden_sd_s;
    const model::Parameter& range = values[e].effect->info().parameters.front();
    delay.low = std::max(range.low, delay.value - std::hypot(delay.value - delay.low, hidden));
    delay.high = std::min(range.high, delay.value + std::hypot(delay.high - delay.value, hidden));
    std::vector<std::string>& rivals = effects[e].confusable_with;
    for (const std::unique_ptr<model::Effect>& other : effects::catalogue()) {
      const std::string& id = other->info().id;
      if (other->info().delays && id != effects[e].id && other->applies_to(arm) &&
          std::find(rivals.begin(), rivals.end(), id) == rivals.end())
        rivals.push_back(id);
    }
  }
}

void lead_with_what_is_known(const std::vector<bool>& usual, std::vector<NamedEffect>& effects,
                             std::vector<NamedEffect>& small) {
  if (effects.empty() || std::any_of(effects.begin(), effects.end(), [](const NamedEffect& effect) {
        return effect.probability >= kPolicy.posterior.named;
      }))
    return;
  std::size_t largest = small.size();
  for (std::size_t i = 0; i < small.size(); ++i) {
    if (!usual[i] && small[i].probability >= kPolicy.posterior.named &&
        (largest == small.size() || small[i].share > small[largest].share))
      largest = i;
  }
  if (largest == small.size()) return;
  NamedEffect effect = std::move(small[largest]);
  small.erase(small.begin() + static_cast<std::ptrdiff_t>(largest));
  effects.insert(effects.begin(), std::move(effect));
}

void set_stand_ins_apart(Diagnosis& d) {
  const auto from = [&](std::vector<NamedEffect>& list) {
    const auto first = std::stable_partition(list.begin(), list.end(), [](const NamedEffect& effect) {
      return effect.probability >= kPolicy.words.likely;
    });
    std::move(first, list.end(), std::back_inserter(d.stand_ins));
    list.erase(first, list.end());
  };
  // An explanation to the noise stands as a whole, however little is known of its parts.
  if (d.verdict != Verdict::kExplained) from(d.effects);
  from(d.small_departures);
  for (NamedEffect& effect : d.stand_ins) effect.confusable_with.clear();
}

Verdict verdict_of(const Diagnosis& d, bool adequate) {
  if (!d.effects.empty()) {
    const bool told = std::any_of(d.effects.begin(), d.effects.end(), [&](const NamedEffect& effect) {
      return of_it_or_a_rival(d, effect) >= kPolicy.posterior.named;
    });
    if (d.explained_share >= kPolicy.verdict.explained && adequate)
      return told ? Verdict::kExplained : Verdict::kCannotTell;
    double believed = 0.0;
    for (const NamedEffect& effect : d.effects)
      if (effect.probability >= kPolicy.posterior.named) believed += effect.share * d.explained_share;
    return believed >= kPolicy.verdict.partly ? Verdict::kPartlyExplained : Verdict::kUnknown;
  }
  if (!adequate) return Verdict::kUnknown;
  const auto detectable =
      std::count_if(d.ranking.begin(), d.ranking.end(), [](const Candidate& c) { return c.detectable; });
  return static_cast<double>(detectable) >=
                 kPolicy.verdict.few_detectable * static_cast<double>(d.ranking.size())
             ? Verdict::kConsistent
             : Verdict::kCannotTell;
}

void rank_as_said(Diagnosis& d) {
  std::vector<std::string> said;
  for (const NamedEffect& effect : d.effects) said.push_back(effect.id);
  for (const NamedEffect& effect : d.effects)
    said.insert(said.end(), effect.confusable_with.begin(), effect.confusable_with.end());
  for (const std::vector<NamedEffect>* list : {&d.small_departures, &d.stand_ins})
    for (const NamedEffect& effect : *list) said.push_back(effect.id);
  const auto place = [&](const Candidate& c) {
    return std::find(said.begin(), said.end(), c.id) - said.begin();
  };
  std::stable_sort(d.ranking.begin(), d.ranking.end(), [&](const Candidate& a, const Candidate& b) {
    const auto of_a = place(a), of_b = place(b);
    return of_a != of_b ? of_a < of_b : a.probability > b.probability;
  });
}

void add_findings(JointModel& model, const Selection& selection, bool adequate, Diagnosis& d) {
  d.ranking = ranking_of(model, selection);
  std::vector<NamedEffect> all = named_effects(model, selection);
  mistake_short_delays(model.arm(), selection.extended.at.effects, all);
  mistake_mutually(all);
  std::set<const model::Effect*> weighed;
  std::vector<bool> usual;  // by small departure
  const double explained_m = beyond_m(d.baseline.held_out_rms_m, d.extended.held_out_rms_m);
  const double left_m = beyond_m(d.extended.held_out_rms_m, d.noise_floor_m);
  for (std::size_t e = 0; e < all.size(); ++e) {
    NamedEffect& effect = all[e];
    const bool small = is_small(model, selection, e, effect, d, explained_m, adequate);
    const Present& present = selection.extended.at.effects[e];
    const bool short_delay = is_short_delay(present);
    const auto no_stand_in = [&](const model::Effect& of) {
      return is_no_stand_in(std::sqrt(effect.share) * explained_m, left_m, model.arm().total_length_m(),
                            is_of_sensors_alone(of.info(), short_delay));
    };
    effect.probability *= no_stand_in(*present.effect);
    // No arm has more of it than its range allows: it makes up for what is left.
    if (!adequate && at_limit(selection.extended, e)) effect.probability = 0.0;
    if (small) {
      usual.push_back(is_usual(model, selection.extended, present));
    } else {
      // Those that might be there in its place would explain as little.
      const Round& round = selection.rounds[selection.round_of[e]];
      for (const EffectList* list : {&round.rivals, &round.nearly_as_good})
        for (const model::Effect* rival : *list)
          for (Candidate& candidate : d.ranking)
            if (candidate.finding == Finding::kRival && candidate.id == rival->info().id &&
                weighed.insert(rival).second)
              candidate.probability *= no_stand_in(*rival);
    }
    (small ? d.small_departures : d.effects).push_back(std::move(effect));
  }
  weigh_left_aside(selection.rounds.back().screened, left_m, model.arm().total_length_m(), d.ranking);
  std::stable_sort(d.effects.begin(), d.effects.end(),
                   [](const NamedEffect& a, const NamedEffect& b) { return a.share > b.share; });
  lead_with_what_is_known(usual, d.effects, d.small_departures);
  std::stable_sort(d.small_departures.begin(), d.small_departures.end(),
                   [](const NamedEffect& a, const NamedEffect& b) { return a.share > b.share; });
  for (const std::vector<NamedEffect>* list : {&d.small_departures, &d.effects})
    for (const NamedEffect& effect : *list)
      for (Candidate& candidate : d.ranking)
        if (candidate.id == effect.id) candidate.probability = effect.probability;
  d.verdict = verdict_of(d, adequate);
  set_stand_ins_apart(d);
  rank_as_said(d);
}

}  // namespace softarm::diagnose
