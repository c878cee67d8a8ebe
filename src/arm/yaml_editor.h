// Changes single values in the text of a YAML document.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace softarm::arm::yaml {

/// A key of a map or an index into a list.
using Step = std::variant<std::string, std::size_t>;
using Path = std::vector<Step>;

class Editor {
 public:
  /// @param source name of the document for messages
  Editor(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source)) {}

  /// Replaces the plain scalar at the path; keys that are missing are added in front of their map's first.
  /// @param value as it is to be written
  /// @throws ArmError where a list lacks the index, or the value is not a plain scalar of its own
  void set(const Path& path, const std::string& value);
  /// Multiplies the number at the path, which must be there.
  void scale(const Path& path, double factor);
  bool has(const Path& path) const;

  const std::string& text() const { return text_; }

 private:
  [[noreturn]] void fail(const Path& path, const std::string& problem) const;

  std::string text_;
  const std::string source_;
};

}  // namespace softarm::arm::yaml
