#include <nlohmann/json.hpp>

#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ShapeError& e) {
  return {{"frames", e.frames},
          {"mean_m", e.mean_m},
          {"median_m", e.median_m},
          {"maximum_m", e.maximum_m},
          {"minimum_m", e.minimum_m},
          {"mean_percent", e.percent(e.mean_m)},
          {"median_percent", e.percent(e.median_m)},
          {"maximum_percent", e.percent(e.maximum_m)},
          {"minimum_percent", e.percent(e.minimum_m)}};
}

Json json_of(const std::vector<TrialSummary>& trials) {
  Json list = Json::array();
  for (const TrialSummary& trial : trials) {
    list.push_back({{"name", trial.name},
                    {"held_out", trial.held_out},
                    {"frames", trial.frames},
                    {"before", json_of(trial.before)},
                    {"after", json_of(trial.after)}});
  }
  return list;
}

Json json_of(const InputErrors& one) {
  Json json{{"input", one.input},
            {"unit", one.unit},
            {"noise_sd", one.noise_sd},
            {"stated", one.stated},
            {"at_bodies_m", one.at_bodies_m},
            {"zero_sd", one.zero_sd}};
  json["zeros"] = Json::array();
  for (const FittedZero& zero : one.zeros)
    json["zeros"].push_back({{"trial", zero.trial}, {"value", zero.value}, {"sd", zero.sd}});
  json["confused_with"] = one.confused_with;
  return json;
}

Json parts_of(const std::vector<std::pair<std::string, double>>& list) {
  Json object = Json::object();
  for (const auto& [name, value] : list) object[name] = value;
  return object;
}

Json json_of(const std::vector<EffectStart>& starts) {
  Json list = Json::array();
  for (const EffectStart& s : starts)
    list.push_back({{"trial", s.trial},
                    {"effect", s.effect},
                    {"of", s.of},
                    {"value", s.value},
                    {"sd", s.sd},
                    {"unit", s.unit}});
  return list;
}

Json json_of(const std::vector<WallStart>& starts) {
  Json list = Json::array();
  for (const WallStart& s : starts)
    list.push_back({{"trial", s.trial},
                    {"segment", s.segment},
                    {"element", s.element},
                    {"value", s.value},
                    {"sd", s.sd},
                    {"unit", s.unit}});
  return list;
}

Json json_of(const arm::LawPrior& prior) {
  return {{"moment_sd_nm", prior.moment_sd_nm},
          {"moment_sd_rel", prior.moment_sd_rel},
          {"bending_stiffness_sd_rel", prior.bending_stiffness_sd_rel},
          {"length_sd_m", prior.length_sd_m},
          {"axial_stiffness_sd_rel", prior.axial_stiffness_sd_rel},
          {"moment_jitter_sd_nm", prior.moment_jitter_sd_nm},
          {"length_jitter_sd_m", prior.length_jitter_sd_m}};
}

}  // namespace

std::string to_json(const Result& result) {
  Json json;
  json["format"] = 1;
  json["arm"] = result.arm.name;
  json["constants"] = Json::array();
  for (const Constant& c : result.constants) {
    Json one{{"name", c.name}, {"unit", c.unit},   {"initial", c.initial},       {"value", c.value},
             {"sd", c.sd},     {"scale", c.scale}, {"determined", c.determined}, {"at_bound", c.at_bound}};
    if (c.at_bound) one["ran_to"] = c.ran_to;
    one["kept"] = c.kept;
    one["confused_with"] = parts_of(c.confused_with);
    one["advice"] = c.advice;
    json["constants"].push_back(one);
  }
  json["correlation"] = Json::array();
  for (int j = 0; j < result.correlation.rows(); ++j) {
    Json row = Json::array();
    for (int k = 0; k < result.correlation.cols(); ++k) row.push_back(result.correlation(j, k));
    json["correlation"].push_back(row);
  }
  json["undetermined"] = Json::array();
  for (const Combination& combination : result.undetermined) {
    json["undetermined"].push_back({{"relative_sd", combination.relative_sd},
                                    {"parts", parts_of(combination.parts)},
                                    {"sentence", combination.sentence}});
  }
  json["verdict"] = verdict(result);
  if (const auto good = generalises(result)) json["generalises"] = *good;
  json["length_m"] = result.fitted.length_m;
  json["fitted_before"] = json_of(result.fitted_before);
  json["fitted"] = json_of(result.fitted);
  json["held_out_before"] = json_of(result.held_out_before);
  json["held_out"] = json_of(result.held_out);
  json["trials"] = json_of(result.trials);
  if (!result.left_out_one.empty()) {
    json["leave_one_out"] = {{"before", json_of(result.left_out_one_before)},
                             {"after", json_of(result.left_out_one_after)},
                             {"trials", json_of(result.left_out_one)}};
  }
  json["starts"] = json_of(result.starts);
  json["effect_starts"] = json_of(result.effect_starts);
  json["prior"] = json_of(result.prior);
  json["fit"] = {{"frames", result.frames},
                 {"bodies", result.bodies},
                 {"iterations", result.iterations},
                 {"converged", result.converged},
                 {"misfit", result.misfit},
                 {"position_rms_m", result.position_rms_m},
                 {"autocorrelation_frames", result.autocorrelation},
                 {"uncertainty_factor", result.uncertainty_factor}};
  json["fit"]["noise_share"] = result.noise_share;
  json["inputs"] = Json::array();
  for (const InputErrors& one : result.input_errors) json["inputs"].push_back(json_of(one));
  json["unmeasured_inputs"] = result.unmeasured_inputs;
  json["left_out"] = result.left_out;
  json["bodies_set_aside"] = result.bodies_set_aside;
  json["beyond_the_model"] = result.beyond_the_model;
  json["warnings"] = result.warnings;
  json["prior_notes"] = result.prior_notes;
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

}  // namespace softarm::identify
