#include "page_data.h"

#include <algorithm>
#include <cmath>

#include "words.h"

namespace softarm::diagnose {
namespace {

/// To five significant digits: more is no more to see, and the page is a third of the size.
double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, 4 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return std::isfinite(unit) && unit > 0.0 ? std::round(value * unit) / unit : value;
}

Json list_of(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(rounded(value));
  return list;
}

Json list_of(const std::vector<std::optional<double>>& values) {
  Json list = Json::array();
  for (const std::optional<double>& value : values)
    list.push_back(value && std::isfinite(*value) ? Json(rounded(*value)) : Json());
  return list;
}

/// One list for each coordinate, as the plots want them.
Json columns_of(const std::vector<Eigen::Vector3d>& points) {
  Json columns = Json::array();
  for (int c = 0; c < 3; ++c) {
    Json column = Json::array();
    for (const Eigen::Vector3d& point : points) column.push_back(rounded(point[c]));
    columns.push_back(column);
  }
  return columns;
}

std::string unit_of(const Diagnosis& d, const std::string& input) {
  const auto unit = d.input_units.find(input);
  return unit == d.input_units.end() ? "" : unit->second;
}

Json json_of(const Diagnosis& d, const TrialCurves& trial) {
  Json json{{"name", trial.name},
            {"frames", trial.frames},
            {"rms_before", trial.rms_before_m},
            {"rms_after", trial.rms_after_m},
            {"t", list_of(trial.t_s)}};
  json["inputs"] = Json::array();
  for (const auto& [name, values] : trial.inputs)
    json["inputs"].push_back({{"name", name}, {"unit", unit_of(d, name)}, {"values", list_of(values)}});
  json["bodies"] = Json::array();
  for (const auto& [name, before] : trial.before_m) {
    Json body{{"name", name}, {"before", list_of(before)}};
    const auto after = trial.after_m.find(name);
    if (after != trial.after_m.end()) body["after"] = list_of(after->second);
    json["bodies"].push_back(body);
  }
  return json;
}

Json json_of(const AlongArm& along) {
  return {{"bodies", along.bodies},
          {"s", list_of(along.s_m)},
          {"before", columns_of(along.before_m)},
          {"after", columns_of(along.after_m)},
          {"mean_before", columns_of(along.mean_before_m)},
          {"mean_after", columns_of(along.mean_after_m)}};
}

Json json_of(const Snapshot& snapshot) {
  return {{"trial", snapshot.trial},
          {"words", snapshot.words},
          {"t", snapshot.t_s},
          {"measured", columns_of(snapshot.measured)},
          {"before", columns_of(snapshot.backbone_before)},
          {"after", columns_of(snapshot.backbone_after)}};
}

Json json_of(const Wander& wander) {
  return {{"parameter", wander.parameter},       {"unit", wander.unit},    {"against", wander.against},
          {"against_unit", wander.against_unit}, {"x", list_of(wander.x)}, {"value", list_of(wander.value)},
          {"law", list_of(wander.law)},          {"p", wander.p},          {"sentence", wander.sentence}};
}

/// What the scripts would otherwise have to put into words once more.
void add_words(Json& report, const Diagnosis& d) {
  report["headline"] = meaning(d.verdict);
  report["improvement"] = improvement(d);
  report["residual_structure"]["place"] = place(d.after.where);
  report["residual_structure_before"]["place"] = place(d.before.where);
  for (std::size_t i = 0; i < d.effects.size(); ++i) {
    Json& effect = report["effects"][i];
    effect["said"] = !d.effects[i].sentence.empty();
    effect["place"] = place(d.effects[i].where);
    effect["sure"] = percent(d.effects[i].probability);
    effect["sizes"] = Json::array();
    for (const EffectValue& value : d.effects[i].parameters)
      effect["sizes"].push_back({label(value), with_interval(value)});
  }
  for (std::size_t i = 0; i < d.ranking.size(); ++i)
    report["ranking"][i]["meaning"] = finding_words(d.ranking[i]);
}

}  // namespace

Json page_data(const Diagnosis& d) {
  Json json;
  json["report"] = report_json(d);
  add_words(json["report"], d);
  json["units"] = Json::array();
  for (const ShownUnit& unit : shown_units())
    json["units"].push_back({{"unit", unit.unit}, {"shown", unit.shown}, {"scale", unit.scale}});
  json["trials"] = Json::array();
  for (const TrialCurves& trial : d.trials) json["trials"].push_back(json_of(d, trial));
  json["along"] = json_of(d.along);
  json["snapshots"] = Json::array();
  for (const Snapshot& snapshot : d.snapshots) json["snapshots"].push_back(json_of(snapshot));
  json["wander"] = Json::array();
  for (const Wander& wander : d.wander) json["wander"].push_back(json_of(wander));
  drop_not_finite(json);
  return json;
}

}  // namespace softarm::diagnose
