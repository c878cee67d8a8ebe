// report.json: the keys of doc/diagnose.md; more may follow, those keep their meaning.
#include <cmath>

#include "diagnose/sentences.h"
#include "json.h"

namespace softarm::report {
namespace {

Json json_of(const diagnose::Where& where) {
  Json json = Json::object();
  if (where.s_from_m) json["s_from"] = *where.s_from_m;
  if (where.s_to_m) json["s_to"] = *where.s_to_m;
  if (!where.axis.empty()) json["axis"] = where.axis;
  if (!where.when.empty()) json["when"] = where.when;
  if (!where.input.empty()) json["input"] = where.input;
  return json;
}

Json json_of(const diagnose::Fit& fit) {
  return {{"rms_m", fit.plain_rms_m},
          {"held_out_rms_m", fit.held_out_plain_rms_m},
          {"held_out_mean_m", fit.held_out_mean_m},
          {"held_out_max_m", fit.held_out_max_m},
          {"weighted_rms_m", fit.rms_m},
          {"held_out_weighted_rms_m", fit.held_out_rms_m},
          {"held_out_log_score", fit.held_out_log_score}};
}

Json json_of(const diagnose::EffectValue& value) {
  Json json{{"value", value.value}, {"unit", value.unit}};
  if (value.fitted) {
    json["low"] = value.low;
    json["high"] = value.high;
  } else {
    json["fitted"] = false;
  }
  if (!value.description.empty()) json["description"] = value.description;
  return json;
}

Json json_of(const diagnose::NamedEffect& effect) {
  Json json{{"name", effect.id}, {"probability", effect.probability}};
  json["parameters"] = Json::object();
  for (const diagnose::EffectValue& value : effect.parameters)
    json["parameters"][value.symbol] = json_of(value);
  json["where"] = json_of(effect.where);
  json["held_out_gain"] = effect.held_out_gain_m;
  json["share"] = effect.share;
  json["confusable_with"] = effect.confusable_with;
  json["sentence"] = diagnose::sentence_of(effect);
  json["description"] = effect.description;
  return json;
}

Json json_of(const diagnose::Candidate& candidate) {
  Json json{{"name", candidate.id},
            {"probability", candidate.probability},
            {"collinearity", candidate.collinearity},
            {"detectable", candidate.detectable},
            {"description", candidate.description},
            {"finding", to_string(candidate.finding)}};
  if (candidate.finding == diagnose::Finding::kNotOfThisArm) return json;  // it was not looked for
  json["z"] = candidate.z;
  json["size_m"] = candidate.size_m;
  if (!candidate.symbol.empty()) {
    json["symbol"] = candidate.symbol;
    json["unit"] = candidate.unit;
    json["estimate"] = candidate.estimate;
    json["smallest_detectable"] = candidate.smallest_detectable;
  }
  if (candidate.log_score) json["held_out_log_score_gain"] = *candidate.log_score;
  return json;
}

Json json_of(const diagnose::LawTerm& term) {
  Json json{{"goes_with", term.goes_with},
            {"unit", term.unit},
            {"from", term.from},
            {"to", term.to},
            {"x_nm", json_of(term.x_nm)},
            {"y_nm", json_of(term.y_nm)},
            {"has_direction", term.has_direction},
            {"rises", term.rises},
            {"stability", term.stability},
            {"sentence", term.sentence}};
  // Each term has letters of its own, so that there is no one equation of all.
  if (!term.law.empty()) {
    json["equation"] = term.law;
    json["symbols"] = term.symbols;
  }
  if (!term.source.empty()) json["source"] = term.source;
  return json;
}

Json json_of(const diagnose::DiscoveredLaw& law) {
  Json json{{"terms", Json::array()},
            {"held_out_mean_before_m", law.held_out_mean_before_m},
            {"held_out_mean_after_m", law.held_out_mean_after_m},
            {"held_out_max_before_m", law.held_out_max_before_m},
            {"held_out_max_after_m", law.held_out_max_after_m},
            {"share", law.share},
            {"sequences", law.sequences},
            {"sentence", law.sentence}};
  for (const diagnose::LawTerm& term : law.terms) json["terms"].push_back(json_of(term));
  if (!law.source.empty()) json["source"] = law.source;
  if (law.share_of_flexible) json["share_of_flexible"] = *law.share_of_flexible;
  if (!law.resembles.empty()) json["resembles"] = {{"name", law.resembles}, {"cosine", law.cosine}};
  return json;
}

Json json_of(const diagnose::Structure& structure) {
  Json by_input = Json::object();
  for (const auto& [input, p] : structure.by_input_p) by_input[input] = p;
  return {{"whiteness_p", structure.whiteness_p},
          {"where", json_of(structure.where)},
          {"along_s_p", structure.along_s_p},
          {"chi2_per_dof", structure.chi2_per_dof},
          {"shared_m", structure.shared_m},
          {"shared_z", structure.shared_z},
          {"by_input_p", by_input}};
}

Json json_of(const diagnose::Shift& shift) {
  return {{"name", shift.name},           {"unit", shift.unit},   {"before", shift.before},
          {"sd_before", shift.sd_before}, {"after", shift.after}, {"sd_after", shift.sd_after}};
}

Json json_of(const diagnose::NextExperiment& next) {
  Json json{{"action", next.action},
            {"separates", next.separates},
            {"expected_separation", next.expected_separation},
            {"today", next.today}};
  if (!next.sentence.empty()) json["sentence"] = next.sentence;
  json["menu"] = Json::array();
  for (const diagnose::WeighedExperiment& one : next.menu) {
    Json item{{"action", one.action}, {"separation", one.separation}};
    if (!one.hardest.empty()) item["hardest"] = one.hardest;
    if (!one.shows.empty()) item["shows"] = one.shows;
    json["menu"].push_back(item);
  }
  return json;
}

Json json_of(const diagnose::Rung& rung) {
  return {{"id", rung.id},
          {"description", rung.description},
          {"unknowns", rung.unknowns},
          {"rms_m", rung.rms_m},
          {"chi2_per_dof", rung.chi2_per_dof}};
}

Json json_of(const Origin& origin) {
  Json json{{"command", origin.command}, {"date", origin.date}, {"files", Json::array()}};
  for (const auto& [name, sha256] : origin.sha256)
    json["files"].push_back({{"name", name}, {"sha256", sha256}});
  return json;
}

Json json_of(const diagnose::ToldPayloads& payloads) {
  Json trials = Json::array();
  for (const diagnose::ToldPayload& one : payloads.trials) {
    trials.push_back({{"trial", one.trial},
                      {"told_kg", one.told_kg},
                      {"found_kg", one.found_kg},
                      {"low_kg", one.low_kg},
                      {"high_kg", one.high_kg}});
    if (one.from_s) trials.back()["from_s"] = *one.from_s;
    if (one.to_s) trials.back()["to_s"] = *one.to_s;
  }
  return {{"trials", std::move(trials)},
          {"as_told_held_out_mean_m", payloads.as_told_mean_m},
          {"held_out_mean_m", payloads.mean_m},
          {"probability", payloads.probability}};
}

}  // namespace

Json report_json(const diagnose::Diagnosis& d, const Origin& origin) {
  Json json{{"format", 1}, {"verdict", to_string(d.verdict)}, {"noise_floor_m", d.noise_floor_m}};
  json["baseline"] = json_of(d.baseline);
  json["extended"] = json_of(d.extended);
  json["left_out_share"] = d.left_out_share;
  if (d.exchanged_names)
    json["exchanged_names"] = {{"said", d.exchanged_names->said},
                               {"seen", d.exchanged_names->seen},
                               {"trials", d.exchanged_names->trials}};
  if (d.told_payloads) json["told_payloads"] = json_of(*d.told_payloads);
  json["length_m"] = d.extended_arm.arm.total_length_m();
  json["discrepancy_share"] = d.discrepancy_share;
  json["effects"] = Json::array();
  for (const diagnose::NamedEffect& effect : d.effects) json["effects"].push_back(json_of(effect));
  json["small_departures"] = Json::array();
  for (const diagnose::NamedEffect& effect : d.small_departures)
    json["small_departures"].push_back(json_of(effect));
  json["stand_ins"] = Json::array();
  for (const diagnose::NamedEffect& effect : d.stand_ins) json["stand_ins"].push_back(json_of(effect));
  if (d.discovered_law) json["discovered_law"] = json_of(*d.discovered_law);
  json["ranking"] = Json::array();
  for (const diagnose::Candidate& candidate : d.ranking) json["ranking"].push_back(json_of(candidate));
  json["residual_structure"] = json_of(d.after);
  if (d.next_experiment) json["next_experiment"] = json_of(*d.next_experiment);
  if (!d.ladder.empty()) {
    json["ladder"] = {{"rungs", Json::array()}, {"sentence", d.ladder_sentence}};
    for (const diagnose::Rung& rung : d.ladder) json["ladder"]["rungs"].push_back(json_of(rung));
  }
  json["parameter_variation"] = Json::array();
  for (const diagnose::ParameterVariation& variation : d.parameter_variation) {
    Json item{{"parameter", variation.parameter}, {"against", variation.against}, {"p", variation.p}};
    if (!variation.sentence.empty()) item["sentence"] = variation.sentence;
    json["parameter_variation"].push_back(item);
  }

  json["arm"] = d.arm;
  if (!d.version.empty()) json["version"] = d.version;
  if (!origin.command.empty()) json["origin"] = json_of(origin);
  json["summary"] = d.summary;
  if (d.ceiling_rms_m > 0.0) {
    json["ceiling_rms_m"] = d.ceiling_rms_m;
    json["explained_share"] = d.explained_share;
  }
  json["residual_structure_before"] = json_of(d.before);
  json["shifts"] = Json::array();
  for (const diagnose::Shift& shift : d.shifts) json["shifts"].push_back(json_of(shift));
  json["trials"] = Json::array();
  for (const diagnose::TrialCurves& trial : d.trials) {
    json["trials"].push_back({{"name", trial.name},
                              {"frames", trial.frames},
                              {"held_out_rms_before_m", trial.rms_before_m},
                              {"held_out_rms_after_m", trial.rms_after_m},
                              {"held_out_mean_before_m", trial.mean_before_m},
                              {"held_out_mean_after_m", trial.mean_after_m},
                              {"held_out_max_before_m", trial.max_before_m},
                              {"held_out_max_after_m", trial.max_after_m}});
  }
  json["notes"] = d.notes;
  drop_not_finite(json);
  return json;
}

void drop_not_finite(Json& json) {
  const auto bad = [](const Json& value) {
    return value.is_number_float() && !std::isfinite(value.get<double>());
  };
  if (json.is_object()) {
    for (auto item = json.begin(); item != json.end();) {
      if (bad(*item)) {
        item = json.erase(item);
      } else {
        drop_not_finite(*item++);
      }
    }
  } else if (json.is_array()) {
    for (Json& value : json) {
      if (bad(value))
        value = nullptr;
      else
        drop_not_finite(value);
    }
  }
}

std::string dump(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const diagnose::Diagnosis& diagnosis, const Origin& origin) {
  return dump(report_json(diagnosis, origin), 2) + "\n";
}

}  // namespace softarm::report
