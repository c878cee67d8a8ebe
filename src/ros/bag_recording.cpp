#include "bag_recording.h"

#include <fmt/format.h>
#include <rosbag/exceptions.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

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
      const auto& also = topic.other_types;
      const bool same = std::find(also.begin(), also.end(), found->second) != also.end();
      r.found_type = same ? topic.type : found->second;
      others.erase(found->first);
    }
    recorded.push_back(r);
  }
  return recorded;
}

}  // namespace

trial::CheckRecording read_recording(const std::string& path, const arm::Arm& arm,
                                     const std::function<void(std::uint64_t)>& on_total,
                                     const std::function<void(std::uint64_t)>& on_messages) {
  const std::vector<InputTopic> topics = input_topics(arm);
  const std::shared_ptr<rosbag::Bag> bag = open_bag(path);
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

  std::vector<std::string> names;
  // Two sources may share a topic: base and rings on /tf, under frames of their own.
  std::map<std::string, std::vector<std::size_t>> by_topic;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (recording.topics[i].found_type != topics[i].type) continue;
    const std::string name = absolute_topic(topics[i].topic);
    by_topic[name].push_back(i);
    names.push_back(name);
    names.push_back(name.substr(1));
  }
  if (names.empty()) {
    on_total(0);
    return recording;
  }

  double receipt_s = 0.0;
  // As for the estimates: all messages of one record time count before a frame is closed.
  trial::FrameAssembler::Params params;
  params.close_when_taken = true;
  trial::FrameAssembler assembler(arm, params);
  trial::FrameAssembler::Tap tap;
  tap.body = [&](int body, double stamp_s, const Eigen::Vector3d& p,
                 const std::optional<Eigen::Quaterniond>& q) {
    recording.bodies.at(static_cast<std::size_t>(body + 1)).push_back({stamp_s, receipt_s, p, q});
  };
  tap.input = [&](int input, double stamp_s, double value) {
    recording.inputs.at(static_cast<std::size_t>(input)).push_back({stamp_s, receipt_s, value});
  };
  tap.payload = [&](double stamp_s, std::optional<double> kg) {
    if (kg) recording.payload.push_back({stamp_s, receipt_s, *kg});
  };
  assembler.set_tap(std::move(tap));
  const auto keep_frames = [&] {
    for (trial::Frame& frame : assembler.take()) {
      const bool first = recording.frames.empty();
      if (first || std::abs(frame.stamp_s - recording.frames.back().stamp_s) >= kFrameIntervalS) {
        recording.frames.push_back(std::move(frame));
      }
    }
  };
  std::uint64_t unreported = 0;
  ros::Time recorded;
  try {
    rosbag::View view(*bag, rosbag::TopicQuery(names));
    on_total(view.size());
    for (const rosbag::MessageInstance& message : view) {
      if (message.getTime() != std::exchange(recorded, message.getTime())) keep_frames();
      receipt_s = message.getTime().toSec();
      for (const std::size_t topic : by_topic.at(absolute_topic(message.getTopic()))) {
        if (topics[topic].read(message, assembler)) ++recording.topics[topic].messages;
      }
      if (++unreported == kMessagesPerProgress) on_messages(std::exchange(unreported, 0));
    }
  } catch (const ros::Exception& e) {
    throw BagError(fmt::format("{}: damaged ({}); rosbag check says more", path, e.what()));
  }
  keep_frames();
  assembler.flush();
  keep_frames();
  on_messages(unreported);
  recording.rejected = assembler.rejected();
  return recording;
}

}  // namespace softarm
