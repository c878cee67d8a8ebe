// Messages whose bytes, or whose definitions, are not what a driver sends: none may read what is not there,
// or take for ever.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <softarm_estimator/PhasespaceMarkers.h>
#include <std_msgs/Float64MultiArray.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <cstring>

#include "drivers_support.h"
#include "ros/input_topic.h"
#include "ros/input_topics.h"
#include "ros/message_schema.h"

namespace softarm::drivers {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

/// Bytes one after the other, as ROS writes them.
class Bytes {
 public:
  template <class T>
  Bytes& add(const T& value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
    return *this;
  }
  Bytes& add_text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return *this;
  }
  const std::vector<std::uint8_t>& get() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// What the arm's topic of that type makes of one message.
struct Outcome {
  std::map<std::string, std::uint64_t> rejected;
  std::vector<double> stamps_s;
};
Outcome outcome_of(const arm::Arm& arm, const std::string& type, const std::string& md5,
                   const std::string& definition, const std::vector<std::uint8_t>& bytes) {
  Outcome outcome;
  trial::FrameAssembler assembler(arm);
  trial::FrameAssembler::Tap tap;
  tap.input = [&](int, double stamp_s, double) { outcome.stamps_s.push_back(stamp_s); };
  assembler.set_tap(tap);
  for (const InputTopic& topic : input_topics(arm)) {
    if (topic.type != type) continue;
    const BagReading read =
        topic.read({topic.topic, type, md5, definition, ros::Time(kStart_s), bytes}, assembler);
    EXPECT_TRUE(read != BagReading::kOtherDefinition);
  }
  outcome.rejected = assembler.rejected();
  return outcome;
}
Outcome outcome_of(const arm::Arm& arm, const std::string& type, const std::string& definition,
                   const Bytes& bytes) {
  return outcome_of(arm, type, "0123456789abcdef0123456789abcdef", definition, bytes.get());
}

const std::string kPart(80, '=');

TEST(FalseMessages, AHeaderOfOtherFieldsIsNoStamp) {
  const arm::Arm arm = arm_with(
      std::string(kFixedBase) +
      "inputs:\n  bodies: {topic: /b/<body>}\n  pressures:\n    - {name: p1, topic: /rig/state, type: "
      "my_rig_msgs/State, field: pa, stamp: header}\n");
  const std::string begin = "Header header\nfloat64 pa\n" + kPart + "\nMSG: std_msgs/Header\n";
  // A stamp without seconds; a count that is a text; no stamp: the time of receipt counts.
  const std::string parts = "\n" + kPart + "\nMSG: std_msgs/Ticks\nuint32 ticks\n";
  EXPECT_THAT(outcome_of(arm, "my_rig_msgs/State", begin + "uint32 seq\nTicks stamp" + parts,
                         Bytes().add(1u).add(2u).add(1e5))
                  .stamps_s,
              ElementsAre(kStart_s));
  EXPECT_THAT(outcome_of(arm, "my_rig_msgs/State", begin + "string seq\ntime stamp\n",
                         Bytes().add_text("one").add(5u).add(0u).add(1e5))
                  .stamps_s,
              ElementsAre(kStart_s));
  EXPECT_THAT(outcome_of(arm, "my_rig_msgs/State", begin + "uint32 seq\n", Bytes().add(1u).add(1e5)).stamps_s,
              ElementsAre(kStart_s));
  // Seconds and nanoseconds that no clock has.
  const Outcome late = outcome_of(arm, "my_rig_msgs/State", begin + "uint32 seq\ntime stamp\n",
                                  Bytes().add(1u).add(0xFFFFFFFFu).add(0xFFFFFFFFu).add(1e5));
  ASSERT_EQ(late.stamps_s.size(), 1u);
  EXPECT_GT(late.stamps_s.front(), 4e9);
}

TEST(FalseMessages, AMarkerWithANameButNoNumber) {
  const arm::Arm arm = arm_with(std::string(kFixedBase) +
                                "bodies:\n  - {name: ring_1, arclength_m: tip, labelled_markers: [{label: "
                                "led}]}\ninputs: {bodies: {topic: /m, type: phasespace_msgs/Markers}}\n");
  const std::string definition = "Marker[] markers\n" + kPart +
                                 "\nMSG: phasespace_msgs/Marker\nstring name\nfloat32 x\nfloat32 y\nfloat32 "
                                 "z\nfloat32 cond\n";
  const Bytes bytes = Bytes().add(1u).add_text("led").add(0.1f).add(0.0f).add(0.8f).add(2.0f);
  EXPECT_THAT(outcome_of(arm, "phasespace_msgs/Markers", definition, bytes).rejected, IsEmpty());
}

/// Two points, without padding: a byte, then x, y, z.
sensor_msgs::PointCloud2 packed_cloud() {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(kStart_s);
  cloud.height = 1;
  cloud.width = 2;
  cloud.point_step = 13;
  for (const std::string axis : {"x", "y", "z"}) {
    sensor_msgs::PointField field;
    field.name = axis;
    field.offset = 1 + 4 * static_cast<std::uint32_t>(cloud.fields.size());
    field.datatype = sensor_msgs::PointField::FLOAT32;
    cloud.fields.push_back(field);
  }
  Bytes bytes;
  for (int k = 0; k < 2; ++k) {
    bytes.add(std::uint8_t{0});
    for (int axis = 0; axis < 3; ++axis) bytes.add(static_cast<float>(ring_at(k, 0)[axis]));
  }
  cloud.data = bytes.get();
  return cloud;
}

TEST(FalseMessages, CloudsArePackedOrSayMoreThanTheyHold) {
  const auto rejected = [](const sensor_msgs::PointCloud2& cloud) {
    std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(cloud));
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::serialize(stream, cloud);
    return outcome_of(arm_with(std::string(kFixedBase) +
                               "inputs: {bodies: {topic: /c, type: sensor_msgs/PointCloud2}}\n"),
                      "sensor_msgs/PointCloud2", ros::message_traits::md5sum(cloud), "", bytes)
        .rejected;
  };
  EXPECT_THAT(rejected(packed_cloud()), IsEmpty());

