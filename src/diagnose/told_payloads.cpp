#include "told_payloads.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "policy.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;

constexpr double kRounding_kg = 1e-9;

/// Frames of a stretch of blocks: with those between blocks, and at the ends of the trial.
std::pair<Index, Index> frames_of(const TrialStretch& stretch, const model::TrialData& trial) {
  const auto end = static_cast<std::size_t>(trial.series.payload_kg.size());
  const std::size_t from = stretch.first == 0 ? 0 : trial.blocks[stretch.first].first;
  const std::size_t to = stretch.last == trial.blocks.size() ? end : trial.blocks[stretch.last].first;
  return {static_cast<Index>(from), static_cast<Index>(to - from)};
}

/// Nothing is compared while a hand is on the payload, nor soon after.
void set_aside_about(double change_s, model::TrialData& trial) {
  const model::Preparation how;
  for (model::Block& block : trial.blocks) {
    const double from_s = trial.series.t_s[static_cast<Index>(block.first)];
    const double to_s = trial.series.t_s[static_cast<Index>(block.last) - 1];
    if (to_s > change_s - how.before_payload_s && from_s < change_s + how.after_payload_s)
      block.set_aside = true;
  }
}

std::string weight(double kg) {
  return kg > 0.0 ? with_unit(kg, "kg") : "nothing";
}

/// When, and what: " from 2.0 s on 100 g hung on the arm ...".
std::string what_hung(const ToldPayload& one) {
  const std::string when = one.from_s && one.to_s
                               ? fmt::format(" from {:.1f} to {:.1f} s", *one.from_s, *one.to_s)
                           : one.from_s ? fmt::format(" from {:.1f} s on", *one.from_s)
                           : one.to_s   ? fmt::format(" up to {:.1f} s", *one.to_s)
                                        : "";
  const std::string interval = one.low_kg < one.high_kg
                                   ? fmt::format(" (90 % interval {} to {})", with_unit(one.low_kg, "kg"),
                                                 with_unit(one.high_kg, "kg"))
                                   : ", as stated elsewhere,";
  return fmt::format("{} {}{} was attached to the arm, but {} was stated", when, weight(one.found_kg),
                     interval, weight(one.told_kg));
}

}  // namespace

std::vector<model::TrialData> under(const std::vector<OtherPayload>& payloads,
                                    std::vector<model::TrialData> trials) {
  for (const OtherPayload& payload : payloads) {
    for (const TrialStretch& stretch : payload.where) {
      model::TrialData& trial = trials[stretch.trial];
      const auto [from, frames] = frames_of(stretch, trial);
      auto of_stretch = trial.series.payload_kg.segment(from, frames);
      of_stretch = (of_stretch.array() + stretch.sign * payload.more_kg).max(0.0);
      if (stretch.first > 0) set_aside_about(trial.series.t_s[from], trial);
      if (stretch.last < trial.blocks.size()) set_aside_about(trial.series.t_s[from + frames], trial);
    }
  }
  return trials;
}

ToldPayloads told_payloads(const std::vector<OtherPayload>& payloads,
                           const std::vector<model::TrialData>& trials) {
  ToldPayloads told;
  for (std::size_t t = 0; t < trials.size(); ++t) {
    for (const OtherPayload& payload : payloads) {
      for (const TrialStretch& stretch : payload.where) {
        if (stretch.trial != t) continue;
        const auto [from, frames] = frames_of(stretch, trials[t]);
        const double half_kg = kPolicy.words.interval_sd * payload.sd_kg;
        ToldPayload one;
        one.trial = trials[t].name;
        one.told_kg = told_in(stretch, trials[t]).mean;
        one.found_kg = one.told_kg + stretch.sign * payload.more_kg;
        if (one.found_kg < kRounding_kg) one.found_kg = 0.0;
        one.low_kg = std::max(0.0, one.found_kg - half_kg);
        one.high_kg = one.found_kg + half_kg;
        if (stretch.first > 0) one.from_s = trials[t].series.t_s[from];
        if (stretch.last < trials[t].blocks.size()) one.to_s = trials[t].series.t_s[from + frames];
        told.trials.push_back(std::move(one));
      }
    }
  }
  return told;
}

std::string found_instead(const ToldPayloads& payloads) {
  std::vector<std::pair<std::string, std::vector<std::string>>> alike;
  for (const ToldPayload& one : payloads.trials) {
    const std::string what = what_hung(one);
    auto same =
        std::find_if(alike.begin(), alike.end(), [&](const auto& other) { return other.first == what; });
    if (same == alike.end()) same = alike.insert(alike.end(), {what, {}});
    same->second.push_back(one.trial);
  }
  std::vector<std::string> said;
  for (const auto& [what, trials] : alike) said.push_back("in " + one_of(trials, "and") + what);
  return fmt::format(
      "{}. With these payloads, unseen trials are predicted to {} on average; with the stated ones, to {}. "
      "Probability of that: {}.",
      capitalised(fmt::format("{}", fmt::join(said, "; "))), millimetres(payloads.mean_m),
      millimetres(payloads.as_told_mean_m), percent(payloads.probability));
}

std::string sentence_of(const ToldPayloads& payloads) {
  return found_instead(payloads) +
         " Correct the stated payloads first; what follows holds for the payloads that were found.";
}

}  // namespace softarm::diagnose
