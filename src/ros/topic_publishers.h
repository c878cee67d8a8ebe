// Who publishes on a topic, by what arrives.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace softarm {

/// Counts losses by the numbers in the headers, which each publisher counts for itself, and sees where two
/// send at a time: then their messages alternate. One that takes the other's place, as where a driver is
/// started again, is no second one.
class TopicPublishers {
 public:
  /// @param sequence header.seq; absent where a message has no header, or cannot be read
  /// @return how many messages of this publisher were lost right before it
  std::uint32_t add(const std::string& publisher, std::optional<std::uint32_t> sequence);

  /// Ends a second or so: messages alternate no longer where none of it has come from another publisher than
  /// the one before.
  void end_period();

  /// Names of two whose messages alternate.
  std::optional<std::pair<std::string, std::string>> two() const;

 private:
  std::map<std::string, std::optional<std::uint32_t>> sequences_;  // by publisher
  std::string last_, other_;                                       // of the last message, and before it
  int changes_ = 0, changes_before_ = 0;
};

}  // namespace softarm
