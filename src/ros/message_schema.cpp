#include "message_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <set>
#include <sstream>

namespace softarm {
namespace {

constexpr int kDeepest = 32;
constexpr int kMostEmptyParts = 1000;  // of a message; of those that take no bytes any number fits

/// Bytes that a value takes; of a string 0, as that differs.
const std::map<std::string, std::size_t>& builtins() {
  static const std::map<std::string, std::size_t> sizes{
      {"bool", 1},    {"int8", 1},   {"uint8", 1},  {"byte", 1},    {"char", 1},   {"int16", 2},
      {"uint16", 2},  {"int32", 4},  {"uint32", 4}, {"int64", 8},   {"uint64", 8}, {"float32", 4},
      {"float64", 8}, {"string", 0}, {"time", 8},   {"duration", 8}};
  return sizes;
}

std::string trimmed(const std::string& text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), is_space).base();
  return std::string(begin, end);
}

std::string package_of(const std::string& type) {
  const std::size_t slash = type.find('/');
  return slash == std::string::npos ? "" : type.substr(0, slash);
}

}  // namespace

/// ROS's serialisation: little-endian, without padding.
class MessageSchema::Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  template <class T>
  T read() {
    take(sizeof(T));
    T value;
    std::memcpy(&value, at_ - sizeof(T), sizeof(T));
    return value;
  }
  std::string read_string() {
    const auto size = read<std::uint32_t>();
    take(size);
    return std::string(reinterpret_cast<const char*>(at_) - size, size);
  }
  /// @param fixed of an array; absent: it stands before it
  std::uint32_t length(const std::optional<std::uint32_t>& fixed) {
    return fixed ? *fixed : read<std::uint32_t>();
  }
  std::size_t left() const { return left_; }
  void take(std::size_t size) {
    if (size > left_) throw SchemaError("the message is shorter than its definition says");
    at_ += size;
    left_ -= size;
  }
  /// @param left_before of a part that has been read
  void end_part(std::size_t left_before) {
    if (left_ == left_before && ++empty_parts_ > kMostEmptyParts)
      throw SchemaError(fmt::format("the message has more than {} empty parts", kMostEmptyParts));
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
  int empty_parts_ = 0;
};

MessageSchema::MessageSchema(const std::string& datatype, const std::string& definition)
    : datatype_(datatype) {
  std::istringstream lines(definition);
  std::string line, part, type = datatype;
  bool begins = false;
  while (std::getline(lines, line)) {
    const std::string bare = trimmed(line);
    if (bare.size() >= 40 && bare.find_first_not_of('=') == std::string::npos) {
      add_part(type, part);
      part.clear();
      begins = true;
    } else if (begins) {
      if (bare.rfind("MSG:", 0) != 0)
        throw SchemaError(datatype + ": its definition has a part without a name");
      type = trimmed(bare.substr(4));
      begins = false;
    } else {
      part += line + "\n";
    }
  }
  add_part(type, part);
  for (auto& [name, fields] : types_) {
    for (Field& field : fields) field.type = resolved(field.type, package_of(name));
  }
  check_depth();
}

void MessageSchema::add_part(const std::string& datatype, const std::string& text) {
  Fields fields;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty() || line.find('=') != std::string::npos) continue;  // a constant is not sent
    Field field;
    std::istringstream words(line);
    words >> field.type >> field.name;
    if (field.name.empty())
      throw SchemaError(fmt::format("{}: its definition has a line '{}'", datatype, line));
    const std::size_t bracket = field.type.find('[');
    if (bracket != std::string::npos) {
      const std::string length = field.type.substr(bracket + 1, field.type.size() - bracket - 2);
      const bool is_number =
          length.size() < 10 &&
          std::all_of(length.begin(), length.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
      if (field.type.back() != ']' || !is_number) {
        throw SchemaError(fmt::format("{}: its definition has an array '{}'", datatype, field.type));
      }
      field.is_array = true;
      if (!length.empty()) field.length = static_cast<std::uint32_t>(std::stoul(length));
      field.type.resize(bracket);
    }
    fields.push_back(std::move(field));
  }
  types_[datatype] = std::move(fields);
}

std::string MessageSchema::resolved(const std::string& type, const std::string& package) const {
  if (builtins().count(type) || types_.count(type)) return type;
  const std::string full = type == "Header" ? "std_msgs/Header" : package + "/" + type;
  if (types_.count(full)) return full;
  // A definition may come under another name than that of its package (our mirrors): the parts decide.
  for (const auto& [name, fields] : types_) {
    if (name.size() > type.size() + 1 &&
        name.compare(name.size() - type.size() - 1, type.size() + 1, "/" + type) == 0) {
      return name;
    }
  }
  throw SchemaError(fmt::format("{}: its definition lacks that of {}", datatype_, type));
}

