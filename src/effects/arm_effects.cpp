#include "softarm/effects/arm_effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "arm/edit_distance.h"
#include "arm/effect_correlations.h"
#include "catalogue.h"
#include "drives.h"
#include "softarm/arm/arm_file.h"

namespace softarm::effects {
namespace {

/// The largest number that a parameter which numbers parts of the arm may have.
double most(const arm::Arm& arm, const model::Parameter& parameter) {
  double count = parameter.high;
  if (parameter.symbol == "body") count = static_cast<double>(arm.bodies.size());
  if (parameter.symbol == "segment") count = static_cast<double>(arm.segments.size());
  if (parameter.symbol == "input") count = static_cast<double>(arm.inputs.scalars.size());
  if (parameter.symbol == "chamber")
    count = static_cast<double>(rows_of(arm, arm::InputKind::kPressure).size());
  return std::min(count, parameter.high);
}

[[noreturn]] void fail(const arm::EffectEntry& entry, std::size_t index, const std::string& key,
                       const std::string& problem) {
  throw arm::ArmError(fmt::format("{}: key 'effects[{}].{}': {}", entry.place, index, key, problem));
}

template <typename Names>
std::string nearest(const std::string& word, const Names& names) {
  const std::optional<std::string> near = arm::yaml::nearest_word(word, names);
  return near ? fmt::format("; did you mean '{}'?", *near) : "";
}

model::Present present_of(const arm::Arm& arm, const arm::EffectEntry& entry, std::size_t index) {
  const model::Effect* effect = find(entry.id);
  if (effect == nullptr) {
    std::vector<std::string> ids;
    for (const auto& one : catalogue()) ids.push_back(one->info().id);
    fail(entry, index, "id",
         fmt::format("value '{}' is no effect of the catalogue{} (softarm diagnose --effects lists them)",
                     entry.id, nearest(entry.id, ids)));
  }
  const std::vector<model::Parameter>& parameters = effect->info().parameters;
  if (!effect->applies_to(arm))
    fail(entry, index, "id",
         fmt::format("value '{}' is not for this arm, which has nothing that it acts on", entry.id));
  std::vector<std::string> names;
  for (const model::Parameter& parameter : parameters) names.push_back(parameter.symbol);
  for (const arm::EffectNumber& number : entry.numbers) {
    if (std::find(names.begin(), names.end(), number.name) == names.end())
      fail(entry, index, "parameters." + number.name,
           fmt::format("unknown key{}; {} has {}", nearest(number.name, names), entry.id,
                       fmt::join(names, ", ")));
  }
  model::Values values(static_cast<Eigen::Index>(parameters.size()));
  model::Values sd = model::Values::Zero(values.size());
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const model::Parameter& parameter = parameters[k];
    const std::string key = "parameters." + parameter.symbol;
    const auto given =
        std::find_if(entry.numbers.begin(), entry.numbers.end(),
                     [&](const arm::EffectNumber& number) { return number.name == parameter.symbol; });
    const bool size = k < static_cast<std::size_t>(effect->info().sizes);
    const double high = parameter.counts ? most(arm, parameter) : parameter.high;
    const std::string allowed =
        fmt::format("[{:g}, {:g}]{}", parameter.low, high, parameter.unit == "1" ? "" : " " + parameter.unit);
    if (given == entry.numbers.end()) {
      if (parameter.counts && parameter.low > 0.0)
        fail(entry, index, key, fmt::format("is missing; {}; allowed: {}", parameter.description, allowed));
      values[static_cast<Eigen::Index>(k)] = size ? 0.0 : parameter.usual;
      continue;
    }
    if (!(given->value >= parameter.low && given->value <= high))
      fail(entry, index, key, fmt::format("value {} is outside the allowed range {}", given->value, allowed));
    if (parameter.counts && given->value != std::floor(given->value))
      fail(entry, index, key, fmt::format("value {} is not an integer; allowed: {}", given->value, allowed));
    if (given->sd && parameter.counts)
      fail(entry, index, "sd." + parameter.symbol,
           fmt::format("value {}: it is an index, and has no standard deviation", *given->sd));
    values[static_cast<Eigen::Index>(k)] = given->value;
    sd[static_cast<Eigen::Index>(k)] = given->sd.value_or(0.0);
  }
  return {effect, values, {}, sd};
}

Eigen::Index parameter_named(const model::Present& present, const std::string& name) {
  const std::vector<model::Parameter>& parameters = present.effect->info().parameters;
  const auto found =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const model::Parameter& parameter) { return parameter.symbol == name; });
  return found - parameters.begin();
}

