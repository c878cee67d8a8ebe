#include "page_data.h"

#include <algorithm>
#include <cmath>

#include "diagnose/sentences.h"

namespace softarm::report {
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

/// Of what may not have been seen: one list for each coordinate.
Json columns_of(const std::vector<std::optional<Eigen::Vector3d>>& points) {
  Json columns = Json::array();
  for (int c = 0; c < 3; ++c) {
    std::vector<std::optional<double>> column;
    for (const std::optional<Eigen::Vector3d>& point : points)
      column.push_back(point ? std::optional<double>((*point)[c]) : std::nullopt);
    columns.push_back(list_of(column));
  }
  return columns;
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

std::string unit_of(const diagnose::Diagnosis& d, const std::string& input) {
  const auto unit = d.input_units.find(input);
  return unit == d.input_units.end() ? "" : unit->second;
}

Json json_of(const diagnose::Snapshot& snapshot) {
  return {{"trial", snapshot.trial},
          {"description", snapshot.description},
          {"t", rounded(snapshot.t_s)},
          {"measured", columns_of(snapshot.measured)},
          {"before", columns_of(snapshot.backbone_before)},
          {"after", columns_of(snapshot.backbone_after)},
          {"bodies_before", columns_of(snapshot.bodies_before)},
          {"bodies_after", columns_of(snapshot.bodies_after)}};
}

Json json_of(const diagnose::Diagnosis& d, const diagnose::TrialCurves& trial) {
  Json json{{"name", trial.name},
            {"frames", trial.frames},
            {"mean_before", trial.mean_before_m},
            {"mean_after", trial.mean_after_m},
            {"max_before", trial.max_before_m},
            {"max_after", trial.max_after_m},
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
  json["tip"] = {{"measured", columns_of(trial.tip_measured_m)},
                 {"before", columns_of(trial.tip_before_m)},
                 {"after", columns_of(trial.tip_after_m)}};
  json["film"] = Json::array();
  for (const diagnose::Snapshot& snapshot : trial.film) json["film"].push_back(json_of(snapshot));
  return json;
}

Json json_of(const diagnose::AlongArm& along) {
  return {{"bodies", along.bodies},
          {"s", list_of(along.s_m)},
          {"before", columns_of(along.before_m)},
          {"after", columns_of(along.after_m)},
          {"mean_before", columns_of(along.mean_before_m)},
          {"mean_after", columns_of(along.mean_after_m)}};
}

Json json_of(const diagnose::ParameterVariation& variation) {
  return {{"parameter", variation.parameter}, {"unit", variation.unit},
          {"against", variation.against},     {"against_unit", variation.against_unit},
          {"x", list_of(variation.x)},        {"value", list_of(variation.value)},
          {"law", list_of(variation.law)},    {"p", variation.p},
          {"sentence", variation.sentence}};
}

/// What the scripts would otherwise have to put into words once more.
void add_description(Json& report, const diagnose::Diagnosis& d) {
  report["headline"] = diagnose::headline(d);
  report["narrow_range"] = d.narrow_range;
  report["improvement"] = diagnose::improvement(d);
  report["extended_text"] = d.extended_text;
  report["next_command"] = d.next_command;
  report["residual_structure"]["place"] = place(d.after.where);
  report["residual_structure_before"]["place"] = place(d.before.where);
  for (std::size_t i = 0; i < d.effects.size(); ++i) {
    Json& effect = report["effects"][i];
    effect["said"] = !d.effects[i].sentence.empty();
    effect["place"] = place(d.effects[i].where);
    effect["law"] = d.effects[i].law;
    effect["source"] = d.effects[i].source;
    effect["sure"] = diagnose::percent(d.effects[i].probability);
    effect["sizes"] = Json::array();
    for (const diagnose::EffectValue& value : d.effects[i].parameters)
      effect["sizes"].push_back({label(value), diagnose::with_interval(value)});
  }
  if (d.discovered_law) {
    const std::vector<diagnose::LawTerm>& terms = d.discovered_law->terms;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      Json& term = report["discovered_law"]["terms"][i];
      term["sizes"] = {diagnose::with_interval(terms[i].x_nm), diagnose::with_interval(terms[i].y_nm)};
      term["range"] = {diagnose::with_unit(terms[i].from, terms[i].unit),
                       diagnose::with_unit(terms[i].to, terms[i].unit)};
      term["sure"] = diagnose::percent(terms[i].stability);
    }
  }
  for (std::size_t i = 0; i < d.ranking.size(); ++i) {
    report["ranking"][i]["meaning"] = diagnose::finding_description(d.ranking[i]);
    report["ranking"][i]["source"] = diagnose::source_of(d.ranking[i]);
  }
}

}  // namespace

Json page_data(const diagnose::Diagnosis& d, const Origin& origin) {
  Json json;
  json["report"] = report_json(d, origin);
  add_description(json["report"], d);
  json["units"] = Json::array();
  for (const diagnose::ShownUnit& unit : diagnose::shown_units())
    json["units"].push_back({{"unit", unit.unit}, {"shown", unit.shown}, {"scale", unit.scale}});
  json["trials"] = Json::array();
  for (const diagnose::TrialCurves& trial : d.trials) json["trials"].push_back(json_of(d, trial));
  json["along"] = json_of(d.along);
  json["snapshots"] = Json::array();
  for (const diagnose::Snapshot& snapshot : d.snapshots) json["snapshots"].push_back(json_of(snapshot));
  json["parameter_variation"] = Json::array();
  for (const diagnose::ParameterVariation& variation : d.parameter_variation)
    json["parameter_variation"].push_back(json_of(variation));
  drop_not_finite(json);
  return json;
}

}  // namespace softarm::report
