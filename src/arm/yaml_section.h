// One map of a YAML document, read strictly against its table of keys.
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arm_keys.h"
#include "softarm/arm/arm.h"

namespace softarm::arm::yaml {

/// Reads one section. Every getter takes default, unit and range of its key from the table, and throws
/// ArmError with one line `<source>:<line>: key '<path>': ...`. The constructor refuses keys that are unknown
/// or given twice.
class Section {
 public:
  /// @param node a map (an empty node counts as an empty map)
  /// @param path of this section, empty for the document itself
  /// @param line where it starts, 1-based
  Section(std::string source, const YAML::Node& node, std::string path, const KeyTable& table, int line);

  bool has(const std::string& key) const { return given_.count(key) != 0; }
  double number(const std::string& key) const;
  int integer(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::string word(const std::string& key) const;
  /// @return nothing where the value is the word
  std::optional<double> number_or_word(const std::string& key) const;
  Eigen::VectorXd vector(const std::string& key) const;
  /// A vector of two with low < high.
  Range range(const std::string& key) const;
  std::string text(const std::string& key) const;
  /// Letters, digits and '_', starting with a letter; `also` holds further characters allowed after the
  /// first.
  std::string name(const std::string& key, const std::string& also = "") const;
  /// A legal ROS name; `placeholder` (say <body>) must occur in it if not empty.
  std::string topic(const std::string& key, const std::string& placeholder = "") const;

  Section section(const std::string& key, const KeyTable& table) const;
  /// Names with a finite number each, in their order. Names are as name() wants them.
  std::vector<std::pair<std::string, double>> numbers(const std::string& key,
                                                      const std::string& also = "") const;

  /// One section per element; not more than the table allows.
  std::vector<Section> list(const std::string& key, const KeyTable& table) const;

  /// For a key that only some sections of its table need. Throws as a missing key does.
  void require(const std::string& key, const std::string& reason) const;
  /// Throws ArmError: `<source>:<line>: key '<path>.<key>': <problem>`.
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;
  /// The same with the value as the user wrote it: value X <problem>.
  [[noreturn]] void fail_value(const std::string& key, const std::string& problem) const;
  std::string path_of(const std::string& key) const;
  /// Where it stands, `<source>:<line>`: what messages about it begin with.
  std::string place() const;

 private:
  struct Given {
    YAML::Node value;
    int line = 0;
  };

  const KeySpec& spec(const std::string& key) const;
  /// The user's value or the default, as a node.
  YAML::Node value(const std::string& key) const;
  std::string scalar(const std::string& key, const std::string& expected) const;
  double checked_number(const std::string& key, const std::string& path, const std::string& text) const;
  [[noreturn]] void fail_at(int line, const std::string& path, const std::string& problem) const;
  [[noreturn]] void fail_unknown(const std::string& key, int line) const;

  std::string source_;
  std::string path_;
  const KeyTable* table_;
  int line_;
  std::map<std::string, Given> given_;
};

/// Parses the document. @throws ArmError on a syntax error, an empty document or more than one.
Section parse_document(const std::string& text, const std::string& source, const KeyTable& table);

}  // namespace softarm::arm::yaml
