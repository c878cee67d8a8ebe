#include "effects_list.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "rig/hidden.h"

namespace softarm::app {
namespace {

const std::map<std::string, std::string>& units() {
  static const std::map<std::string, std::string> words{
      {"m", "m"},     {"mm", "mm"},  {"s", "s"},       {"s2", "s^2"},    {"n", "N"},    {"nm", "N m"},
      {"m2", "m^2"},  {"m3", "m^3"}, {"nm2", "N m^2"}, {"kg", "kg"},     {"pa", "Pa"},  {"rad", "rad"},
      {"deg", "deg"}, {"hz", "Hz"},  {"w", "W"},       {"k", "K"},       {"c", "degC"}, {"g", "g"},
      {"ppm", "ppm"}, {"j", "J"},    {"kpa", "kPa"},   {"percent", "%"}, {"m4", "m^4"}};
  return words;
}

std::string default_of(const rig::HiddenParameter& parameter) {
  return parameter.otherwise ? fmt::format("default {:g}", *parameter.otherwise) : "required";
}

std::string forms_of(const rig::HiddenParameter& parameter) {
  return parameter.of_forms.empty() ? ""
                                    : fmt::format(", with form {}", fmt::join(parameter.of_forms, " or "));
}

}  // namespace

std::string unit_of_key(const std::string& key) {
  std::vector<std::string> parts(1);
  for (char c : key)
    if (c == '_')
      parts.emplace_back();
    else
      parts.back() += c;
  // From the end: units, and `per` between them. The first word is never a unit: it names the quantity.
  std::size_t first = parts.size();
  while (first > 1 && (units().count(parts[first - 1]) > 0 || parts[first - 1] == "per")) --first;
  std::string unit;
  for (bool per = false; first < parts.size(); ++first) {
    if (parts[first] == "per") {
      per = true;
      if (unit.empty()) unit = "1";
      continue;
    }
    if (!unit.empty()) unit += per ? "/" : " ";
    unit += units().at(parts[first]);
    per = false;
  }
  return unit.empty() ? "1" : unit;
}

std::string effects_list() {
  std::string text =
      "What a scenario's list `hidden` can contain: {effect: ID, form: FORM, PARAMETER: value, ...}. Several "
      "at once; the\nfirst form is the default. Parameters: unit, [allowed], usual in real arms, default.\n";
  for (const rig::HiddenEffect& effect : rig::hidden_effects()) {
    text += fmt::format("\n{} ({})\n  {}\n", effect.id,
                        effect.catalogued ? "catalogue" : "not in the catalogue", effect.words);
    if (!effect.forms.empty()) text += fmt::format("  form: {}\n", fmt::join(effect.forms, " | "));
    for (const rig::HiddenParameter& parameter : effect.parameters) {
      const std::string unit = parameter.whole ? "whole" : unit_of_key(parameter.key);
      text += fmt::format("  {:<28} {:<8} [{:g}, {:g}], {:g} ... {:g}, {}{}: {}\n", parameter.key, unit,
                          parameter.low, parameter.high, parameter.usual_low, parameter.usual_high,
                          default_of(parameter), forms_of(parameter), parameter.words);
    }
  }
  return text;
}

}  // namespace softarm::app