  sensor_msgs::PointCloud2 twice = packed_cloud();  // the first of a name counts, and is not in the point
  twice.fields.insert(twice.fields.begin(), twice.fields.front());
  twice.fields.front().offset = 1u << 30;
  EXPECT_THAT(rejected(twice), ElementsAre(Pair("no_points markers", 1u)));

  sensor_msgs::PointCloud2 many = packed_cloud();  // 2^66 bytes and 4
  many.width = many.height = 1u << 31;
  many.point_step = 16;
  EXPECT_THAT(rejected(many), ElementsAre(Pair("no_points markers", 1u)));
}

/// What becomes of the bytes of one message on their way through roscpp.
template <class Message>
struct Live {
  std::vector<Message> read;
  std::map<std::string, std::uint64_t> rejected;
  int messages = 0;
  std::size_t room = 0;  // bytes that were made room for
};
template <class Message, class Array>
Live<Message> through_roscpp(std::vector<std::uint8_t> bytes, Array Message::*array) {
  ros::Time::init();  // the log asks for it
  Live<Message> outcome;
  trial::FrameAssembler assembler(arm_with(kFixedBase));
  const auto convert = [&](const Message& message, trial::Stamp, trial::FrameAssembler&) {
    outcome.read.push_back(message);
  };
  const auto reader =
      live_reader<Message>("/t", "p1", convert, assembler,
                           [&](const std_msgs::Header*, const std::string&) { ++outcome.messages; });
  ros::SubscriptionCallbackHelperT<const LiveEvent<Message>&> helper(reader);
  ros::SubscriptionCallbackHelperDeserializeParams params;
  params.buffer = bytes.data();
  params.length = static_cast<std::uint32_t>(bytes.size());
  params.connection_header = boost::make_shared<ros::M_string>();
  const auto message = boost::static_pointer_cast<CheckedMessage<Message> const>(helper.deserialize(params));
  outcome.room = (message->message.*array).capacity() * sizeof(typename Array::value_type);
  reader(LiveEvent<Message>(message, params.connection_header, ros::Time(kStart_s)));
  outcome.rejected = assembler.rejected();
  return outcome;
}

