#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <stdexcept>

#include "arm/edit_distance.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

namespace {

/// The whole name, or its last parts.
bool matches(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0 ||
         fnmatch(("*." + pattern).c_str(), name.c_str(), 0) == 0;
}

/// The name that a pattern without any was meant to be, whole or its last parts; empty where none is near.
std::string meant_by(std::string pattern, const std::vector<std::string>& names) {
  pattern.erase(std::remove_if(pattern.begin(), pattern.end(), [](char c) { return c == '*' || c == '?'; }),
                pattern.end());
  std::vector<std::string> ends;
  for (const std::string& name : names) {
    for (std::size_t from = 0; from != std::string::npos; from = name.find('.', from + 1))
      ends.push_back(name.substr(from == 0 ? 0 : from + 1));
  }
  const auto nearest = arm::yaml::nearest_word(pattern, ends);
  return nearest ? fmt::format("; is '{}' meant?", *nearest) : ".";
}

}  // namespace

std::vector<ConstantRef> matching(const arm::Arm& arm, const std::vector<std::string>& patterns) {
  const std::vector<ConstantRef> all = constants_of(arm);
  std::vector<bool> wanted(all.size(), false);
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!matches(pattern, name_of(arm, all[i]))) continue;
      wanted[i] = any = true;
    }
    if (any) continue;
    std::vector<std::string> names;
    for (const ConstantRef& constant : all) names.push_back(name_of(arm, constant));
    throw std::invalid_argument(fmt::format("'{}' is no constant of the arm {}{} It has {}", pattern,
                                            arm.name, meant_by(pattern, names), fmt::join(names, ", ")));
  }
  std::vector<ConstantRef> list;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted[i]) list.push_back(all[i]);
  }
  return list;
}

std::vector<ConstantRef> tie_constants(const arm::Arm& arm, const std::vector<ConstantRef>& list,
                                       const std::vector<std::string>& patterns) {
  std::vector<ConstantRef> result = list;
  for (const std::string& pattern : patterns) {
    bool any = false;
    const std::vector<ConstantRef> matches = matching(arm, {pattern});
    const auto find = [&](const ConstantRef& wanted) {
      return std::find_if(result.begin(), result.end(), [&](const ConstantRef& c) {
        return c.kind == wanted.kind && c.index == wanted.index && c.segment == wanted.segment;
      });
    };
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (find(matches[i]) == result.end()) continue;  // held, or tied already
      for (std::size_t j = i + 1; j < matches.size(); ++j) {
        const bool alike = matches[j].kind == matches[i].kind && matches[j].index == matches[i].index;
        if (!alike || find(matches[j]) == result.end()) continue;
        result.erase(find(matches[j]));
        find(matches[i])->tied.push_back(matches[j].segment);
        any = true;
      }
    }
    if (!any)
      throw std::invalid_argument(fmt::format(
          "'{}' ties nothing: it must match free constants of one kind in two segments or more", pattern));
  }
  return result;
}

}  // namespace softarm::identify
