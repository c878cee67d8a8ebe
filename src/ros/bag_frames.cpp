#include "bag_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rosbag/exceptions.h>
#include <rosbag/view.h>

#include <algorithm>
#include <utility>

#include "input_topics.h"

namespace softarm {
namespace {

constexpr std::uint64_t kProgressMessages = 256;

trial::FrameAssembler::Params all_of_a_record_time() {
  trial::FrameAssembler::Params params;
  params.close_when_taken = true;
  return params;
}

/// What a topic has in place of what is read of it; empty: nothing.
/// @param md5s of all that was published on it
std::string instead_of(const InputTopic& topic, const std::string& type, const std::set<std::string>& md5s) {
  if (!topic.has_type(type)) return fmt::format("{}, the arm expects {}", type, topic.type);
  if (topic.md5.empty() || md5s.count(topic.md5) != 0) return "";
  return fmt::format(
      "{} by another definition (MD5 {}) than the one known here (MD5 {}): record it again with that one, or "
      "convert the bag (rosbag fix)",
      type, *md5s.begin(), topic.md5);
}

/// What became of the messages of one of the arm's topics.
struct TopicReading {
  const InputTopic* topic;
  std::uint64_t added = 0, undecodable = 0;
  double first_undecodable_s = 0.0;  // since the first message
};

void read_into(trial::FrameAssembler& assembler, const BagMessage& message, double t_s,
               TopicReading& reading) {
  switch (reading.topic->read(message, assembler)) {
    case BagReading::kAdded:
      ++reading.added;
      break;
    case BagReading::kOtherDefinition:  // of several publishers one may have it so
      if (reading.topic->has_type(message.type))
        assembler.count_rejected("other_definition", reading.topic->feeds);
      break;
    case BagReading::kUndecodable:
      if (++reading.undecodable == 1) reading.first_undecodable_s = t_s;
      break;
  }
}

/// For people, of a topic of which messages cannot be read.
/// @throws BagError where that is every one. A type that is not known here is read by the definition that
/// comes along, which may itself be wrong: of such a topic it is only said.
std::string words_of_undecodable(const std::string& path, const TopicReading& reading) {
  const InputTopic& topic = *reading.topic;
  if (reading.added == 0 && !topic.md5.empty())
    throw BagError(fmt::format(
        "{}: damaged: not one of {} messages of topic {} ({}) can be read: copy the bag again, or record it "
        "again",
        path, reading.undecodable, topic.topic, topic.feeds));
  return fmt::format(
      "{}: {} of {} messages of topic {} ({}) cannot be read and are left out, the first at {:.1f} s: "
      "damaged, or of another version of their driver",
      path, reading.undecodable, reading.added + reading.undecodable, topic.topic, topic.feeds,
      reading.first_undecodable_s);
}

}  // namespace

BagFrames::BagFrames(const std::string& path, const arm::Arm& arm, bool use_payload)
    : path_(path), assembler_(arm, all_of_a_record_time()), topics_(input_topics(arm)) {
  if (!use_payload) {
    const auto is_payload = [&](const InputTopic& t) { return t.topic == arm.inputs.payload_topic; };
    topics_.erase(std::remove_if(topics_.begin(), topics_.end(), is_payload), topics_.end());
  }
  open();
  compare(arm);
  for (const InputTopic& topic : topics_) {
    // Recorders may have left the leading slash out.
    names_.push_back(absolute_topic(topic.topic));
    names_.push_back(absolute_topic(topic.topic).substr(1));
  }
  messages_ = rosbag::View(*bag_, rosbag::TopicQuery(names_)).size();
}

void BagFrames::open() {
  bag_ = open_bag(path_);
  rosbag::View view(*bag_);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    const std::string topic = absolute_topic(connection->topic);
    const auto first = in_bag_.emplace(topic, connection->datatype).first;
    if (connection->datatype == first->second) md5s_[topic].insert(connection->md5sum);
  }
}

