// Effects beyond the laws, as they stand in the file.
#include <fmt/format.h>

#include <algorithm>

#include "arm_parts.h"
#include "edit_distance.h"
#include "effect_correlations.h"

namespace softarm::arm::yaml {
namespace {

/// Puts them into the entries.
void read_correlations(const Section& arm, std::vector<EffectEntry>& entries) {
  const std::vector<EffectNumberAt> uncertain = uncertain_numbers(entries);
  std::vector<std::string> names;
  for (const EffectNumberAt& at : uncertain)
    names.push_back(name_in_file(entries, at.entry, entries[at.entry].numbers[at.number].name));
  const auto named = [&](const Section& row, const char* key, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::optional<std::string> near = nearest_word(name, names);
      row.fail(key, fmt::format("{} is no parameter with a standard deviation (sd) of these effects{}", name,
                                near ? fmt::format("; did you mean '{}'?", *near) : ""));
    }
    return uncertain[static_cast<std::size_t>(found - names.begin())];
  };
  for (const Section& row : arm.list("effects_correlations", correlation_keys())) {
    const EffectNumberAt of = named(row, "of", row.name("of", "."));
    for (const auto& [name, value] : row.numbers("with", ".")) {
      const EffectNumberAt with = named(row, "with", name);
      entries[of.entry].numbers[of.number].correlations.push_back(
          {with.entry, entries[with.entry].numbers[with.number].name, value, row.place()});
    }
  }
  correlated_numbers(entries);  // refuses what cannot be
}

}  // namespace

std::vector<EffectEntry> read_effects(const Section& arm) {
  std::vector<EffectEntry> list;
  for (const Section& section : arm.list("effects", effect_keys())) {
    EffectEntry entry;
    entry.id = section.name("id");
    entry.place = section.place();
    for (const auto& [name, value] : section.numbers("parameters"))
      entry.numbers.push_back({name, value, {}});
    for (const auto& [name, sd] : section.numbers("sd")) {
      const auto found = std::find_if(entry.numbers.begin(), entry.numbers.end(),
                                      [&, key = name](const EffectNumber& n) { return n.name == key; });
      if (found == entry.numbers.end())
        section.fail("sd", fmt::format("{} is none of the parameters given above it", name));
      if (!(sd >= 0.0)) section.fail("sd", fmt::format("{}: value {} is below 0", name, sd));
      found->sd = sd;
    }
    list.push_back(std::move(entry));
  }
  read_correlations(arm, list);
  return list;
}

std::optional<std::string> read_effects_verdict(const Section& arm) {
  if (!arm.has("effects_verdict")) return std::nullopt;
  return arm.word("effects_verdict");
}

}  // namespace softarm::arm::yaml
