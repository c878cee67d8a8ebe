#include <fmt/format.h>

#include "arm_parts.h"
#include "softarm/arm/arm_file.h"

namespace softarm::arm {

Arm parse_arm(const std::string& text, const std::string& source) {
  const yaml::Section root = yaml::parse_document(text, source, yaml::arm_keys());
  root.integer("format");
  Arm arm;
  arm.name = root.name("name");
  arm.gravity_m_s2 = root.vector("gravity_m_s2");
  // Less is that of no place where arms are, and what is reckoned with it overflows.
  constexpr double kLeastGravity_m_s2 = 1e-3;
  if (!arm.gravity_m_s2.isZero(0.0) && arm.gravity_m_s2.norm() < kLeastGravity_m_s2)
    root.fail_value("gravity_m_s2", fmt::format("must be 0 or {} m/s^2 and more", kLeastGravity_m_s2));
  arm.base = yaml::read_base(root.section("base", yaml::base_keys()), arm.gravity_m_s2);
  // Chambers refer to inputs, and bodies to the length of all segments: hence the order.
  arm.inputs = yaml::read_inputs(root.section("inputs", yaml::inputs_keys()));
  arm.segments = yaml::read_segments(root, arm.inputs);
  arm.tip_mass_kg = root.number("tip_mass_kg");
  arm.payload = yaml::read_payload(root.section("payload", yaml::payload_keys()), arm.total_length_m());
  arm.bodies = yaml::read_bodies(root, arm.base.body, arm.total_length_m());
  yaml::check_sources(root, arm);
  arm.estimator = yaml::read_estimator(root.section("estimator", yaml::estimator_keys()), arm);
  yaml::read_effects(root);  // may be left out here, but not be wrong
  yaml::read_effects_verdict(root);
  return arm;
}

std::vector<EffectEntry> parse_effect_entries(const std::string& text, const std::string& source) {
  return yaml::read_effects(yaml::parse_document(text, source, yaml::arm_keys()));
}

std::optional<std::string> parse_effects_verdict(const std::string& text, const std::string& source) {
  return yaml::read_effects_verdict(yaml::parse_document(text, source, yaml::arm_keys()));
}

std::string describe_arm_keys() {
  std::string text;
  for (const yaml::KeyTable* table : yaml::all_key_tables()) {
    text +=
        fmt::format("### `{}`\n\n| key | allowed | default | meaning |\n|---|---|---|---|\n", table->section);
    for (const yaml::KeySpec& key : table->keys) {
      text += fmt::format("| `{}` | {} | {} | {} |\n", key.name, yaml::allowed_values(key), key.fallback,
                          key.meaning);
    }
    text += "\n";
  }
  return text;
}

}  // namespace softarm::arm