void BagFrames::compare(const arm::Arm& arm) {
  std::vector<InputTopic> present;
  std::vector<std::string> expected;
  std::string base_redefined, bodies_redefined;  // why they cannot be read
  bool has_body = false, has_base = !arm.base.body;
  for (InputTopic& topic : topics_) {
    expected.push_back(topic.topic);
    const auto found = in_bag_.find(absolute_topic(topic.topic));
    if (found == in_bag_.end()) {
      // The payload may well be unknown: that is no fault of the recording.
      if (topic.topic != arm.inputs.payload_topic) {
        warnings_.push_back(fmt::format("{}: no topic {} ({})", path_, topic.topic, topic.feeds));
      }
      continue;
    }
    const std::string instead = instead_of(topic, found->second, md5s_.at(found->first));
    if (!instead.empty()) {
      const std::string what = fmt::format("topic {} ({}) is {}", topic.topic, topic.feeds, instead);
      warnings_.push_back(fmt::format("{}: {}", path_, what));
      std::string& reason = topic.feeds_base ? base_redefined : bodies_redefined;
      const bool is_first = reason.empty() && (topic.feeds_base || topic.feeds_bodies);
      if (is_first && topic.has_type(found->second)) reason = what;
      continue;
    }
    has_base = has_base || topic.feeds_base;
    has_body = has_body || topic.feeds_bodies;
    present.push_back(std::move(topic));
  }
  topics_ = std::move(present);
  if (has_base && has_body) return;
  const std::string& redefined = has_base ? bodies_redefined : base_redefined;
  if (!redefined.empty())
    throw BagError(fmt::format("{}: {}: {}", path_,
                               has_base ? "no measured body can be read" : "the base cannot be read",
                               redefined));
  std::vector<std::string> listed;
  for (const auto& [topic, type] : in_bag_) listed.push_back(fmt::format("{} ({})", topic, type));
  throw BagError(fmt::format("{}: {}; arm {} expects {} ({} for bodies), the bag has {}", path_,
                             has_base ? "no measured body is in it" : "the base is not in it", arm.name,
                             fmt::join(expected, ", "), arm.inputs.bodies.type,
                             listed.empty() ? "nothing" : fmt::format("{}", fmt::join(listed, ", "))));
}

void BagFrames::deliver(const Callbacks& callbacks) {
  for (const trial::Frame& frame : assembler_.take_before_jump()) callbacks.on_frame(frame);
  if (assembler_.take_time_jump()) callbacks.on_time_jump();
  for (const trial::Frame& frame : assembler_.take()) callbacks.on_frame(frame);
}

void BagFrames::read(const Callbacks& callbacks) {
  // Two sources may share a topic: base and rings on /tf, under frames of their own.
  std::map<std::string, std::vector<TopicReading>> by_topic;
  for (const InputTopic& topic : topics_)
    by_topic[absolute_topic(topic.topic)].push_back(TopicReading{&topic});
  std::uint64_t unreported = 0;
  ros::Time recorded;
  try {
    rosbag::View view(*bag_, rosbag::TopicQuery(names_));
    const double begin_s = view.getBeginTime().toSec();
    for (const rosbag::MessageInstance& instance : view) {
      if (instance.getTime() != std::exchange(recorded, instance.getTime())) deliver(callbacks);
      const BagMessage message = bag_message(instance);
      for (TopicReading& reading : by_topic.at(absolute_topic(message.topic)))
        read_into(assembler_, message, recorded.toSec() - begin_s, reading);
      if (++unreported == kProgressMessages) {
        callbacks.on_messages(unreported);
        unreported = 0;
      }
    }
  } catch (const ros::Exception& e) {
    throw BagError(fmt::format("{}: damaged ({})", path_, e.what()));
  }
  for (const auto& [name, readings] : by_topic) {
    for (const TopicReading& reading : readings)
      if (reading.undecodable > 0) warnings_.push_back(words_of_undecodable(path_, reading));
  }
  deliver(callbacks);
  assembler_.flush();
  deliver(callbacks);
  callbacks.on_messages(unreported);
}

}  // namespace softarm
