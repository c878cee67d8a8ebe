// A diagnosis whose every name tries to break out of the page.
#pragma once

#include <map>
#include <string>

#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose::testing {

inline constexpr const char* kHostile =
    "</script><img src=x onerror=alert(1)><a href=\"javascript:alert(2)\">%{x}</a><!--<script>alert(3)"
    "\xE2\x80\xA8'\"&lt;b&gt;\xff";

template <class Values>
void rename_keys(std::map<std::string, Values>& named) {
  std::map<std::string, Values> renamed;
  for (const auto& [name, values] : named) renamed[kHostile + name] = values;
  named = renamed;
}

/// Everything in it that comes, or may come, out of bags and files.
inline void rename_all(diagnose::Diagnosis& d) {
  const std::string evil = kHostile;
  d.arm = d.extended_text = d.next_command = evil;
  d.summary = evil;
  d.notes.push_back(evil);
  for (diagnose::NamedEffect& effect : d.effects) {
    effect.description = effect.where.input = effect.where.when = effect.law = effect.source = evil;
    effect.confusable_with = {evil, "__proto__"};
  }
  for (std::vector<diagnose::NamedEffect>* list : {&d.small_departures, &d.stand_ins})
    for (diagnose::NamedEffect& effect : *list) effect.description = effect.where.when = evil;
  d.discovered_law->sentence = d.discovered_law->resembles = d.discovered_law->source = evil;
  for (diagnose::LawTerm& term : d.discovered_law->terms)
    term.goes_with = term.unit = term.sentence = term.x_nm.description = term.law = term.symbols =
        term.source = evil;
  for (diagnose::Candidate& candidate : d.ranking)
    candidate.description = candidate.symbol = candidate.unit = evil;
  for (diagnose::Shift& shift : d.shifts) shift.name += evil;
  for (std::size_t i = 0; i < d.trials.size(); ++i) {
    d.trials[i].name = evil + " " + std::to_string(i);
    rename_keys(d.trials[i].inputs);
    rename_keys(d.trials[i].before_m);
    rename_keys(d.trials[i].after_m);
  }
  rename_keys(d.input_units);
  rename_keys(d.before.by_input_p);
  d.after.by_input_p["__proto__"] = 0.5;
  d.after.by_input_p["constructor"] = 0.5;
  for (std::string& body : d.along.bodies) body += evil;
  for (diagnose::Snapshot& snapshot : d.snapshots) snapshot.trial = snapshot.description = evil;
  for (diagnose::ParameterVariation& variation : d.parameter_variation)
    variation.against = variation.parameter = variation.unit = variation.sentence = evil;
  d.next_experiment->action = d.next_experiment->sentence = d.ladder_sentence = evil;
  for (diagnose::WeighedExperiment& one : d.next_experiment->menu) {
    one.action = evil;
    one.hardest = {evil};
  }
  d.next_experiment->separates = {evil};
}

}  // namespace softarm::diagnose::testing
