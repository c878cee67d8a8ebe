#include "csv_layout.h"

#include <cctype>
#include <map>
#include <set>

#include "csv_layout_map.h"

namespace softarm::trial {
namespace {

const std::vector<CsvUnit> kTimeUnits{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
const std::vector<CsvUnit> kLengthUnits{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}};
const std::vector<CsvUnit> kPressureUnits{
    {"Pa", 1.0},    {"hPa", 100.0}, {"kPa", 1e3},           {"MPa", 1e6},
    {"mbar", 100.}, {"bar", 1e5},   {"psi", 6894.757293168}};

const std::vector<CsvUnit> kAngleUnits{{"rad", 1.0}, {"deg", 0.017453292519943295}};
const std::vector<CsvUnit> kForceUnits{{"N", 1.0}, {"mN", 1e-3}, {"kgf", 9.80665}, {"gf", 9.80665e-3}};
const std::vector<CsvUnit> kMassUnits{{"kg", 1.0}, {"g", 1e-3}};

char read_separator(const CsvLayoutMap& m) {
  const std::map<std::string, char> names{{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"space", ' '}};
  constexpr const char* kAllowed =
      "comma, semicolon, tab, space, or one character in quotes that is no part of a number";
  const std::string text = m.text("separator", kAllowed);
  if (const auto found = names.find(text); found != names.end()) return found->second;
  if (text.size() != 1 || !may_separate(text[0])) m.fail("separator", "'" + text + "'", kAllowed);
  return text[0];
}

CsvFormat read_format(const CsvLayoutMap& m) {
  CsvFormat format;
  if (m.has("separator")) format.separator = read_separator(m);
  const std::string decimal = m.word("decimal", "point", {"point", "comma"});
  if (decimal == "comma") {
    format.decimal = ',';
    // "1,5","2,5": in quotes the two are told apart.
    if (!m.has("separator"))
      m.fail("decimal", "'comma'",
             "'point' where the separator is a comma; name the separator ('comma' where such numbers are in "
             "quotes)");
  }
  format.header = m.flag("header", false);
  format.units_row = m.flag("units_row", false);
  format.skip_lines = static_cast<int>(m.number("skip_lines", 0.0, 0, 10000));
  return format;
}

/// `column` of an entry, which stands in the recording or, as `from` says, in the inputs file.
CsvColumn read_input_column(const CsvLayoutMap& m, const CsvLayout& layout) {
  const bool in_inputs = m.word("from", "recording", {"recording", "inputs"}) == "inputs";
  if (in_inputs && !layout.join) m.fail("from", "inputs", "'recording' where the layout has no key 'join'");
  CsvColumn column = m.column("column", in_inputs ? layout.join->format.header : layout.format.header);
  column.in_inputs = in_inputs;
  return column;
}

/// A topic that none of the layout's other inputs has.
std::string read_topic(const CsvLayoutMap& m, const std::string& example, std::set<std::string>& topics) {
  const std::string topic = m.text("topic", "a topic such as " + example);
  if (topic.front() != '/') m.fail("topic", "'" + topic + "'", "a topic that starts with /");
  if (!topics.insert(topic).second) m.fail("topic", "'" + topic + "'", "a topic that no other input has");
  return topic;
}

void read_time(const CsvLayoutMap& m, CsvLayout& layout) {
  if (m.has("unit") && m.has("period_s")) m.fail("period_s", "beside unit", "absent: the one or the other");
  if (m.has("period_s")) {
    layout.time_scale_to_s = m.number("period_s", std::nullopt, 1e-6, 3600.0);
    if (m.has("column")) layout.time_column = m.column("column", layout.format.header);
  } else {
    layout.time_column = m.column("column", layout.format.header);
    layout.time_scale_to_s = m.unit("unit", kTimeUnits);
  }
  layout.start_stamp_s = m.number("start_stamp_s", layout.start_stamp_s, 0.0, 4e9);
}

CsvJoinLayout read_join(const CsvLayoutMap& m, bool header) {
  CsvJoinLayout join;
  join.format = read_format(m);
  join.id = m.column("id", header);
  join.inputs_id = m.column("inputs_id", join.format.header);
  return join;
}

CsvBody read_body(const CsvLayoutMap& m, bool header) {
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
  if (!m.has("orientation")) {
    if (m.has("orientation_order")) m.fail("orientation_order", "without orientation", "absent then");
    return body;
  }
  auto q = m.columns<4>("orientation", header);
  const bool w_first = m.word("orientation_order", std::nullopt, {"xyzw", "wxyz"}) == "wxyz";
  if (w_first) std::rotate(q.begin(), q.begin() + 1, q.end());
  body.orientation = q;
  return body;
}

void read_mocap(const CsvLayoutMap& m, CsvLayout& layout) {
  layout.position_scale_to_m = m.unit("unit", kLengthUnits);
  layout.up = m.word("up", std::nullopt, {"z", "y"}) == "y" ? UpAxis::kY : UpAxis::kZ;
  layout.drop_repeated = m.flag("drop_repeated", false);
  layout.bodies_ahead_s = m.number("ahead_s", 0.0, -3600.0, 3600.0);
  m.require("bodies", "the rigid bodies");
  std::set<std::string> names;
  for (const CsvLayoutMap& body :
       m.list("bodies", {"name", "position", "orientation", "orientation_order", "fixed_orientation"})) {
    layout.bodies.push_back(read_body(body, layout.format.header));
    if (!names.insert(layout.bodies.back().name).second) {
      body.fail("name", "'" + layout.bodies.back().name + "'", "a name that no other body has");
    }
  }
  if (layout.bodies.empty()) m.fail("bodies", "an empty list", "at least one body");
}

void read_pressures(const CsvLayoutMap& m, std::set<std::string>& topics, CsvLayout& layout) {
  const double scale = m.unit("unit", kPressureUnits);
  const bool gauge = m.word("reference", std::nullopt, {"gauge", "absolute"}) == "gauge";
  layout.ambient_pressure_pa = m.number("ambient_pa", 101325.0, 5e4, 1.2e5);
  m.require("inputs", "the pressure columns");
  for (const CsvLayoutMap& input : m.list("inputs", {"topic", "column", "from", "zero"})) {
    layout.pressures.push_back({read_topic(input, "/pressure/chamber_1", topics),
                                read_input_column(input, layout), m.text("unit", ""), scale, gauge,
                                input.number("zero", 0.0, -1e7, 1e7)});
  }
}

void read_scalars(const CsvLayoutMap& m, const std::vector<CsvUnit>& units, const std::string& example,
                  std::set<std::string>& topics, CsvLayout& layout) {
  const double scale = m.unit("unit", units);
  m.require("inputs", "the columns");
  for (const CsvLayoutMap& input : m.list("inputs", {"topic", "column", "from", "zero"})) {
    layout.scalars.push_back({read_topic(input, example, topics), read_input_column(input, layout),
                              m.text("unit", ""), scale, input.number("zero", 0.0, -1e7, 1e7)});
  }
}

void read_payload(const CsvLayoutMap& top, CsvLayout& layout) {
  if (top.require("payload", "the payload").IsMap()) {
    const CsvLayoutMap m = top.map("payload", {"column", "from", "unit"});
    layout.payload_column = CsvPayloadColumn{read_input_column(m, layout), m.unit("unit", kMassUnits)};
    return;
  }
  for (const CsvLayoutMap& step : top.list("payload", {"from_s", "kg"})) {
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

bool may_separate(char c) {
  const auto letter = static_cast<unsigned char>(c);
  return !std::isalnum(letter) && std::string("+-.\"").find(c) == std::string::npos;
}

CsvLayout parse_csv_layout(const std::string& text, const std::string& source) {
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw CsvError(fmt::format("{}:{}: not YAML: {}", source, e.mark.line + 1, e.msg));
  }
  const CsvLayoutMap top(document, source, "",
                         {"separator", "decimal", "header", "units_row", "skip_lines", "time", "trial",
                          "join", "mocap", "pressures", "angles", "tensions", "payload"});
  CsvLayout layout;
  layout.format = read_format(top);
  read_time(top.map("time", {"column", "unit", "period_s", "start_stamp_s"}), layout);
  if (top.has("trial"))
    layout.trial_column = top.map("trial", {"column"}).column("column", layout.format.header);
  if (top.has("join")) {
    layout.join = read_join(
        top.map("join", {"id", "inputs_id", "separator", "decimal", "header", "units_row", "skip_lines"}),
        layout.format.header);
  }
  read_mocap(top.map("mocap", {"unit", "up", "ahead_s", "drop_repeated", "bodies"}), layout);
  std::set<std::string> topics;
  if (top.has("pressures")) {
    read_pressures(top.map("pressures", {"unit", "reference", "ambient_pa", "inputs"}), topics, layout);
  }
  const std::set<std::string> scalar_keys{"unit", "inputs"};
  if (top.has("angles"))
    read_scalars(top.map("angles", scalar_keys), kAngleUnits, "/servo/1/angle", topics, layout);
  if (top.has("tensions"))
    read_scalars(top.map("tensions", scalar_keys), kForceUnits, "/tendon/1/tension", topics, layout);
  if (top.has("payload")) read_payload(top, layout);
  return layout;
}

}  // namespace softarm::trial
