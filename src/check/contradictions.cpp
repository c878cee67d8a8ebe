// Settings of one report that would undo one another, were all of them followed.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "math/parse_number.h"
#include "settings.h"

namespace softarm::check {
namespace {

/// A path is the other's, or leads to it.
bool holds(const std::string& path, const std::string& other) {
  return other.compare(0, path.size(), path) == 0 &&
         (other.size() == path.size() || other[path.size()] == '.' || other[path.size()] == '[');
}

/// Whether a step gives an entry of a list another name, by which others are set.
bool renames(const SettingStep& step, const std::string& other) {
  const std::size_t end = step.path.rfind("].name");
  return end != std::string::npos && end + 6 == step.path.size() &&
         other.compare(0, end + 1, step.path, 0, end + 1) == 0;
}

/// Both set one key, to different values.
bool differ(const std::string& setting, const std::string& other) {
  for (const SettingStep& a : setting_steps(setting)) {
    for (const SettingStep& b : setting_steps(other)) {
      const bool same = a.path == b.path && a.value == b.value;
      if (!same &&
          (holds(a.path, b.path) || holds(b.path, a.path) || renames(a, b.path) || renames(b, a.path)))
        return true;
    }
  }
  return false;
}

/// What a finding spoils: figures that rest on it are right when its own setting has been followed.
struct Spoils {
  const char* first;
  std::vector<const char*> later;  ///< ids
  const char* of = "";             ///< only settings that have this
};

const std::vector<Spoils>& all_spoils() {
  static const std::vector<const char*> kPlaces{
      "stretched",    "ring_misplaced",    "base_attitude",        "base_upside_down", "gravity",
      "ring_wanders", "tangent_off",       "turned_about_tangent", "jumping_body",     "quaternion_spikes",
      "turned_over",  "noise_understated", "correlated_noise",     "tangent_backwards"};
  static const std::vector<Spoils> kAll{
      // Of other units are all lengths.
      {"length_unit", kPlaces, "_m: "},
      // Entries change their names, by which others are set.
      {"body_order", kPlaces, "bodies["},
      {"body_order", {"gravity", "base_attitude", "base_upside_down"}},
      {"length_unit", {"gravity"}},
      // Between which others it stands nobody knows.
      {"body_far_away", {"gravity", "ring_misplaced"}},
      // Shapes are fitted from the base on, and under gravity.
      {"base_upside_down", {"gravity", "ring_wanders", "tangent_off"}},
      {"base_attitude", {"gravity", "ring_wanders", "tangent_off"}},
      {"gravity", {"ring_wanders", "tangent_off", "stretched"}},
      {"other_epoch", {"clocks_apart", "clock_offset_or_lag"}},
      {"time_jump", {"clocks_apart", "clock_offset_or_lag", "stamps_ahead"}},
      {"clocks_apart", {"stamps_ahead", "clock_offset_or_lag"}},
  };
  return kAll;
}

/// The finding whose setting comes before that of `later`; null where that one may be followed at once.
const CheckFinding* before(const std::vector<CheckFinding>& findings, std::size_t later) {
  const CheckFinding& one = findings[later];
  for (const CheckFinding& first : findings) {
    for (const Spoils& spoils : all_spoils()) {
      if (first.id == spoils.first && one.setting.find(spoils.of) != std::string::npos &&
          std::find(spoils.later.begin(), spoils.later.end(), one.id) != spoils.later.end())
        return &first;
    }
  }
  for (std::size_t i = 0; i < later; ++i) {
    if (differ(findings[i].setting, one.setting)) return &findings[i];
  }
  return nullptr;
}

/// How long inputs are held is one number: that of the longest gap.
void hold_the_longest(std::vector<CheckFinding>& findings) {
  std::string longest;
  double most_s = 0.0;
  const auto only = [&](const CheckFinding& f) -> std::optional<double> {
    const std::vector<SettingStep> steps = setting_steps(f.setting);
    return steps.size() == 1 && steps[0].path == kHoldPath ? math::parse_number(steps[0].value)
                                                           : std::nullopt;
  };
  for (const CheckFinding& f : findings) {
    const auto held_s = only(f);
    if (!held_s || *held_s <= most_s) continue;
    most_s = *held_s;
    longest = f.setting;
  }
  for (CheckFinding& f : findings) {
    if (only(f)) f.setting.assign(longest);
  }
}

}  // namespace

std::vector<SettingStep> setting_steps(const std::string& setting) {
  std::vector<SettingStep> steps;
  for (std::size_t from = 0; from < setting.size();) {
    const std::size_t end = std::min(setting.find("; ", from), setting.size()),
                      colon = setting.find(": ", from);
    if (colon < end)
      steps.push_back({setting.substr(from, colon - from), setting.substr(colon + 2, end - colon - 2)});
    from = end + 2;
  }
  return steps;
}

void withhold_contradictions(std::vector<CheckFinding>& findings) {
  hold_the_longest(findings);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    if (findings[i].setting.empty()) continue;
    const CheckFinding* first = before(findings, i);
    if (!first) continue;
    findings[i].remedy += fmt::format("{}the setting depends on {}{}{}: repair that first, then check again",
                                      findings[i].remedy.empty() ? "" : "; ", first->id,
                                      first->where.empty() ? "" : " of ", first->where);
    findings[i].setting.clear();
  }
}

}  // namespace softarm::check