/// Puts the entries' correlations into their effects.
void correlate(const std::vector<arm::EffectEntry>& entries, std::vector<model::Present>& effects) {
  const arm::CorrelatedNumbers all = arm::correlated_numbers(entries);
  if (all.numbers.empty()) return;
  for (model::Present& present : effects)
    present.correlated = Eigen::MatrixXd::Zero(present.values.size(), all.rows.cols());
  for (std::size_t i = 0; i < all.numbers.size(); ++i) {
    const arm::EffectNumberAt& at = all.numbers[i];
    model::Present& present = effects[at.entry];
    const std::string& name = entries[at.entry].numbers[at.number].name;
    present.correlated.row(parameter_named(present, name)) = all.rows.row(static_cast<Eigen::Index>(i));
  }
}

}  // namespace

std::vector<model::Present> effects_of(const arm::Arm& arm, const std::vector<arm::EffectEntry>& entries) {
  std::vector<model::Present> list;
  for (std::size_t i = 0; i < entries.size(); ++i) list.push_back(present_of(arm, entries[i], i));
  correlate(entries, list);
  return list;
}

std::vector<model::Present> load_effects(const arm::Arm& arm, const std::string& name,
                                         const std::vector<std::string>& directories) {
  const arm::ArmText file = arm::read_arm_text(name, directories);
  return effects_of(arm, arm::parse_effect_entries(file.text, file.source));
}

std::string doubt_about_effects(const std::string& name, const std::vector<std::string>& directories) {
  return doubt_about_effects(arm::read_arm_text(name, directories));
}

std::string doubt_about_effects(const arm::ArmText& file) {
  if (arm::parse_effect_entries(file.text, file.source).empty()) return "";
  const std::string verdict = arm::parse_effects_verdict(file.text, file.source).value_or("");
  const char* doubt = verdict == "unknown" ? "they help, but something else is there that is not in the model"
                      : verdict == "cannot_tell" ? "they help, but are probably not what is there"
                                                 : nullptr;
  if (doubt == nullptr) return "";
  return fmt::format("{}: the diagnosis that found its effects ended with the verdict \"{}\": {}",
                     file.source, verdict, doubt);
}

arm::EffectEntry entry_of(const model::Present& present, const std::optional<model::Values>& sd) {
  arm::EffectEntry entry;
  entry.id = present.effect->info().id;
  const std::vector<model::Parameter>& parameters = present.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    arm::EffectNumber number{parameters[k].symbol, present.values[i], std::nullopt};
    const model::Values& stated = sd ? *sd : present.sd;
    if (stated.size() > 0 && stated[i] > 0.0) number.sd = stated[i];
    number.fitted = !parameters[k].held;
    entry.numbers.push_back(std::move(number));
  }
  return entry;
}

std::vector<arm::EffectEntry> entries_of(const std::vector<model::Present>& effects) {
  std::vector<arm::EffectEntry> entries;
  for (const model::Present& present : effects) entries.push_back(entry_of(present));
  const std::vector<arm::EffectNumberAt> numbers = arm::uncertain_numbers(entries);
  // A number of an entry is a parameter of its effect.
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const arm::EffectNumberAt& of = numbers[i];
    for (std::size_t j = i + 1; j < numbers.size(); ++j) {
      const arm::EffectNumberAt& with = numbers[j];
      const double value = model::correlation(effects[of.entry], static_cast<Eigen::Index>(of.number),
                                              effects[with.entry], static_cast<Eigen::Index>(with.number));
      if (value != 0.0)
        entries[of.entry].numbers[of.number].correlations.push_back(
            {with.entry, entries[with.entry].numbers[with.number].name, value});
    }
  }
  return entries;
}

}  // namespace softarm::effects
