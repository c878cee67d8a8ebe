// An arm that a snippet of doc/drivers.md completes, and bags of messages whose packages are not here.
#pragma once

#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include <boost/make_shared.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "ros/bag_frames.h"
#include "softarm/arm/arm_file.h"

namespace softarm::drivers {

constexpr double kStart_s = 1000.0, kPeriod_s = 0.01;  ///< of the frames

/// A light arm of 0.2 m; `parts` gives base, bodies and inputs; base and bodies are added where it has none.
inline arm::Arm arm_with(const std::string& parts) {
  std::string text = R"(format: 1
name: any_driver
segments:
  - name: segment_1
    length_m: 0.2
    mass_per_length_kg_m: 0
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
payload: {default_kg: 0}
)" + parts + "\n";
  const auto has = [&](const std::string& key) {
    return ("\n" + parts).find("\n" + key + ":") != std::string::npos;
  };
  if (!has("base")) text += "base: {body: base}\n";
  if (!has("bodies")) {
    text += "bodies:\n  - {name: ring_1, arclength_m: 0.1}\n  - {name: ring_2, arclength_m: tip}\n";
  }
  return arm::parse_arm(text, "arm.yaml");
}

constexpr char kFixedBase[] = "base: {fixed: {position_m: [0, 0, 1], attitude: hanging}}\n";

/// A bag in the folder for temporary files, removed at the end.
class TestBag {
 public:
  TestBag() : path_(std::filesystem::temp_directory_path() / name()) {
    bag_.open(path_.string(), rosbag::bagmode::Write);
  }
  ~TestBag() { std::filesystem::remove(path_); }
  TestBag(const TestBag&) = delete;
  TestBag& operator=(const TestBag&) = delete;

  template <class Message>
  void write(const std::string& topic, double receipt_s, const Message& message) {
    bag_.write(topic, ros::Time(receipt_s), message);
  }
  /// The message under another name, with a definition of the same bytes. Each definition is a publisher's of
  /// its own.
  template <class Message>
  void write_as(const std::string& type, const std::string& md5, const std::string& definition,
                const std::string& topic, double receipt_s, const Message& message) {
    const ros::SerializedMessage bytes = ros::serialization::serializeMessage(message);
    topic_tools::ShapeShifter shape;
    shape.morph(md5, type, definition, "");
    // What a publisher sends begins with its length, which a ShapeShifter does not keep.
    ros::serialization::IStream stream(bytes.message_start, static_cast<std::uint32_t>(bytes.num_bytes - 4));
    shape.read(stream);
    const auto publisher = boost::make_shared<ros::M_string>(
        ros::M_string{{"type", type}, {"md5sum", md5}, {"message_definition", definition}});
    bag_.write(topic, ros::Time(receipt_s), shape, publisher);
  }
  template <class Message>
  void write_as(const std::string& type, const std::string& topic, double receipt_s, const Message& message) {
    write_as(type, ros::message_traits::md5sum<Message>(), ros::message_traits::definition<Message>(), topic,
             receipt_s, message);
  }

  struct Result {
    std::vector<trial::Frame> frames;
    std::map<std::string, std::uint64_t> rejected;
    std::vector<std::string> warnings;
    std::uint64_t time_jumps = 0;
  };
  Result read(const arm::Arm& arm) {
    bag_.close();
    BagFrames bag(path_.string(), arm);
    Result result;
    bag.read(
        {[&](const trial::Frame& frame) { result.frames.push_back(frame); }, [] {}, [](std::uint64_t) {}});
    result.rejected = bag.assembler().rejected();
    result.warnings = bag.warnings();
    result.time_jumps = bag.assembler().time_jumps();
    return result;
  }

 private:
  static std::string name() {
    static int count = 0;
    return "softarm_drivers_" + std::to_string(::getpid()) + "_" + std::to_string(count++) + ".bag";
  }
  std::filesystem::path path_;
  rosbag::Bag bag_;
};

/// The observation of a body in a frame, or null.
inline const trial::BodyObservation* observed(const trial::Frame& frame, int body) {
  for (const trial::BodyObservation& observation : frame.bodies) {
    if (observation.body == body) return &observation;
  }
  return nullptr;
}

/// Where ring k (0, 1) of a hanging arm is at instant i, m: it swings a little, so that no pose repeats.
inline Eigen::Vector3d ring_at(int k, int i) {
  return {0.02 * (k + 1) * (k + 1) + 1e-4 * i, 1e-5 * i, 1.0 - 0.0985 * (k + 1)};
}

}  // namespace softarm::drivers
