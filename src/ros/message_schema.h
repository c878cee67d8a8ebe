// Reads messages whose package is not here, by the definition that publishers and bags carry.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace softarm {

/// A definition or a message that cannot be read. what() is one line.
class SchemaError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A message definition of ROS 1 with the definitions of all it contains, as the connection header and bags
/// hold it (http://wiki.ros.org/msg: fields, constants, comments; parts divided by a line of '=', each but
/// the first begun by "MSG: package/Name").
class MessageSchema {
 public:
  /// @throws SchemaError for a definition that is none, or that lacks a type
  MessageSchema(const std::string& datatype, const std::string& definition);

  /// The message as objects, arrays, numbers, flags and strings; times and durations as {"sec", "nsec"}.
  /// Floats may be NaN or infinite.
  /// @throws SchemaError if the bytes are too few or too many for the definition
  nlohmann::json decode(const std::uint8_t* data, std::size_t size) const;

  /// Whether a length in a message says how many elements follow. Such a length may be false.
  bool has_lengths() const;
  /// Holds the lengths in a message against its bytes, before somebody makes room for what they say.
  /// @throws SchemaError if the bytes are too few
  void check_lengths(const std::uint8_t* data, std::size_t size) const;

 private:
  struct Field {
    std::string type;
    std::string name;
    bool is_array = false;
    std::optional<std::uint32_t> length;  // of an array; absent: it precedes the array
  };
  using Fields = std::vector<Field>;
  class Reader;

  void add_part(const std::string& datatype, const std::string& text);
  void check_depth() const;
  std::string resolved(const std::string& type, const std::string& package) const;
  void skip_message(const std::string& type, Reader& reader) const;
  nlohmann::json decode_message(const std::string& type, Reader& reader) const;
  nlohmann::json decode_value(const std::string& type, Reader& reader) const;

  std::string datatype_;
  std::map<std::string, Fields> types_;
};

/// The part of a decoded message at "effort[2]", "chambers[0].pressure"; null where there is none.
const nlohmann::json* find_field(const nlohmann::json& message, const std::string& path);

/// The number at a path: NaN where there is none or it is no number. true and false count as 1 and 0.
double number_at(const nlohmann::json& message, const std::string& path);

}  // namespace softarm
