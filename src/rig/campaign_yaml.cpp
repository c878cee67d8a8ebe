// The parser of campaigns.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "campaign.h"
#include "scenario_parts.h"

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

std::pair<std::string, std::string> pair_of(YamlMap& map, const std::string& key, const std::string& word) {
  const std::size_t plus = word.find('+');
  const std::pair<std::string, std::string> ids{
      word.substr(0, plus), plus == std::string::npos ? std::string() : word.substr(plus + 1)};
  if (!find_hidden_effect(ids.first) || !find_hidden_effect(ids.second))
    map.fail(key,
             fmt::format("value {}, expected two effects: base_tilt+gravity_direction", word.substr(0, 120)));
  return ids;
}

WishedSize wished_size(YamlMap map) {
  WishedSize wished;
  wished.least_noise = map.number("least_noise", {0.01, 100.0}, wished.least_noise);
  wished.most_m = map.number("most_m", {1e-6, 1.0}, wished.most_m);
  map.finish();
  return wished;
}

void parse_signal(YamlMap map, CampaignSpec& spec) {
  SignalSpec signal;
  if (map.has("wished")) {
    for (const char* other : {"leftover_snr", "least_leftover_m", "raw_snr"})
      if (map.has(other)) map.fail(other, "cannot be given together with wished");
    signal.wished = wished_size(map.map("wished"));
  }
  signal.leftover_snr = span(map, "leftover_snr", {0.1, 1e4}, signal.leftover_snr);
  signal.least_leftover_m = map.number("least_leftover_m", {0.0, 1.0}, signal.least_leftover_m);
  signal.distractor_m = map.number("distractor_m", {0.0, 1.0}, signal.distractor_m);
  if (map.has("background_m")) signal.background_m = span(map, "background_m", {1e-6, 1.0}, {});
  if (map.has("raw_snr")) signal.raw_snr = map.number("raw_snr", {1.0, 1e4});
  signal.per_frame_sd = map.number("per_frame_sd", {0.1, 1e4}, signal.per_frame_sd);
  map.finish();
  spec.signal = signal;
}

void parse_effects(YamlMap map, CampaignSpec& spec) {
  const std::string forms = map.has("forms") ? map.word("forms") : "any";
  if (forms != "any" && forms != "default" && forms != "other")
    map.fail("forms", fmt::format("value {}, allowed any, default, other", forms.substr(0, 60)));
  spec.forms = forms == "any"       ? FormChoice::kAny
               : forms == "default" ? FormChoice::kDefault
                                    : FormChoice::kOther;
  spec.apart.clear();
  for (const std::string& word : map.words("apart")) spec.apart.push_back(pair_of(map, "apart", word));
  spec.signal.reset();
  if (map.has("signal")) parse_signal(map.map("signal"), spec);

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
  spec.fewest_distractors = map.integer("at_least", {0, static_cast<double>(spec.most_distractors)},
                                        std::min(spec.fewest_distractors, spec.most_distractors));
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
  spec.pause_s = span(map, "pause_s", {0.0, 1e5}, spec.pause_s);
  spec.payload_kg = span(map, "payload_kg", {0.0, 100.0}, spec.payload_kg);
  map.finish();
}

void parse_sensors(YamlMap map, CampaignSpec& spec) {
  spec.mocap_rate_hz = span(map, "rate_hz", {1.0, 2000.0}, spec.mocap_rate_hz);
  spec.position_sd_m = span(map, "position_sd_m", {0.0, 1.0}, spec.position_sd_m);
  spec.orientation_sd_rad = span(map, "orientation_sd_rad", {0.0, 3.0}, spec.orientation_sd_rad);
  spec.dropout_probability = span(map, "dropout_probability", {0.0, 1.0}, spec.dropout_probability);
  spec.slow_position_sd_m = span(map, "slow_position_sd_m", {0.0, 1.0}, spec.slow_position_sd_m);
  spec.slow_correlation_s = span(map, "slow_correlation_s", {1e-3, 1e4}, spec.slow_correlation_s);
  map.finish();
}

/// The kinds; the keys of the one that is wanted replace those of the document.
void parse_kinds(YamlMap& document, const std::string& wanted, CampaignSpec& spec) {
  std::optional<CampaignSpec> chosen;
  std::vector<CampaignKind> kinds;
  for (YamlMap& map : document.maps("kinds")) {
    CampaignSpec of_kind = spec;
    CampaignKind kind;
    kind.name = map.plain_name("kind");
    kind.sample = map.integer("sample", {0, 100000}, 0);
    kind.full = map.integer("full", {0, 100000}, kind.sample);
    if (map.has("effects")) parse_effects(map.map("effects"), of_kind);
    if (map.has("distractors")) parse_distractors(map.map("distractors"), of_kind);
    if (map.has("trials")) parse_trials(map.map("trials"), of_kind);
    map.finish();
    if (std::any_of(kinds.begin(), kinds.end(), [&](const CampaignKind& k) { return k.name == kind.name; }))
      map.fail("kind", fmt::format("{} is given twice", kind.name));
    if (kind.name == wanted) chosen = of_kind;
    kinds.push_back(kind);
  }
  if (!wanted.empty() && !chosen) document.fail("kinds", fmt::format("no kind {}", wanted.substr(0, 60)));
  if (chosen) spec = *chosen;
  spec.kinds = std::move(kinds);
}

}  // namespace

CampaignSpec parse_campaign(const std::string& text, const std::string& source, const std::string& kind) {
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
  parse_kinds(map, kind, spec);
  map.finish();
  return spec;
}

}  // namespace softarm::rig
