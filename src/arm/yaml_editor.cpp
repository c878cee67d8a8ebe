#include "yaml_editor.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <optional>

#include "softarm/arm/arm_file.h"

namespace softarm::arm::yaml {
namespace {

std::string words(const Path& path) {
  std::string text;
  for (const Step& step : path) {
    if (const auto* key = std::get_if<std::string>(&step)) {
      text += (text.empty() ? "" : ".") + *key;
    } else {
      text += fmt::format("[{}]", std::get<std::size_t>(step));
    }
  }
  return text;
}

/// The node one step down; nothing where there is none, or only an empty value.
std::optional<YAML::Node> child(const YAML::Node& node, const Step& step) {
  const auto* key = std::get_if<std::string>(&step);
  const bool fits = key != nullptr ? node.IsMap() : node.IsSequence();
  if (!fits) return std::nullopt;
  const YAML::Node next = key != nullptr ? node[*key] : node[std::get<std::size_t>(step)];
  if (!next.IsDefined() || next.IsNull()) return std::nullopt;
  return next;
}

}  // namespace

void Editor::fail(const Path& path, const std::string& problem) const {
  throw ArmError(fmt::format("{}: key '{}': {}", source_, words(path), problem));
}

bool Editor::has(const Path& path) const {
  YAML::Node node = YAML::Load(text_);
  for (const Step& step : path) {
    const std::optional<YAML::Node> next = child(node, step);
    if (!next) return false;
    node.reset(*next);
  }
  return true;
}

void Editor::scale(const Path& path, double factor) {
  YAML::Node node = YAML::Load(text_);
  for (const Step& step : path) {
    const std::optional<YAML::Node> next = child(node, step);
    if (!next) fail(path, "is not there to be changed");
    node.reset(*next);
  }
  set(path, fmt::format("{:.10g}", node.as<double>() * factor));
}

void Editor::set(const Path& path, const std::string& value) {
  YAML::Node node = YAML::Load(text_);
  for (std::size_t depth = 0; depth < path.size(); ++depth) {
    const std::optional<YAML::Node> next = child(node, path[depth]);
    if (next) {
      node.reset(*next);
      continue;
    }
    // A key without a value ("prior:") would be given twice.
    const auto* key = std::get_if<std::string>(&path[depth]);
    if (key == nullptr || !node.IsMap() || static_cast<const YAML::Node&>(node)[*key].IsDefined())
      fail(path, "is not there to be changed");
    // What is left of the path, as a flow map on one line.
    std::string added = value;
    for (std::size_t i = path.size(); i-- > depth;) {
      if (!std::holds_alternative<std::string>(path[i])) fail(path, "is not there to be changed");
      const std::string entry = std::get<std::string>(path[i]) + ": " + added;
      added = i == depth ? entry : "{" + entry + "}";
    }
    if (node.size() == 0) {  // "{}"
      const auto brace = static_cast<std::size_t>(node.Mark().pos);
      if (text_.compare(brace, 1, "{") != 0) fail(path, "has no place in this text");
      text_.insert(brace + 1, added);
      return;
    }
    const YAML::Mark first = node.begin()->first.Mark();
    const bool flow = node.Style() == YAML::EmitterStyle::Flow;
    text_.insert(
        static_cast<std::size_t>(first.pos),
        flow ? added + ", " : added + "\n" + std::string(static_cast<std::size_t>(first.column), ' '));
    return;
  }
  const auto at = static_cast<std::size_t>(node.Mark().pos);
  if (!node.IsScalar() || text_.compare(at, node.Scalar().size(), node.Scalar()) != 0)
    fail(path, "is not written as a plain value of its own, so it cannot be replaced");
  text_.replace(at, node.Scalar().size(), value);
}

}  // namespace softarm::arm::yaml
