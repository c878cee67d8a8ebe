#include "softarm/trial/csv_layout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

namespace softarm {
namespace {

using Scale = std::pair<std::string, double>;

const std::vector<Scale> kTimeUnits{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
const std::vector<Scale> kLengthUnits{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}};
const std::vector<Scale> kPressureUnits{{"Pa", 1.0},    {"hPa", 100.0}, {"kPa", 1e3},           {"MPa", 1e6},
                                        {"mbar", 100.}, {"bar", 1e5},   {"psi", 6894.757293168}};

/// One mapping of the document with its path, so that every message can name its key.
class Map {
 public:
  Map(YAML::Node node, std::string source, std::string path, const std::set<std::string>& allowed)
      : node_(std::move(node)), source_(std::move(source)), path_(std::move(path)) {
    if (!node_.IsMap()) {
      throw CsvError(fmt::format("{}:{}: {}: must be a mapping with the keys {}", source_, line_of(node_),
                                 path_.empty() ? "document" : "key '" + path_ + "'",
                                 fmt::join(allowed, ", ")));
    }
    std::set<std::string> seen;
    for (const auto& item : node_) {
      const std::string key = item.first.as<std::string>();
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

  double unit(const std::string& key, const std::vector<Scale>& scales) const {
    std::vector<std::string> names;
    for (const Scale& s : scales) names.push_back(s.first);
    const std::string text = word(key, std::nullopt, names);
    return std::find_if(scales.begin(), scales.end(), [&](const Scale& s) { return s.first == text; })
        ->second;
  }

  std::string text(const std::string& key, const std::string& what) const {
    const YAML::Node value = require(key, what);
    if (!value.IsScalar() || value.Scalar().empty()) fail(key, text_of(value), what);
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
  std::vector<Map> list(const std::string& key, const std::set<std::string>& allowed) const {
    const YAML::Node value = node_[key];
    if (!value.IsSequence()) fail(key, text_of(value), "a list");
    std::vector<Map> result;
    for (std::size_t i = 0; i < value.size(); ++i) {
      result.emplace_back(value[i], source_, fmt::format("{}[{}]", name(key), i), allowed);
    }
    return result;
  }

  Map map(const std::string& key, const std::set<std::string>& allowed) const {
    return Map(require(key, fmt::format("{}", fmt::join(allowed, ", "))), source_, name(key), allowed);
  }

  static int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

  static std::string text_of(const YAML::Node& node) {
    return node.IsScalar() ? node.Scalar() : YAML::Dump(node).substr(0, 40);
  }

 private:
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

CsvBody read_body(const Map& m, bool header) {
  CsvBody body;
  body.name = m.text("name", "the body's name in /mocap/<body>/pose");
  const auto valid = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  if (!std::all_of(body.name.begin(), body.name.end(), valid)) {
    m.fail("name", "'" + body.name + "'", "letters, digits and _");
  }
  body.position = m.columns<3>("position", header);
  if (m.has("fixed_orientation")) {
    for (const char* key : {"orientation", "orientation_order"}) {
      if (m.has(key)) m.fail(key, "beside fixed_orientation", "absent: the one or the other");
    }
    body.fixed_orientation_xyzw = m.unit_quaternion("fixed_orientation");
    return body;
  }
  const auto q = m.columns<4>("orientation", header);
  const bool w_first = m.word("orientation_order", std::nullopt, {"xyzw", "wxyz"}) == "wxyz";
  body.orientation = w_first ? std::array<CsvColumn, 4>{q[1], q[2], q[3], q[0]} : q;
  return body;
}

void read_mocap(const Map& m, CsvLayout& layout) {
  layout.position_scale_to_m = m.unit("unit", kLengthUnits);
  layout.up = m.word("up", std::nullopt, {"z", "y"}) == "y" ? UpAxis::kY : UpAxis::kZ;
  layout.drop_repeated = m.flag("drop_repeated", false);
  m.require("bodies", "the rigid bodies");
  std::set<std::string> names;
  for (const Map& body :
       m.list("bodies", {"name", "position", "orientation", "orientation_order", "fixed_orientation"})) {
    layout.bodies.push_back(read_body(body, layout.header));
    if (!names.insert(layout.bodies.back().name).second) {
      body.fail("name", "'" + layout.bodies.back().name + "'", "a name that no other body has");
    }
  }
  if (layout.bodies.empty()) m.fail("bodies", "an empty list", "at least one body");
}

void read_pressures(const Map& m, CsvLayout& layout) {
  const double scale = m.unit("unit", kPressureUnits);
  const bool gauge = m.word("reference", std::nullopt, {"gauge", "absolute"}) == "gauge";
  layout.ambient_pressure_pa = m.number("ambient_pa", 101325.0, 5e4, 1.2e5);
  m.require("inputs", "the pressure columns");
  std::set<std::string> topics;
  for (const Map& input : m.list("inputs", {"topic", "column", "zero"})) {
    CsvPressure p{input.text("topic", "a topic such as /pressure/chamber_1"),
                  input.column("column", layout.header), scale, gauge, input.number("zero", 0.0, -1e7, 1e7)};
    if (p.topic.front() != '/') input.fail("topic", "'" + p.topic + "'", "a topic that starts with /");
    if (!topics.insert(p.topic).second) {
      input.fail("topic", "'" + p.topic + "'", "a topic that no other pressure has");
    }
    layout.pressures.push_back(std::move(p));
  }
}

void read_payload(const Map& top, CsvLayout& layout) {
  for (const Map& step : top.list("payload", {"from_s", "kg"})) {
    const CsvPayloadStep next{step.number("from_s", std::nullopt, -1e9, 1e10),
                              step.number("kg", std::nullopt, 0.0, 100.0)};
    if (!layout.payload.empty() && next.from_s <= layout.payload.back().from_s) {
      step.fail("from_s", fmt::format("{}", next.from_s),
                fmt::format("later than {} s of the step before", layout.payload.back().from_s));
    }
    layout.payload.push_back(next);
  }
}

}  // namespace

CsvLayout parse_csv_layout(const std::string& text, const std::string& source) {
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw CsvError(fmt::format("{}:{}: not YAML: {}", source, e.mark.line + 1, e.msg));
  }
  const Map top(document, source, "",
                {"separator", "header", "skip_lines", "time", "mocap", "pressures", "payload"});
  CsvLayout layout;
  const std::map<std::string, char> separators{
      {"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"space", ' '}};
  layout.separator = separators.at(top.word("separator", "comma", {"comma", "semicolon", "tab", "space"}));
  layout.header = top.flag("header", false);
  layout.skip_lines = static_cast<int>(top.number("skip_lines", 0.0, 0, 10000));

  const Map time = top.map("time", {"column", "unit", "start_stamp_s"});
  layout.time_column = time.column("column", layout.header);
  layout.time_scale_to_s = time.unit("unit", kTimeUnits);
  layout.start_stamp_s = time.number("start_stamp_s", layout.start_stamp_s, 0.0, 4e9);

  read_mocap(top.map("mocap", {"unit", "up", "drop_repeated", "bodies"}), layout);
  if (top.has("pressures")) {
    read_pressures(top.map("pressures", {"unit", "reference", "ambient_pa", "inputs"}), layout);
  }
  if (top.has("payload")) read_payload(top, layout);
  return layout;
}

}  // namespace softarm