TEST(FalseMessages, OfALiveTopicMakeNoRoomForWhatDoesNotCome) {
  using Numbers = std_msgs::Float64MultiArray;
  const auto numbers = [](std::uint32_t length) {
    // No dimensions, no offset, and one number.
    return through_roscpp(Bytes().add(0u).add(0u).add(length).add(1e5).get(), &Numbers::data);
  };
  const Live<Numbers> good = numbers(1);
  ASSERT_EQ(good.read.size(), 1u);
  EXPECT_THAT(good.read.front().data, ElementsAre(1e5));
  EXPECT_THAT(good.rejected, IsEmpty());
  EXPECT_EQ(good.messages, 1);
  for (std::uint32_t length : {2u, (1u << 29) + 1, 0xFFFFFFFFu}) {  // the second one takes 8 bytes in 32 bits
    const Live<Numbers> damaged = numbers(length);
    EXPECT_TRUE(damaged.read.empty());
    EXPECT_EQ(damaged.room, 0u);
    EXPECT_THAT(damaged.rejected, ElementsAre(Pair("undecodable p1", 1u)));
    EXPECT_EQ(damaged.messages, 1);  // it came all the same
  }
  const auto transforms =
      through_roscpp(Bytes().add(10000000u).add(0u).get(), &tf2_msgs::TFMessage::transforms);
  EXPECT_TRUE(transforms.read.empty());
  EXPECT_EQ(transforms.room, 0u);
  EXPECT_THAT(transforms.rejected, ElementsAre(Pair("undecodable p1", 1u)));
}

TEST(FalseMessages, ToItsPublisherACheckedMessageIsTheMessage) {
  namespace traits = ros::message_traits;
  using Cloud = sensor_msgs::PointCloud2;
  EXPECT_STREQ(traits::md5sum<CheckedMessage<Cloud>>(), traits::md5sum<Cloud>());
  EXPECT_STREQ(traits::datatype<CheckedMessage<Cloud>>(), traits::datatype<Cloud>());
  EXPECT_TRUE(traits::hasHeader<CheckedMessage<Cloud>>());
  EXPECT_FALSE(traits::hasHeader<CheckedMessage<std_msgs::Float64MultiArray>>());
}

TEST(FalseMessages, EmptyBytesAreCounted) {
  const Outcome empty =
      outcome_of(arm_with(kFixedBase), "std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584", "", {});
  EXPECT_THAT(empty.rejected, ElementsAre(Pair("undecodable payload", 1u)));
}

TEST(FalseMessages, DefinitionsThatMultiply) {
  // Each part holds two of the next: 2^30 at the end.
  std::string doubling = "P1 a\nP1 b\n";
  for (int i = 1; i < 30; ++i) {
    const std::string next = "P" + std::to_string(i + 1);
    doubling += kPart + "\nMSG: p/P" + std::to_string(i) + "\n" + next + " a\n" + next + " b\n";
  }
  doubling += kPart + "\nMSG: p/P30\n";
  // Arrays of arrays of nothing.
  std::string nested = "E1[1000] a\n";
  for (int i = 1; i < 10; ++i) {
    nested += kPart + "\nMSG: p/E" + std::to_string(i) + "\nE" + std::to_string(i + 1) + "[1000] a\n";
  }
  nested += kPart + "\nMSG: p/E10\n";
  for (const std::string& definition : {doubling, nested}) {
    const MessageSchema schema("p/Root", definition);
    EXPECT_THROW(schema.decode(nullptr, 0), SchemaError);
    EXPECT_THROW(schema.check_lengths(nullptr, 0), SchemaError);
  }
  EXPECT_NO_THROW(MessageSchema("p/Root", "E[900] a\n" + kPart + "\nMSG: p/E\n").decode(nullptr, 0));
}

}  // namespace
}  // namespace softarm::drivers
