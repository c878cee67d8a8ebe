// Every key of an arm's YAML in one place: its unit, default, allowed range and meaning. The parser takes
// defaults and checks from here, and describe_arm_keys() prints it, so that documentation and checks cannot
// drift apart.
#pragma once

#include <string>
#include <vector>

namespace softarm::arm::yaml {

enum class KeyKind {
  kNumber,        ///< one number in [low, high]
  kInteger,       ///< one integer in [low, high]
  kFlag,          ///< true | false
  kText,          ///< free text, checked by its reader
  kWord,          ///< one of `words`
  kNumberOrWord,  ///< a number in [low, high] or one of `words`
  kVector,        ///< list of `count` numbers, each in [low, high]
  kMap,           ///< nested section
  kList,          ///< list of at most `high` nested sections
  kNumbers,       ///< names, each with a number of its own
};

/// One key. `fallback` is YAML text, read like a user's value; kRequired and kAbsent are the special cases.
struct KeySpec {
  std::string name;
  KeyKind kind = KeyKind::kNumber;
  std::string fallback;
  std::string unit;
  double low = 0.0;
  double high = 0.0;
  int count = 1;
  std::vector<std::string> words;
  std::string meaning;
};

inline constexpr char kRequired[] = "required";
inline constexpr char kAbsent[] = "absent";

/// The keys of one kind of section.
struct KeyTable {
  std::string section;  ///< as documentation names it, say segments[]
  std::vector<KeySpec> keys;

  const KeySpec* find(const std::string& name) const;
};

const KeyTable& arm_keys();
const KeyTable& base_keys();
const KeyTable& fixed_base_keys();
const KeyTable& transform_keys();
const KeyTable& segment_keys();
const KeyTable& stiffness_keys();
const KeyTable& profile_keys();
const KeyTable& material_keys();
const KeyTable& wall_keys();
const KeyTable& bending_element_keys();
const KeyTable& axial_element_keys();
const KeyTable& payload_keys();
const KeyTable& noise_keys();
const KeyTable& body_keys();
const KeyTable& inputs_keys();
const KeyTable& body_input_keys();
const KeyTable& base_input_keys();
const KeyTable& labelled_marker_keys();
const KeyTable& pressure_input_keys();
const KeyTable& tension_input_keys();
const KeyTable& angle_input_keys();
const KeyTable& estimator_keys();
const KeyTable& prior_keys();
const KeyTable& effect_keys();
const KeyTable& correlation_keys();

/// All of them, in the order of the document.
std::vector<const KeyTable*> all_key_tables();

/// "[0.005, 10] m", or the words, or what else the key may be.
std::string allowed_values(const KeySpec& key);

}  // namespace softarm::arm::yaml
