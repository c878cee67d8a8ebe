// The last minutes of an arm's topics, ready to be written as trials.
#pragma once

#include <ros/message_event.h>
#include <topic_tools/shape_shifter.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace softarm {

/// What all messages of a connection have in common. A definition is longer than most messages: each keeping
/// its own would take twenty times their memory.
struct RecentSource {
  std::string topic, type, md5, definition;
  boost::shared_ptr<ros::M_string> connection;  ///< header of its connection; may be null

  bool latched() const;
  /// What it takes of the memory. A publisher that comes anew for each message (`rostopic pub`) has one for
  /// each.
  std::size_t footprint() const;
};

/// One message of any type, as it came. Copies share the message.
struct RecentMessage {
  ros::Time receipt;
  std::shared_ptr<const RecentSource> source;
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;

  /// What one of so many bytes takes of the memory, with all that is needed to keep it but its source.
  static std::size_t footprint(std::size_t size);
  std::size_t footprint() const { return footprint(bytes->size()); }
};

/// Keeps messages of a last time, in order of receipt, and of each latched topic the newest of before.
class RecentMessages {
 public:
  /// @param keep_s so long
  /// @param most_bytes at most so much memory: the oldest go first
  RecentMessages(double keep_s, std::size_t most_bytes) : keep_s_(keep_s), most_bytes_(most_bytes) {}

  /// A message received before the newest one by more than a second (time went back) makes all before it go,
  /// but for the latched ones. One that, with its source, is larger than all memory for messages is not kept.
  void add(const std::string& topic, const ros::Time& receipt, const topic_tools::ShapeShifter& message,
           const boost::shared_ptr<ros::M_string>& connection);

  const std::deque<RecentMessage>& messages() const { return messages_; }
  /// The newest latched message of each topic from before the first of messages().
  const std::map<std::string, RecentMessage>& before() const { return before_; }
  /// Of the memory, for messages(), before() and their sources.
  std::size_t bytes() const { return bytes_; }
  double duration_s() const;
  std::uint64_t dropped_for_size() const { return dropped_for_size_; }

 private:
  /// What is kept of a source.
  struct Held {
    std::size_t messages = 0, footprint = 0;
  };
  using Sources = std::map<std::shared_ptr<const RecentSource>, Held>;

  Sources::iterator source_of(const std::string& topic, const topic_tools::ShapeShifter& message,
                              const boost::shared_ptr<ros::M_string>& connection);
  void hold(const RecentMessage& message);
  void release(const RecentMessage& message);
  void drop_oldest();

  double keep_s_;
  std::size_t most_bytes_, bytes_ = 0;
  std::uint64_t dropped_for_size_ = 0;
  std::deque<RecentMessage> messages_;
  std::map<std::string, RecentMessage> before_;
  Sources sources_;
};

/// Writes messages as bags of equal duration, `folder`/trial_01.bag ..., each beginning with the latched
/// messages that held then (recorded at its begin). As many as come nearest to trial_s each, at least one.
/// Each is written under another name and renamed, so that there is never half a trial.
/// @return their paths
/// @throws std::runtime_error in one line where there is nothing to write or the folder cannot be written
std::vector<std::string> write_trials(const RecentMessages& recent, const std::string& folder,
                                      double trial_s);

}  // namespace softarm
