// One mapping of a layout's document, with messages that name its keys.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "csv_layout.h"

namespace softarm::trial {

/// A unit's name and what one of it is in SI.
using CsvUnit = std::pair<std::string, double>;

/// One mapping of the document with its path, so that every message can name its key.
class CsvLayoutMap {
 public:
  CsvLayoutMap(YAML::Node node, std::string source, std::string path, const std::set<std::string>& allowed)
      : node_(std::move(node)), source_(std::move(source)), path_(std::move(path)) {
    if (!node_.IsMap()) {
      throw CsvError(fmt::format("{}:{}: {}: must be a mapping with the keys {}", source_, line_of(node_),
                                 path_.empty() ? "document" : "key '" + path_ + "'",
                                 fmt::join(allowed, ", ")));
    }
    std::set<std::string> seen;
    for (const auto& item : node_) {
      const std::string key = text_of(item.first);
      if (!allowed.count(key)) {
        throw CsvError(fmt::format("{}:{}: key '{}': unknown; allowed: {}", source_, line_of(item.first),
                                   name(key), fmt::join(allowed, ", ")));
      }
      if (!seen.insert(key).second)
        throw CsvError(fmt::format("{}:{}: key '{}': given twice", source_, line_of(item.first), name(key)));
    }
  }

  std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  bool has(const std::string& key) const { return node_[key].IsDefined(); }

  YAML::Node require(const std::string& key, const std::string& what) const {
    if (!has(key))
      throw CsvError(
          fmt::format("{}:{}: key '{}': missing; it gives {}", source_, line_of(node_), name(key), what));
    if (node_[key].IsNull())
      throw CsvError(fmt::format("{}:{}: key '{}': is left blank; it gives {}", source_, line_of(node_[key]),
                                 name(key), what));
    return node_[key];
  }

  [[noreturn]] void fail(const std::string& key, const std::string& value, const std::string& allowed) const {
    throw CsvError(fmt::format("{}:{}: key '{}': value {} is not allowed; must be {}", source_,
                               line_of(node_[key]), name(key), value, allowed));
  }

  double number(const std::string& key, std::optional<double> fallback, double low, double high) const {
    if (!has(key) && fallback) return *fallback;
    const YAML::Node value = require(key, fmt::format("a number from {} to {}", low, high));
    double x = 0.0;
    const bool is_number = value.IsScalar() && YAML::convert<double>::decode(value, x);
    if (!is_number || !(x >= low && x <= high)) {
      fail(key, text_of(value), fmt::format("a number from {} to {}", low, high));
    }
    return x;
  }

  bool flag(const std::string& key, bool fallback) const {
    if (!has(key)) return fallback;
    bool x = false;
    if (!node_[key].IsScalar() || !YAML::convert<bool>::decode(node_[key], x)) {
      fail(key, text_of(node_[key]), "true or false");
    }
    return x;
  }

  std::string word(const std::string& key, const std::optional<std::string>& fallback,
                   const std::vector<std::string>& allowed) const {
    if (!has(key) && fallback) return *fallback;
    const YAML::Node value = require(key, fmt::format("one of {}", fmt::join(allowed, ", ")));
    const std::string text = text_of(value);
    if (std::find(allowed.begin(), allowed.end(), text) == allowed.end()) {
      fail(key, "'" + text + "'", fmt::format("one of {}", fmt::join(allowed, ", ")));
    }
    return text;
  }

  double unit(const std::string& key, const std::vector<CsvUnit>& scales) const {
    std::vector<std::string> names;
    for (const CsvUnit& s : scales) names.push_back(s.first);
    const std::string text = word(key, std::nullopt, names);
    return std::find_if(scales.begin(), scales.end(), [&](const CsvUnit& s) { return s.first == text; })
        ->second;
  }

  std::string text(const std::string& key, const std::string& what) const {
    const YAML::Node value = require(key, what);
    if (!value.IsScalar() || value.Scalar().empty()) fail(key, "'" + text_of(value) + "'", what);
    return value.Scalar();
  }

  CsvColumn column(const std::string& key, bool header) const {
    return as_column(require(key, "a column"), key, header);
  }

  template <std::size_t N>
  std::array<CsvColumn, N> columns(const std::string& key, bool header) const {
    const YAML::Node value = require(key, fmt::format("{} columns", N));
    if (!value.IsSequence() || value.size() != N) {
      fail(key, text_of(value), fmt::format("a list of {} columns", N));
    }
    std::array<CsvColumn, N> result;
    for (std::size_t i = 0; i < N; ++i) result[i] = as_column(value[i], key, header);
    return result;
  }

  /// x y z w
  std::array<double, 4> unit_quaternion(const std::string& key) const {
    const std::string what = "a unit quaternion [x, y, z, w]";
    const YAML::Node value = require(key, what);
    std::array<double, 4> q{};
    double norm2 = 0.0;
    bool valid = value.IsSequence() && value.size() == q.size();
    for (std::size_t i = 0; valid && i < q.size(); ++i) {
      valid = value[i].IsScalar() && YAML::convert<double>::decode(value[i], q[i]);
      norm2 += q[i] * q[i];
    }
    if (!valid || !(std::abs(norm2 - 1.0) < 1e-3)) fail(key, text_of(value), what);
    for (double& x : q) x /= std::sqrt(norm2);
    return q;
  }

  /// The mappings of a list.
  std::vector<CsvLayoutMap> list(const std::string& key, const std::set<std::string>& allowed) const {
    const YAML::Node value = node_[key];
    if (!value.IsSequence()) fail(key, text_of(value), "a list");
    std::vector<CsvLayoutMap> result;
    for (std::size_t i = 0; i < value.size(); ++i) {
      result.emplace_back(value[i], source_, fmt::format("{}[{}]", name(key), i), allowed);
    }
    return result;
  }

  CsvLayoutMap map(const std::string& key, const std::set<std::string>& allowed) const {
    return CsvLayoutMap(require(key, fmt::format("{}", fmt::join(allowed, ", "))), source_, name(key),
                        allowed);
  }

  static int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

  /// As one line, for messages and to compare with what is allowed: of what is longer the start.
  static std::string text_of(const YAML::Node& node) {
    std::string text = node.IsScalar() ? node.Scalar() : YAML::Dump(node);
    if (text.size() > kLongestText) text = text.substr(0, kLongestText) + "...";
    for (char& c : text)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
  }

 private:
  static constexpr std::size_t kLongestText = 60;

  CsvColumn as_column(const YAML::Node& node, const std::string& key, bool header) const {
    const std::string what = header ? "a column's name or its number from 1" : "a column's number from 1";
    if (!node.IsScalar()) fail(key, text_of(node), what);
    int number = 0;
    const bool is_number = YAML::convert<int>::decode(node, number);
    if ((is_number && number < 1) || (!is_number && !header)) fail(key, text_of(node), what);
    return CsvColumn{node.Scalar(), name(key)};
  }

  YAML::Node node_;
  std::string source_;
  std::string path_;
};

}  // namespace softarm::trial
