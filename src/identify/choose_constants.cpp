#include "choose_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace softarm::identify {
namespace {

/// Those that patterns free: what the arm does not state only where a pattern ends in its name.
std::vector<ConstantRef> freed_by(const arm::Arm& arm, const std::vector<std::string>& patterns) {
  std::vector<std::string> named;
  for (const std::string& pattern : patterns) {
    const std::string last = pattern.substr(pattern.rfind('.') + 1);
    if (last.find_first_of("*?[") == std::string::npos) named.push_back(pattern);
  }
  const std::vector<ConstantRef> by_name = matching(arm, named);
  std::vector<ConstantRef> list = matching(arm, patterns);
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&](const ConstantRef& c) {
                              return !is_stated(arm, c) &&
                                     std::none_of(by_name.begin(), by_name.end(),
                                                  [&](const ConstantRef& one) {
                                                    return name_of(arm, one) == name_of(arm, c);
                                                  });
                            }),
             list.end());
  return list;
}

/// Whether a constant, of several segments where they are tied, is that one.
bool same_constant(const ConstantRef& a, const ConstantRef& b) {
  const std::vector<int> of_a = segments_of(a);
  return a.kind == b.kind && a.index == b.index &&
         std::find(of_a.begin(), of_a.end(), b.segment) != of_a.end();
}

std::string names_of(const arm::Arm& arm, const std::vector<ConstantRef>& list) {
  std::string names;
  for (const ConstantRef& c : list) names += (names.empty() ? "" : ", ") + name_of(arm, c);
  return names;
}

/// A pattern that frees nothing is a mistake: it ends in a wildcard, and the arm states nothing of it.
void refuse_what_frees_nothing(const arm::Arm& arm, const std::vector<std::string>& patterns) {
  for (const std::string& pattern : patterns) {
    if (!freed_by(arm, {pattern}).empty()) continue;
    const std::vector<ConstantRef> meant = matching(arm, {pattern});
    throw std::invalid_argument(
        fmt::format("'{}' frees nothing: the file of the arm {} gives none of {}; what it does not give is "
                    "freed by its full name, such as {}",
                    pattern, arm.name, names_of(arm, meant), name_of(arm, meant.front())));
  }
}

}  // namespace

std::vector<std::string> not_fitted(const arm::Arm& arm, const Options& options,
                                    const std::vector<ConstantRef>& free) {
  std::vector<ConstantRef> asked = freed_by(arm, options.free);
  for (const ConstantRef& c : freed_by(arm, options.also_free)) asked.push_back(c);
  const std::vector<ConstantRef> held = matching(arm, options.held);
  std::vector<std::string> lines;
  for (const ConstantRef& c : asked) {
    const auto is_it = [&](const ConstantRef& other) { return same_constant(other, c); };
    if (std::any_of(free.begin(), free.end(), is_it) || std::any_of(held.begin(), held.end(), is_it))
      continue;
    const std::string line =
        fmt::format("NOT FITTED: {}: {}", name_of(arm, c),
                    c.kind == ConstantKind::kAxialStiffness
                        ? "EA needs trials with different payloads, or inputs that pull along the segment"
                        : "no vacuum is recorded in these trials");
    if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

std::vector<ConstantRef> choose_free(const arm::Arm& arm, const Options& options) {
  refuse_what_frees_nothing(arm, options.free);
  refuse_what_frees_nothing(arm, options.also_free);
  std::vector<ConstantRef> free = options.free.empty() ? default_free(arm) : freed_by(arm, options.free);
  const auto contains = [&](const std::vector<ConstantRef>& list, const ConstantRef& one) {
    return std::any_of(list.begin(), list.end(),
                       [&](const ConstantRef& other) { return same_constant(other, one); });
  };
  for (const ConstantRef& one : freed_by(arm, options.also_free)) {
    if (!contains(free, one)) free.push_back(one);
  }
  const std::vector<ConstantRef> held = matching(arm, options.held);
  free.erase(
      std::remove_if(free.begin(), free.end(), [&](const ConstantRef& c) { return contains(held, c); }),
      free.end());
  if (free.empty()) throw IdentifyError(fmt::format("the arm {} has no constant that is free", arm.name));
  return tie_constants(arm, free, options.tied);
}

}  // namespace softarm::identify
