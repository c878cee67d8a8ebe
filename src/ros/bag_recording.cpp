#include "bag_recording.h"

#include <fmt/format.h>
#include <rosbag/exceptions.h>
#include <rosbag/view.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/String.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "bag_message.h"
#include "bag_writer.h"
#include "input_topics.h"
#include "open_bag.h"

namespace softarm {
namespace {

constexpr std::uint64_t kMessagesPerProgress = 256;
constexpr double kFrameIntervalS = 0.1;  // of the frames that are kept

/// What the arm listens to, and what the bag has of it.
std::vector<trial::RecordedTopic> compare(const std::vector<InputTopic>& topics, const arm::Arm& arm,
                                          std::map<std::string, std::string>& others) {
  const std::map<std::string, std::string> in_bag = others;
  std::vector<trial::RecordedTopic> recorded;
  for (const InputTopic& topic : topics) {
    trial::RecordedTopic r;
    r.topic = topic.topic;
    r.type = topic.type;
    r.feeds = topic.feeds;
    r.of_payload = topic.topic == arm.inputs.payload_topic;
    r.of_bodies = topic.feeds_bodies || topic.feeds_base;
    r.is_base = topic.feeds_base;
    const auto found = in_bag.find(absolute_topic(topic.topic));
    if (found != in_bag.end()) {
      r.found_type = topic.has_type(found->second) ? topic.type : found->second;
      others.erase(found->first);
    }
    recorded.push_back(r);
  }
  return recorded;
}

/// Which topics of the bag feed which of the arm's, by absolute name. Two sources may share a topic: base and
/// rings on /tf, under frames of their own.
using ByTopic = std::map<std::string, std::vector<std::size_t>>;

ByTopic by_name(const std::vector<InputTopic>& topics, const std::vector<trial::RecordedTopic>& recorded) {
  ByTopic by_topic;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (recorded[i].found_type == topics[i].type) by_topic[absolute_topic(topics[i].topic)].push_back(i);
  }
  return by_topic;
}

/// With and without the slash in front: bags have both.
std::vector<std::string> names_in_bag(const ByTopic& by_topic) {
  std::vector<std::string> names;
  for (const auto& entry : by_topic) {
    names.push_back(entry.first);
    names.push_back(entry.first.substr(1));
  }
  return names;
}

/// Writes what comes by the converters into a recording: every sample, and frames at a steady pace.
class Recorder {
 public:
  Recorder(const arm::Arm& arm, trial::CheckRecording& recording)
      : recording_(recording), assembler_(arm, params()) {
    trial::FrameAssembler::Tap tap;
    tap.body = [this](int body, double stamp_s, const Eigen::Vector3d& p,
                      const std::optional<Eigen::Quaterniond>& q) {
      recording_.bodies.at(static_cast<std::size_t>(body + 1)).push_back({stamp_s, receipt_s_, p, q});
    };
    tap.input = [this](int input, double stamp_s, double value) {
      recording_.inputs.at(static_cast<std::size_t>(input)).push_back({stamp_s, receipt_s_, value});
    };
    tap.payload = [this](double stamp_s, std::optional<double> kg) {
      if (kg) recording_.payload.push_back({stamp_s, receipt_s_, *kg});
    };
    assembler_.set_tap(std::move(tap));
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Before the messages of a record time.
  void at(const ros::Time& recorded) {
    if (recorded != std::exchange(recorded_, recorded)) keep_frames();
    receipt_s_ = recorded.toSec();
  }
  trial::FrameAssembler& assembler() { return assembler_; }
  void finish() {
    keep_frames();
    assembler_.flush();
    keep_frames();
    recording_.rejected = assembler_.rejected();
  }

 private:
  /// As for the estimates: all messages of one record time count before a frame is closed.
  static trial::FrameAssembler::Params params() {
    trial::FrameAssembler::Params params;
    params.close_when_taken = true;
    return params;
  }
  void keep_frames() {
    for (trial::Frame& frame : assembler_.take()) {
      const bool first = recording_.frames.empty();
      if (first || std::abs(frame.stamp_s() - recording_.frames.back().stamp_s()) >= kFrameIntervalS) {
        recording_.frames.push_back(std::move(frame));
      }
    }
  }

  trial::CheckRecording& recording_;
  trial::FrameAssembler assembler_;
  double receipt_s_ = 0.0;
  ros::Time recorded_;
};

/// Counts what became of a message.
void count_reading(BagReading reading, const BagMessage& message, const InputTopic& topic,
                   trial::RecordedTopic& recorded) {
  switch (reading) {
    case BagReading::kAdded:
      ++recorded.messages;
      break;
    case BagReading::kOtherDefinition:
      if (!topic.has_type(message.type)) break;
      ++recorded.unread;
      recorded.unread_md5 = message.md5;
      break;
    case BagReading::kUndecodable:
      recorded.undecodable_s.push_back(message.time.toSec());
      break;
  }
}

/// What an import says of itself.
void read_import(const rosbag::Bag& bag, trial::CheckRecording& recording) {
  rosbag::View view(bag,
                    rosbag::TopicQuery(std::vector<std::string>{kImportLayoutTopic, kImportLeftOutTopic}));
  for (const rosbag::MessageInstance& instance : view) {
    const BagMessage message = bag_message(instance);
    if (const auto layout = read_message<std_msgs::String>(message)) recording.import_layout = layout->data;
    const auto left_out = read_message<std_msgs::Float64MultiArray>(message);
    if (left_out && left_out->data.size() == 2)
      recording.left_out.emplace_back(left_out->data[0], left_out->data[1]);
  }
  recording.other_topics.erase(kImportLayoutTopic);
  recording.other_topics.erase(kImportLeftOutTopic);
}

}  // namespace

trial::CheckRecording read_recording(const std::string& path, const arm::Arm& arm,
                                     const std::function<void(std::uint64_t)>& on_total,
                                     const std::function<void(std::uint64_t)>& on_messages) {
  const std::shared_ptr<rosbag::Bag> bag = open_bag(path);
  const std::vector<InputTopic> topics = input_topics(arm);
  trial::CheckRecording recording;
  recording.name = path;
  {
    rosbag::View all(*bag);
    for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
      recording.other_topics.emplace(absolute_topic(connection->topic), connection->datatype);
    }
  }
  recording.topics = compare(topics, arm, recording.other_topics);
  recording.bodies.resize(arm.bodies.size() + 1);
  recording.inputs.resize(arm.inputs.scalars.size());
  const ByTopic by_topic = by_name(topics, recording.topics);
  if (by_topic.empty()) {
    on_total(0);
    return recording;
  }
  Recorder recorder(arm, recording);
  std::uint64_t unreported = 0;
  try {
    read_import(*bag, recording);
    rosbag::View view(*bag, rosbag::TopicQuery(names_in_bag(by_topic)));
    on_total(view.size());
    for (const rosbag::MessageInstance& instance : view) {
      const BagMessage message = bag_message(instance);
      recorder.at(message.time);
      for (const std::size_t topic : by_topic.at(absolute_topic(message.topic))) {
        count_reading(topics[topic].read(message, recorder.assembler()), message, topics[topic],
                      recording.topics[topic]);
      }
      if (++unreported == kMessagesPerProgress) on_messages(std::exchange(unreported, 0));
    }
  } catch (const ros::Exception& e) {
    throw BagError(fmt::format("{}: damaged ({})", path, e.what()));
  }
  recorder.finish();
  on_messages(unreported);
  return recording;
}

}  // namespace softarm
