#include "yaml_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "edit_distance.h"
#include "math/parse_number.h"
#include "softarm/arm/arm_file.h"

namespace softarm::arm::yaml {
namespace {

constexpr std::size_t kLongestQuote = 60;

/// A path, whole: who is told of a file must be able to open it.
std::string path_shown(std::string path) {
  for (char& c : path)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return path;
}

/// What the user wrote, fit for one line of a message.
std::string one_line(const std::string& text) {
  std::string clean;
  for (const char c : text) {
    if (clean.size() >= kLongestQuote) {
      clean += "...";
      break;
    }
    clean += (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) ? ' ' : c;
  }
  return clean;
}

std::string shown(const YAML::Node& node) {
  if (node.IsNull()) return "(nothing)";
  if (node.IsScalar()) return one_line(node.Scalar());
  if (node.IsMap()) return "(a section)";
  std::string items;
  for (const YAML::Node& item : node) {
    items += (items.empty() ? "" : ", ") + (item.IsScalar() ? item.Scalar() : std::string("..."));
  }
  return one_line("[" + items + "]");
}

/// A number in YAML's notation, independent of the locale. Infinite and NaN are numbers here; callers refuse
/// them.
std::optional<double> to_number(std::string text) {
  if (!text.empty() && text.front() == '+') text.erase(0, 1);
  std::string bare = text;
  if (!bare.empty() && bare.front() == '-') bare.erase(0, 1);
  std::transform(bare.begin(), bare.end(), bare.begin(), [](unsigned char c) { return std::tolower(c); });
  if (bare == ".inf") return HUGE_VAL;
  if (bare == ".nan") return std::nan("");
  return math::parse_number(text);
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_name_char(char c) {
  return is_letter(c) || (c >= '0' && c <= '9') || c == '_';
}
/// @param also characters allowed after the first
bool is_name(const std::string& word, const std::string& also) {
  return !word.empty() && is_letter(word.front()) && std::all_of(word.begin(), word.end(), [&also](char c) {
    return is_name_char(c) || also.find(c) != std::string::npos;
  });
}

}  // namespace

Section::Section(std::string source, const YAML::Node& node, std::string path, const KeyTable& table,
                 int line)
    : source_(std::move(source)), path_(std::move(path)), table_(&table), line_(line) {
  if (node.IsNull()) return;
  if (!node.IsMap()) fail_at(line_, path_, fmt::format("value {} is not a section of keys", shown(node)));
  for (const auto& entry : node) {
    const int key_line = entry.first.Mark().line + 1;
    if (!entry.first.IsScalar()) fail_at(key_line, path_, "a key must be a word");
    const std::string key = entry.first.Scalar();
    if (table_->find(key) == nullptr) fail_unknown(key, key_line);
    if (!given_.emplace(key, Given{entry.second, key_line}).second) {
      fail_at(key_line, path_of(key), fmt::format("is given twice, first on line {}", given_.at(key).line));
    }
  }
}

std::string Section::path_of(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

std::string Section::place() const {
  return fmt::format("{}:{}", path_shown(source_), line_);
}

void Section::fail_at(int line, const std::string& path, const std::string& problem) const {
  throw ArmError(fmt::format("{}:{}: key '{}': {}", path_shown(source_), line, path, problem));
}

void Section::fail(const std::string& key, const std::string& problem) const {
  const auto found = given_.find(key);
  fail_at(found == given_.end() ? line_ : found->second.line, path_of(key), problem);
}

void Section::fail_value(const std::string& key, const std::string& problem) const {
  fail(key, fmt::format("value {} {}", shown(value(key)), problem));
}

void Section::fail_unknown(const std::string& key, int line) const {
  std::vector<std::string> names;
  for (const KeySpec& spec : table_->keys) names.push_back(spec.name);
  const std::optional<std::string> nearest = nearest_word(key, names);
  fail_at(line, path_of(one_line(key)),
          nearest ? fmt::format("unknown key; did you mean '{}'?", *nearest)
                  : fmt::format("unknown key; allowed here: {}", fmt::join(names, ", ")));
}

const KeySpec& Section::spec(const std::string& key) const {
  const KeySpec* const found = table_->find(key);
  if (found == nullptr) throw std::logic_error("no key '" + key + "' in table " + table_->section);
  return *found;
}

void Section::require(const std::string& key, const std::string& reason) const {
  if (!has(key)) fail(key, fmt::format("is missing; {}; allowed: {}", reason, allowed_values(spec(key))));
}

YAML::Node Section::value(const std::string& key) const {
  const auto found = given_.find(key);
  if (found != given_.end()) return found->second.value;
  const KeySpec& key_spec = spec(key);
  if (key_spec.fallback == kRequired) {
    fail(key, fmt::format("is missing; {}; allowed: {}", key_spec.meaning, allowed_values(key_spec)));
  }
  if (key_spec.fallback == kAbsent) throw std::logic_error("absent key '" + key + "' was read");
  const std::string& text = key_spec.fallback;
  // A word or a number needs no parser, which takes longer than all else here.
  return text.empty() || text[0] == '[' || text[0] == '{' ? YAML::Load(text) : YAML::Node(text);
}

std::string Section::scalar(const std::string& key, const std::string& expected) const {
  const YAML::Node node = value(key);
  if (node.IsNull()) fail(key, fmt::format("has no value; expected {}", expected));
  if (!node.IsScalar()) fail(key, fmt::format("value {} is not {}", shown(node), expected));
  return node.Scalar();
}

double Section::checked_number(const std::string& key, const std::string& path,
                               const std::string& text) const {
  const KeySpec& key_spec = spec(key);
  const int line = has(key) ? given_.at(key).line : line_;
  const std::string range = fmt::format("[{:g}, {:g}]{}", key_spec.low, key_spec.high,
                                        key_spec.unit.empty() ? "" : " " + key_spec.unit);
  const std::optional<double> number = to_number(text);
  if (!number) {
    const std::string words =
        key_spec.words.empty() ? "" : fmt::format(" nor one of: {}", fmt::join(key_spec.words, ", "));
    fail_at(line, path, fmt::format("value '{}' is not a number in {}{}", one_line(text), range, words));
  }
  if (!std::isfinite(*number)) {
    fail_at(line, path, fmt::format("value {} is not finite; allowed: {}", one_line(text), range));
  }
  if (!(*number >= key_spec.low && *number <= key_spec.high)) {
    fail_at(line, path, fmt::format("value {} is outside the allowed range {}", one_line(text), range));
  }
  return *number;
}

double Section::number(const std::string& key) const {
  return checked_number(key, path_of(key), scalar(key, "a number in " + allowed_values(spec(key))));
}

int Section::integer(const std::string& key) const {
  const double number_value = number(key);
  if (number_value != std::floor(number_value)) {
    fail_value(key, fmt::format("is not an integer; allowed: {}", allowed_values(spec(key))));
  }
  return static_cast<int>(number_value);
}

bool Section::flag(const std::string& key) const {
  const std::string text = scalar(key, "true or false");
  if (text != "true" && text != "false") fail_value(key, "is neither true nor false");
  return text == "true";
}

std::string Section::word(const std::string& key) const {
  const std::vector<std::string>& words = spec(key).words;
  const std::string text = scalar(key, fmt::format("one of: {}", fmt::join(words, ", ")));
  if (std::find(words.begin(), words.end(), text) == words.end()) {
    fail(key, fmt::format("value '{}' is none of: {}", one_line(text), fmt::join(words, ", ")));
  }
  return text;
}

std::optional<double> Section::number_or_word(const std::string& key) const {
  const std::vector<std::string>& words = spec(key).words;
  const std::string text = scalar(key, allowed_values(spec(key)));
  if (std::find(words.begin(), words.end(), text) != words.end()) return std::nullopt;
  return checked_number(key, path_of(key), text);
}

Eigen::VectorXd Section::vector(const std::string& key) const {
  const KeySpec& key_spec = spec(key);
  const YAML::Node node = value(key);
  if (!node.IsSequence() || node.size() != static_cast<std::size_t>(key_spec.count)) {
    fail(key, fmt::format("value {} is not a list of {}", shown(node), allowed_values(key_spec)));
  }
  Eigen::VectorXd numbers(key_spec.count);
  Eigen::Index i = 0;
  for (const YAML::Node& item : node) {
    const std::string path = fmt::format("{}[{}]", path_of(key), i);
    if (!item.IsScalar()) fail(key, fmt::format("element {} is not a number", i));
    numbers(i++) = checked_number(key, path, item.Scalar());
  }
  return numbers;
}

Range Section::range(const std::string& key) const {
  const Eigen::VectorXd limits = vector(key);
  if (!(limits(0) < limits(1))) fail_value(key, "is not a range: the first number must be below the second");
  return {limits(0), limits(1)};
}

std::string Section::text(const std::string& key) const {
  std::string text = scalar(key, "text");
  if (text.empty()) fail(key, "value '' is empty");
  return text;
}

std::string Section::name(const std::string& key, const std::string& also) const {
  std::string name = text(key);
  if (!is_name(name, also)) {
    fail(key, fmt::format("value '{}' is not a name: a letter, then letters, digits or any of '_{}'",
                          one_line(name), also));
  }
  return name;
}

std::string Section::topic(const std::string& key, const std::string& placeholder) const {
  const std::string topic = text(key);
  std::string bare = topic;
  if (!placeholder.empty()) {
    if (bare.find(placeholder) == std::string::npos) {
      fail(key, fmt::format("value '{}' does not contain {}", one_line(topic), placeholder));
    }
    for (std::size_t at; (at = bare.find(placeholder)) != std::string::npos;) {
      bare.replace(at, placeholder.size(), "x");
    }
  }
  const bool legal =
      (is_letter(bare.front()) || bare.front() == '/' || bare.front() == '~') && bare.back() != '/' &&
      bare.find("//") == std::string::npos &&
      std::all_of(bare.begin() + 1, bare.end(), [](char c) { return is_name_char(c) || c == '/'; });
  if (!legal) {
    fail(key, fmt::format("value '{}' is not a ROS topic: letters, digits, '_' and '/'", one_line(topic)));
  }
  return topic;
}

std::vector<std::pair<std::string, double>> Section::numbers(const std::string& key,
                                                             const std::string& also) const {
  const YAML::Node node = value(key);
  std::vector<std::pair<std::string, double>> list;
  if (!node.IsMap()) fail_value(key, "is not a section of names with a number each");
  for (const auto& entry : node) {
    const int line = entry.second.Mark().line >= 0 ? entry.second.Mark().line + 1 : line_;
    if (!entry.first.IsScalar()) fail_at(line, path_of(key), "a key must be a word");
    const std::string name = entry.first.Scalar();
    const std::string path = path_of(key) + "." + one_line(name);
    if (!is_name(name, also))
      fail_at(line, path, fmt::format("is not a name: a letter, then letters, digits or any of '_{}'", also));
    const bool twice =
        std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.first == name; });
    if (twice) fail_at(line, path, "is given twice");
    const std::optional<double> number =
        entry.second.IsScalar() ? to_number(entry.second.Scalar()) : std::nullopt;
    if (!number || !std::isfinite(*number))
      fail_at(line, path, fmt::format("value {} is not a finite number", shown(entry.second)));
    list.emplace_back(name, *number);
  }
  return list;
}

Section Section::section(const std::string& key, const KeyTable& table) const {
  return Section(source_, value(key), path_of(key), table, has(key) ? given_.at(key).line : line_);
}

std::vector<Section> Section::list(const std::string& key, const KeyTable& table) const {
  const YAML::Node node = value(key);
  if (!node.IsSequence()) fail(key, fmt::format("value {} is not a list", shown(node)));
  if (static_cast<double>(node.size()) > spec(key).high)
    fail(key, fmt::format("has {} entries; allowed: {}", node.size(), allowed_values(spec(key))));
  std::vector<Section> sections;
  sections.reserve(node.size());
  int i = 0;
  for (const YAML::Node& item : node) {
    const std::string path = fmt::format("{}[{}]", path_of(key), i++);
    const int line = item.Mark().line + 1;
    if (!item.IsMap()) fail_at(line, path, fmt::format("value {} is not a section of keys", shown(item)));
    sections.emplace_back(source_, item, path, table, line);
  }
  return sections;
}

namespace {

/// The line on which a document's content begins; none: it is empty.
class ContentBegins : public YAML::EventHandler {
 public:
  std::optional<int> line;
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { at(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string&) override {
    at(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    at(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    at(mark);
  }
  void OnMapEnd() override {}

 private:
  void at(const YAML::Mark& mark) {
    if (!line) line = std::max(0, mark.line) + 1;
  }
};

/// The line on which a second document begins. Not by YAML::LoadAll: of some broken texts that finds
/// documents for ever.
std::optional<int> second_document(const std::string& text) {
  std::stringstream stream(text);
  YAML::Parser parser(stream);
  ContentBegins first, second;
  if (parser.HandleNextDocument(first) && first.line) parser.HandleNextDocument(second);
  return second.line;
}

}  // namespace

Section parse_document(const std::string& text, const std::string& source, const KeyTable& table) {
  const std::string where = path_shown(source);
  YAML::Node document;
  std::optional<int> second;
  try {
    const std::string closed = text + " #";  // without it "{key:" at the end hangs yaml-cpp 0.6
    document = YAML::Load(closed);
    second = second_document(closed);
  } catch (const YAML::Exception& error) {
    // what() repeats the position; msg is the bare reason.
    throw ArmError(
        fmt::format("{}:{}: not YAML: {}", where, std::max(0, error.mark.line) + 1, one_line(error.msg)));
  }
  if (document.IsNull()) throw ArmError(where + ":1: the document is empty");
  if (second) {
    throw ArmError(fmt::format("{}:{}: a second document begins; one arm is expected", where, *second));
  }
  if (!document.IsMap()) {
    throw ArmError(fmt::format("{}:1: {} is not a section of keys", where, shown(document)));
  }
  return Section(source, document, "", table, 1);
}

}  // namespace softarm::arm::yaml
