// The last minutes of an arm's topics, ready to be written as trials.
#pragma once

#include <ros/message_event.h>
#include <topic_tools/shape_shifter.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace softarm {

/// One message of any type, as it came. Copies share the message.
struct RecentMessage {
  std::string topic;
  ros::Time receipt;
  boost::shared_ptr<topic_tools::ShapeShifter const> message;
  boost::shared_ptr<ros::M_string> connection;  ///< header of its connection; may be null

  bool latched() const;
};

/// Keeps messages of a last time, in order of receipt, and of each latched topic the newest of before.
class RecentMessages {
 public:
  /// @param keep_s so long
  /// @param most_bytes at most so much of the messages themselves: the oldest go first
  RecentMessages(double keep_s, std::size_t most_bytes) : keep_s_(keep_s), most_bytes_(most_bytes) {}

  /// A message received before the newest one by more than a second (time went back) makes all before it go.
  void add(RecentMessage message);
  void clear();

  const std::deque<RecentMessage>& messages() const { return messages_; }
  /// The newest latched message of each topic from before the first of messages().
  const std::map<std::string, RecentMessage>& before() const { return before_; }
  std::size_t bytes() const { return bytes_; }
  double duration_s() const;
  std::uint64_t dropped_for_size() const { return dropped_for_size_; }

 private:
  void drop_oldest();

  double keep_s_;
  std::size_t most_bytes_, bytes_ = 0;
  std::uint64_t dropped_for_size_ = 0;
  std::deque<RecentMessage> messages_;
  std::map<std::string, RecentMessage> before_;
};

/// Writes messages as bags of equal duration, `folder`/trial_01.bag ..., each beginning with the latched
/// messages that held then (recorded at its begin). As many as come nearest to trial_s each, at least one.
/// Each is written under another name and renamed, so that there is never half a trial.
/// @return their paths
/// @throws std::runtime_error in one line where there is nothing to write or the folder cannot be written
std::vector<std::string> write_trials(const RecentMessages& recent, const std::string& folder,
                                      double trial_s);

}  // namespace softarm
