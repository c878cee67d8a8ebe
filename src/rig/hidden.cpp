#include "hidden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hidden_tables.h"
#include "scenario.h"
#include "scenario_parts.h"

namespace softarm::rig {
namespace {

std::string ids() {
  std::vector<std::string> names;
  for (const HiddenEffect& effect : hidden_effects()) names.push_back(effect.id);
  return fmt::format("{}", fmt::join(names, ", "));
}

void check(const HiddenChoice& choice) {
  const HiddenEffect* effect = find_hidden_effect(choice.effect);
  if (!effect)
    throw std::invalid_argument(fmt::format("effect {}: unknown, allowed are {}", choice.effect, ids()));
  const bool has_form = effect->forms.empty()
                            ? choice.form.empty()
                            : std::count(effect->forms.begin(), effect->forms.end(), choice.form) > 0;
  if (!has_form)
    throw std::invalid_argument(fmt::format("effect {}: form {}, allowed {}", effect->id, choice.form,
                                            effect->forms.empty()
                                                ? "none: it has one form only"
                                                : fmt::format("{}", fmt::join(effect->forms, ", "))));
  for (const HiddenParameter& parameter : effect->parameters) {
    if (!parameter.is_of(choice.form)) continue;
    const auto value = choice.values.find(parameter.key);
    if (value == choice.values.end())
      throw std::invalid_argument(fmt::format("effect {}: {} is missing", effect->id, parameter.key));
    if (!(value->second >= parameter.low && value->second <= parameter.high))
      throw std::invalid_argument(fmt::format("effect {}: {} is {}, allowed {} ... {}", effect->id,
                                              parameter.key, value->second, parameter.low, parameter.high));
    if (parameter.whole && value->second != std::round(value->second))
      throw std::invalid_argument(fmt::format("effect {}: {} is {}, allowed are whole numbers {} ... {}",
                                              effect->id, parameter.key, value->second, parameter.low,
                                              parameter.high));
  }
}

}  // namespace

bool HiddenParameter::is_of(const std::string& form) const {
  return of_forms.empty() || std::count(of_forms.begin(), of_forms.end(), form) > 0;
}

const std::vector<HiddenEffect>& hidden_effects() {
  static const std::vector<HiddenEffect> all = [] {
    std::vector<HiddenEffect> effects;
    for (const auto& part : {body_effects(), input_effects(), sensor_effects()})
      effects.insert(effects.end(), part.begin(), part.end());
    return effects;
  }();
  return all;
}

const HiddenEffect* find_hidden_effect(const std::string& id) {
  const std::vector<HiddenEffect>& all = hidden_effects();
  const auto found = std::find_if(all.begin(), all.end(), [&](const HiddenEffect& e) { return e.id == id; });
  return found == all.end() ? nullptr : &*found;
}

void hide(HiddenChoice choice, Scenario& scenario) {
  // Truths that were sealed before a parameter was there do not have it.
  if (const HiddenEffect* effect = find_hidden_effect(choice.effect))
    for (const HiddenParameter& parameter : effect->parameters)
      if (parameter.otherwise && parameter.is_of(choice.form))
        choice.values.emplace(parameter.key, *parameter.otherwise);
  check(choice);
  find_hidden_effect(choice.effect)->apply(choice, scenario);
  scenario.hidden.push_back(std::move(choice));
}

void parse_hidden(YamlMap& document, Scenario& scenario) {
  for (YamlMap& item : document.maps("hidden")) {
    HiddenChoice choice;
    choice.effect = item.word("effect");
    const HiddenEffect* effect = find_hidden_effect(choice.effect);
    if (!effect) item.fail("effect", fmt::format("value {}, allowed {}", choice.effect.substr(0, 60), ids()));
    if (!effect->forms.empty()) {
      choice.form = item.has("form") ? item.word("form") : effect->forms.front();
      if (std::count(effect->forms.begin(), effect->forms.end(), choice.form) == 0)
        item.fail("form", fmt::format("value {}, allowed {}", choice.form.substr(0, 60),
                                      fmt::join(effect->forms, ", ")));
    }
    for (const HiddenParameter& parameter : effect->parameters)
      if (!parameter.is_of(choice.form) && item.has(parameter.key))
        item.fail(parameter.key, fmt::format("not of form {}, allowed with form {}", choice.form,
                                             fmt::join(parameter.of_forms, ", ")));
    for (const HiddenParameter& parameter : effect->parameters) {
      if (!parameter.is_of(choice.form)) continue;
      const Allowed allowed{parameter.low, parameter.high};
      choice.values[parameter.key] = parameter.otherwise
                                         ? item.number(parameter.key, allowed, *parameter.otherwise)
                                         : item.number(parameter.key, allowed);
    }
    item.finish();
    try {
      hide(choice, scenario);
    } catch (const std::invalid_argument& error) {
      item.fail("effect", error.what());
    }
  }
}

}  // namespace softarm::rig