void MessageSchema::check_depth() const {
  std::set<std::string> level{datatype_};
  for (int depth = 0; !level.empty(); ++depth) {
    if (depth > kDeepest) throw SchemaError(fmt::format("{}: its definition contains itself", datatype_));
    std::set<std::string> next;
    for (const std::string& type : level) {
      const auto found = types_.find(type);
      if (found == types_.end()) continue;
      for (const Field& field : found->second) next.insert(field.type);
    }
    level = std::move(next);
  }
}

nlohmann::json MessageSchema::decode(const std::uint8_t* data, std::size_t size) const {
  Reader reader(data, size);
  nlohmann::json message = decode_message(datatype_, reader);
  if (reader.left() > 0) throw SchemaError("the message is longer than its definition says");
  return message;
}

bool MessageSchema::has_lengths() const {
  return std::any_of(types_.begin(), types_.end(), [](const auto& type) {
    return std::any_of(type.second.begin(), type.second.end(),
                       [](const Field& field) { return field.is_array && !field.length; });
  });
}

void MessageSchema::check_lengths(const std::uint8_t* data, std::size_t size) const {
  Reader reader(data, size);
  skip_message(datatype_, reader);
}

void MessageSchema::skip_message(const std::string& type, Reader& reader) const {
  const std::size_t before = reader.left();
  for (const Field& field : types_.at(type)) {
    const std::uint32_t count = field.is_array ? reader.length(field.length) : 1;
    const auto builtin = builtins().find(field.type);
    if (builtin != builtins().end() && builtin->second > 0) {
      reader.take(count * builtin->second);
      continue;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      if (builtin != builtins().end())
        reader.take(reader.read<std::uint32_t>());
      else
        skip_message(field.type, reader);
    }
  }
  reader.end_part(before);
}

nlohmann::json MessageSchema::decode_message(const std::string& type, Reader& reader) const {
  nlohmann::json message = nlohmann::json::object();
  const std::size_t before = reader.left();
  for (const Field& field : types_.at(type)) {
    if (!field.is_array) {
      message[field.name] = decode_value(field.type, reader);
      continue;
    }
    const std::uint32_t length = reader.length(field.length);
    nlohmann::json array = nlohmann::json::array();
    for (std::uint32_t i = 0; i < length; ++i) array.push_back(decode_value(field.type, reader));
    message[field.name] = std::move(array);
  }
  reader.end_part(before);
  return message;
}

nlohmann::json MessageSchema::decode_value(const std::string& type, Reader& reader) const {
  if (!builtins().count(type)) return decode_message(type, reader);
  if (type == "bool") return reader.read<std::uint8_t>() != 0;
  if (type == "int8" || type == "byte") return reader.read<std::int8_t>();
  if (type == "uint8" || type == "char") return reader.read<std::uint8_t>();
  if (type == "int16") return reader.read<std::int16_t>();
  if (type == "uint16") return reader.read<std::uint16_t>();
  if (type == "int32") return reader.read<std::int32_t>();
  if (type == "uint32") return reader.read<std::uint32_t>();
  if (type == "int64") return reader.read<std::int64_t>();
  if (type == "uint64") return reader.read<std::uint64_t>();
  if (type == "float32") return reader.read<float>();
  if (type == "float64") return reader.read<double>();
  if (type == "string") return reader.read_string();
  if (type == "time") {
    const auto sec = reader.read<std::uint32_t>();
    return {{"sec", sec}, {"nsec", reader.read<std::uint32_t>()}};
  }
  const auto sec = reader.read<std::int32_t>();
  return {{"sec", sec}, {"nsec", reader.read<std::int32_t>()}};
}

const nlohmann::json* find_field(const nlohmann::json& message, const std::string& path) {
  const nlohmann::json* at = &message;
  std::istringstream steps(path);
  std::string step;
  while (std::getline(steps, step, '.')) {
    const std::size_t bracket = step.find('[');
    const auto member = at->is_object() ? at->find(step.substr(0, bracket)) : at->end();
    if (!at->is_object() || member == at->end()) return nullptr;
    at = &*member;
    if (bracket == std::string::npos) continue;
    const std::size_t index = std::stoul(step.substr(bracket + 1));
    if (!at->is_array() || index >= at->size()) return nullptr;
    at = &(*at)[index];
  }
  return at;
}

double number_at(const nlohmann::json& message, const std::string& path) {
  const nlohmann::json* found = find_field(message, path);
  if (found && found->is_boolean()) return found->get<bool>() ? 1.0 : 0.0;
  return found && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace softarm
