// doc/effects.md has the catalogue as it is; where it has not, this prints what should be there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include "effects/catalogue.h"
#include "rig/hidden.h"

namespace softarm::effects {
namespace {

std::string heading(model::Family family) {
  switch (family) {
    case model::Family::kConstitutive:
      return "Material";
    case model::Family::kBoundary:
      return "Base";
    case model::Family::kLoad:
      return "Loads";
    case model::Family::kActuation:
      return "Actuation";
    case model::Family::kSensor:
      return "What is measured";
    case model::Family::kMemory:
      return "Memory";
  }
  return "";
}

/// Text of a table's cell: one line without a bar of its own.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

/// "live", or why not with the first numbers that it is looked for with.
std::string live(const model::Effect& effect) {
  model::Values usual(static_cast<Eigen::Index>(effect.info().parameters.size()));
  for (Eigen::Index k = 0; k < usual.size(); ++k)
    usual[k] = effect.info().parameters[static_cast<std::size_t>(k)].usual;
  const std::string obstacle = effect.live_obstacle(usual);
  return obstacle.empty() ? "yes" : "no: " + obstacle;
}

std::string tables() {
  std::ostringstream out;
  for (const auto family : {model::Family::kConstitutive, model::Family::kBoundary, model::Family::kLoad,
                            model::Family::kActuation, model::Family::kMemory, model::Family::kSensor}) {
    out << "\n### " << heading(family) << "\n\n| effect | what it is | law | live |\n|---|---|---|---|\n";
    for (const auto& effect : catalogue()) {
      const model::Info& info = effect->info();
      if (info.family != family) continue;
      out << "| `" << info.id << "` | " << cell(info.description) << " | " << cell(info.law) << " | "
          << cell(live(*effect)) << " |\n";
    }
  }
  out << "\n### Where the laws are from\n\n";
  for (const auto& effect : catalogue())
    out << "- `" << effect->info().id << "`: " << effect->info().source << "\n";
  return out.str();
}

std::string effects_page() {
  std::ifstream file(SOFTARM_SOURCE_DIR "/doc/effects.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(EffectsPage, HasTheCatalogueAsItIs) {
  const std::string page = effects_page();
  const std::string begin = "<!-- catalogue: generated -->\n", end = "<!-- end -->";
  const std::size_t from = page.find(begin), to = page.find(end);
  ASSERT_TRUE(from != std::string::npos && to != std::string::npos);
  const std::size_t first = from + begin.size();
  EXPECT_EQ(page.substr(first, to - first), tables()) << "doc/effects.md should have:\n" << tables();
}

TEST(EffectsPage, CountsTheFormsOfTheRigAndSaysOfEachWhichLawItIs) {
  const std::string page = effects_page();
  const std::size_t from = page.find("## The virtual rig's forms"), to = page.find("## The catalogue");
  ASSERT_TRUE(from != std::string::npos && to != std::string::npos && from < to);
  const std::string section = page.substr(from, to - from);
  std::map<std::size_t, int> effects_with;
  for (const auto& effect : catalogue()) {
    const std::string& id = effect->info().id;
    const rig::HiddenEffect* in_rig = rig::find_hidden_effect(id);
    if (in_rig == nullptr) continue;
    ++effects_with[std::max<std::size_t>(1, in_rig->forms.size())];
    EXPECT_NE(section.find('`' + id + '`'), std::string::npos) << id;
  }
  const int all = effects_with[1] + effects_with[2] + effects_with[3];
  EXPECT_EQ(effects_with.size(), 3U) << "there are effects with more forms";
  const std::string counts =
      fmt::format("Of the {} effects the rig has {}: {} in one form, {} in two and {} in three",
                  catalogue().size(), all, effects_with[1], effects_with[2], effects_with[3]);
  EXPECT_NE(section.find(counts), std::string::npos) << "doc/effects.md should have: " << counts;
}

}  // namespace
}  // namespace softarm::effects
