// The frames of a recorded trial.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "input_topic.h"
#include "open_bag.h"
#include "softarm/arm/arm.h"
#include "trial/frame_assembler.h"

namespace softarm {

/// Reads a bag's messages in the order in which they were recorded through the conversions and the assembler
/// of the live node, so that the frames are those that the node would see.
class BagFrames {
 public:
  /// Opens the bag and compares its topics with those of the arm.
  /// @param use_payload false: the bag's payload topic is not read
  /// @throws BagError if it is no complete bag, or if the base or every measured body is not in it or cannot
  /// be read
  /// @throws std::invalid_argument where the arm names a type that no adapter reads
  BagFrames(const std::string& path, const arm::Arm& arm, bool use_payload = true);

  /// Topics of the arm that the bag does not have, or has with another type or by another definition of it;
  /// once it is read also those of which messages cannot be read. One line each: the estimates lack them.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Messages that will be read.
  std::uint64_t messages() const { return messages_; }

  struct Callbacks {
    std::function<void(const trial::Frame&)> on_frame;
    std::function<void()> on_time_jump;              ///< before the first frame after it
    std::function<void(std::uint64_t)> on_messages;  ///< messages read since the last call
  };
  /// Reads the bag once, from its start to its end. All messages of one record time count before a frame is
  /// closed: which of them a recorder wrote first is chance. Messages that cannot be read are left out, and
  /// said in warnings().
  /// @throws BagError where the bag itself is damaged, or every message of a topic whose type is known here
  void read(const Callbacks& callbacks);

  const trial::FrameAssembler& assembler() const { return assembler_; }
  /// Samples of inputs from after the last frame, once the bag is read.
  std::vector<trial::InputSample> take_samples() { return assembler_.take_samples(); }

 private:
  void open();
  void compare(const arm::Arm& arm);
  void deliver(const Callbacks& callbacks);

  std::string path_;
  std::shared_ptr<rosbag::Bag> bag_;  // opened and destroyed by one thread at a time
  trial::FrameAssembler assembler_;
  std::vector<InputTopic> topics_;                     // those that the bag has, in the arm's order
  std::map<std::string, std::string> in_bag_;          // topic to type
  std::map<std::string, std::set<std::string>> md5s_;  // of the definitions of a topic
  std::vector<std::string> names_;                     // of topics_, as the bag may write them
  std::vector<std::string> warnings_;
  std::uint64_t messages_ = 0;
};

}  // namespace softarm
