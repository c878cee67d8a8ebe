// Strict reading of YAML maps with one-line errors: private to the rig.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace softarm::rig {

/// A closed range of allowed values.
struct Allowed {
  double low, high;
};

/// One map of the document. Every key that is asked for is known; finish() refuses the others.
class YamlMap {
 public:
  /// @param path dotted name of the map in the document, empty for the document itself
  YamlMap(const YAML::Node& node, std::string source, std::string path);

  bool has(const std::string& key);
  bool is_list(const std::string& key);
  /// A number within a range; without a default the key is required.
  double number(const std::string& key, Allowed allowed);
  double number(const std::string& key, Allowed allowed, double otherwise);
  int integer(const std::string& key, Allowed allowed, int otherwise);
  std::uint64_t seed(const std::string& key, std::uint64_t otherwise);
  bool boolean(const std::string& key, bool otherwise);
  std::string word(const std::string& key);
  /// A word of up to 100 letters, digits, _ and -.
  std::string plain_name(const std::string& key);
  /// The words of a list; a single word is a list of one; empty if the key is absent.
  std::vector<std::string> words(const std::string& key);
  /// A list of numbers, each within the range, with an allowed count.
  std::vector<double> numbers(const std::string& key, Allowed allowed, std::size_t at_least,
                              std::size_t at_most);
  /// A map under a key; empty if the key is absent.
  YamlMap map(const std::string& key);
  /// A required map.
  YamlMap required_map(const std::string& key);
  /// The maps of a list.
  std::vector<YamlMap> maps(const std::string& key);

  /// Throws for keys that nobody asked for and keys given twice.
  void finish() const;

  /// Throws ScenarioError: "source: key path.key: what".
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  YAML::Node get(const std::string& key);
  YAML::Node require(const std::string& key);
  double checked(const YAML::Node& value, const std::string& key, Allowed allowed) const;

  YAML::Node node_;
  std::string source_, path_;
  std::set<std::string> known_;
};

/// The map of a whole document.
/// @param what it should be, for messages: "a scenario"
YamlMap load_document(const std::string& text, const std::string& source, const std::string& what);

}  // namespace softarm::rig
