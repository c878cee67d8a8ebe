// Effects beyond the laws, as they stand in the file.
#include <fmt/format.h>

#include <algorithm>

#include "arm_parts.h"

namespace softarm::arm::yaml {

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
  return list;
}

std::optional<std::string> read_effects_verdict(const Section& arm) {
  if (!arm.has("effects_verdict")) return std::nullopt;
  return arm.word("effects_verdict");
}

}  // namespace softarm::arm::yaml
