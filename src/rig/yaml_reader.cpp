#include "yaml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "scenario.h"

namespace softarm::rig {
namespace {

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

/// Keys and values as they stand in a message: not a page of them when a quote was forgotten.
std::string brief(const std::string& text) {
  constexpr std::size_t kMost = 60;
  return one_line(text.size() > kMost ? text.substr(0, kMost) + "..." : text);
}

std::string shown(const YAML::Node& value) {
  if (value.IsScalar()) return brief(value.Scalar());
  return value.IsMap() ? "a map" : value.IsSequence() ? "a list" : "nothing";
}

}  // namespace

YamlMap::YamlMap(const YAML::Node& node, std::string source, std::string path)
    : node_(node), source_(std::move(source)), path_(std::move(path)) {
  if (node_.IsDefined() && !node_.IsNull() && !node_.IsMap())
    throw ScenarioError(fmt::format("{}: {}: value {}, expected a map of keys", source_,
                                    path_.empty() ? "document" : "key " + path_, shown(node_)));
}

void YamlMap::fail(const std::string& key, const std::string& what) const {
  throw ScenarioError(fmt::format("{}: key {}{}{}: {}", source_, path_, path_.empty() ? "" : ".", brief(key),
                                  one_line(what)));
}

YAML::Node YamlMap::get(const std::string& key) {
  known_.insert(key);
  if (node_.IsMap()) {
    const YAML::Node& constant = node_;  // the other operator[] would add the key
    const YAML::Node value = constant[key];
    if (value.IsDefined()) return value;
  }
  return YAML::Node(YAML::NodeType::Undefined);  // unlike yaml-cpp's own, one that may be asked for its type
}

YAML::Node YamlMap::require(const std::string& key) {
  const YAML::Node value = get(key);
  if (!value.IsDefined() || value.IsNull()) fail(key, "missing, required");
  return value;
}

bool YamlMap::has(const std::string& key) {
  return get(key).IsDefined();
}

bool YamlMap::is_list(const std::string& key) {
  return get(key).IsSequence();
}

double YamlMap::checked(const YAML::Node& value, const std::string& key, Allowed allowed) const {
  const std::string range = fmt::format("{} ... {}", allowed.low, allowed.high);
  double number = 0.0;
  if (!value.IsScalar() || !YAML::convert<double>::decode(value, number))
    fail(key, fmt::format("value {}, expected a number in {}", shown(value), range));
  if (!(number >= allowed.low && number <= allowed.high))  // refuses NaN too
    fail(key, fmt::format("value {}, allowed {}", shown(value), range));
  return number;
}

double YamlMap::number(const std::string& key, Allowed allowed) {
  return checked(require(key), key, allowed);
}

double YamlMap::number(const std::string& key, Allowed allowed, double otherwise) {
  const YAML::Node value = get(key);
  return value.IsDefined() ? checked(value, key, allowed) : otherwise;
}

int YamlMap::integer(const std::string& key, Allowed allowed, int otherwise) {
  const double value = number(key, allowed, otherwise);
  if (value != std::floor(value)) fail(key, fmt::format("value {}, expected a whole number", value));
  return static_cast<int>(value);
}

std::uint64_t YamlMap::seed(const std::string& key, std::uint64_t otherwise) {
  const YAML::Node value = get(key);
  if (!value.IsDefined()) return otherwise;
  std::uint64_t result = 0;
  const std::string text = value.IsScalar() ? value.Scalar() : "";
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    fail(key, fmt::format("value {}, expected a whole number in 0 ... {}", shown(value),
                          std::numeric_limits<std::uint64_t>::max()));
  return result;
}

bool YamlMap::boolean(const std::string& key, bool otherwise) {
  const YAML::Node value = get(key);
  if (!value.IsDefined()) return otherwise;
  bool result = false;
  if (!value.IsScalar() || !YAML::convert<bool>::decode(value, result))
    fail(key, fmt::format("value {}, expected true or false", shown(value)));
  return result;
}

std::string YamlMap::word(const std::string& key) {
  const YAML::Node value = require(key);
  if (!value.IsScalar() || value.Scalar().empty())
    fail(key, fmt::format("value {}, expected a word", shown(value)));
  return value.Scalar();
}

std::string YamlMap::plain_name(const std::string& key) {
  const std::string name = word(key);
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  if (name.size() > 100 || !std::all_of(name.begin(), name.end(), is_plain))
    fail(key, "allowed are up to 100 letters, digits, _ and -");
  return name;
}

std::vector<std::string> YamlMap::words(const std::string& key) {
  const YAML::Node value = get(key);
  if (!value.IsDefined()) return {};
  if (!value.IsSequence()) return {word(key)};
  std::vector<std::string> result;
  for (const YAML::Node& item : value) {
    if (!item.IsScalar() || item.Scalar().empty())
      fail(key, fmt::format("value {}, expected a list of words", shown(item)));
    result.push_back(item.Scalar());
  }
  return result;
}

std::vector<double> YamlMap::numbers(const std::string& key, Allowed allowed, std::size_t at_least,
                                     std::size_t at_most) {
  const YAML::Node value = require(key);
  const std::string count =
      at_least == at_most ? fmt::format("{}", at_least) : fmt::format("{} ... {}", at_least, at_most);
  if (!value.IsSequence())
    fail(key, fmt::format("value {}, expected a list of {} numbers", shown(value), count));
  if (value.size() < at_least || value.size() > at_most)
    fail(key, fmt::format("{} values, expected {}", value.size(), count));
  std::vector<double> result;
  for (const YAML::Node& item : value) result.push_back(checked(item, key, allowed));
  return result;
}

YamlMap YamlMap::map(const std::string& key) {
  return YamlMap(get(key), source_, path_.empty() ? key : path_ + "." + key);
}

YamlMap YamlMap::required_map(const std::string& key) {
  require(key);
  return map(key);
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) {
  std::vector<YamlMap> result;
  const YAML::Node list = get(key);
  if (!list.IsDefined()) return result;
  if (!list.IsSequence()) fail(key, fmt::format("value {}, expected a list of maps", shown(list)));
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string path = fmt::format("{}{}{}[{}]", path_, path_.empty() ? "" : ".", key, i);
    if (!list[i].IsMap())
      fail(fmt::format("{}[{}]", key, i), fmt::format("value {}, expected a map", shown(list[i])));
    result.emplace_back(list[i], source_, path);
  }
  return result;
}

YamlMap load_document(const std::string& text, const std::string& source, const std::string& what) {
  YAML::Node document;
  try {
    document = YAML::Load(text + " #");  // without it "{key:" at the end hangs yaml-cpp 0.6
  } catch (const YAML::Exception& error) {
    throw ScenarioError(fmt::format("{}: line {}: {}", source, error.mark.line + 1, error.msg));
  }
  if (!document.IsMap()) throw ScenarioError(fmt::format("{}: not {}: expected a map of keys", source, what));
  return YamlMap(document, source, "");
}

void YamlMap::finish() const {
  if (!node_.IsMap()) return;
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a word)";
    if (known_.count(key) == 0) fail(key, fmt::format("unknown, allowed are {}", fmt::join(known_, ", ")));
    if (!seen.insert(key).second) fail(key, "given twice");
  }
}

}  // namespace softarm::rig
