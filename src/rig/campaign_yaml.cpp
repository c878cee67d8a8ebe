// The parser of campaigns.
#include <fmt/format.h>

#include <algorithm>

#include "scenario_parts.h"
#include "softarm/rig/campaign.h"

namespace softarm::rig {
namespace {

Span span(YamlMap& map, const std::string& key, Allowed allowed, const Span& otherwise) {
  if (!map.has(key)) return otherwise;
  if (!map.is_list(key)) {
    const double value = map.number(key, allowed);
    return {value, value};
  }
  const std::vector<double> ends = map.numbers(key, allowed, 2, 2);
  if (!(ends[0] <= ends[1]))
    map.fail(key, fmt::format("value [{}, {}], the first must not be larger", ends[0], ends[1]));
  return {ends[0], ends[1]};
}

/// Ids, or the names of groups: catalogue, outside, all.
std::vector<std::string> effect_ids(YamlMap& map, const std::string& key) {
  std::vector<std::string> ids;
  for (const std::string& word : map.words(key)) {
    const bool group = word == "catalogue" || word == "outside" || word == "all";
    if (!group && !find_hidden_effect(word))
      map.fail(key, fmt::format("value {}, allowed catalogue, outside, all, and the effects that "
                                "`softarm simulate --effects` lists",
                                word.substr(0, 60)));
    for (const HiddenEffect& effect : hidden_effects())
      if (effect.id == word || word == "all" || (group && effect.catalogued == (word == "catalogue")))
        if (std::count(ids.begin(), ids.end(), effect.id) == 0) ids.push_back(effect.id);
  }
  return ids;
}

void parse_effects(YamlMap map, CampaignSpec& spec) {
  if (map.has("count_weights")) {
    spec.effect_count_weights = map.numbers("count_weights", {0.0, 1e6}, 1, 10);
    if (*std::max_element(spec.effect_count_weights.begin(), spec.effect_count_weights.end()) <= 0.0)
      map.fail("count_weights", "all zero, at least one must be above 0");
  }
  spec.effects = effect_ids(map, "from");
  const std::size_t most = spec.effect_count_weights.size() - 1;
  if (spec.effects.size() < most)
    map.fail("from", fmt::format("{} effects, count_weights asks for up to {}", spec.effects.size(), most));
  spec.effect_size = span(map, "size", {0.0, 1.0}, spec.effect_size);
  map.finish();
}

void parse_distractors(YamlMap map, CampaignSpec& spec) {
  spec.most_distractors = map.integer("at_most", {0, 10}, spec.most_distractors);
  spec.distractors = effect_ids(map, "from");
  spec.distractor_size = map.number("size", {0.0, 1.0}, spec.distractor_size);
  if (spec.most_distractors > 0 && spec.distractors.empty())
    map.fail("from", "missing, required with at_most");
  map.finish();
}

void parse_spread(YamlMap map, CampaignSpec& spec) {
  constexpr Allowed kShare{0.0, 0.5};
  spec.stiffness_spread = map.number("stiffness", kShare, spec.stiffness_spread);
  spec.gain_spread = map.number("gain", kShare, spec.gain_spread);
  spec.mass_spread = map.number("mass", kShare, spec.mass_spread);
  spec.length_spread = map.number("length", kShare, spec.length_spread);
  map.finish();
}

void parse_trials(YamlMap map, CampaignSpec& spec) {
  spec.trials = map.integer("count", {1, 1000}, spec.trials);
  if (map.has("attitudes")) spec.attitudes = map.words("attitudes");
  if (spec.attitudes.empty()) map.fail("attitudes", "empty, at least one is needed");
  for (const std::string& word : spec.attitudes)
    if (!attitude_named(word))
      map.fail("attitudes",
               fmt::format("value {}, allowed hanging, standing, horizontal", word.substr(0, 60)));
  if (map.has("speeds")) spec.speeds = map.numbers("speeds", {0.01, 100.0}, 1, 100);
  spec.seconds = span(map, "seconds", {1.0, 1e5}, spec.seconds);
  spec.payload_kg = span(map, "payload_kg", {0.0, 100.0}, spec.payload_kg);
  map.finish();
}

void parse_sensors(YamlMap map, CampaignSpec& spec) {
  spec.mocap_rate_hz = span(map, "rate_hz", {1.0, 2000.0}, spec.mocap_rate_hz);
  spec.position_sd_m = span(map, "position_sd_m", {0.0, 1.0}, spec.position_sd_m);
  spec.orientation_sd_rad = span(map, "orientation_sd_rad", {0.0, 3.0}, spec.orientation_sd_rad);
  spec.dropout_probability = span(map, "dropout_probability", {0.0, 1.0}, spec.dropout_probability);
  map.finish();
}

}  // namespace

CampaignSpec parse_campaign(const std::string& text, const std::string& source) {
  YamlMap map = load_document(text, source, "a campaign");
  CampaignSpec spec;
  if (map.integer("format", {1, 1}, 0) == 0) map.fail("format", "missing, required (1)");
  spec.name = map.plain_name("name");
  for (YamlMap& item : map.maps("arms")) {
    CampaignArm arm;
    arm.scenario = item.word("scenario");
    arm.arm = item.has("arm") ? item.word("arm") : arm.scenario;
    item.finish();
    spec.arms.push_back(arm);
  }
  if (spec.arms.empty()) map.fail("arms", "missing or empty, at least one is needed");
  parse_effects(map.required_map("effects"), spec);
  parse_distractors(map.map("distractors"), spec);
  parse_spread(map.map("arm_spread"), spec);
  parse_trials(map.map("trials"), spec);
  parse_sensors(map.map("mocap"), spec);
  map.finish();
  return spec;
}

}  // namespace softarm::rig
