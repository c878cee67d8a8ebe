// Poses, single points and inputs as their drivers send them, faults included, from a bag.
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud.h>
#include <std_msgs/Float32MultiArray.h>
#include <tf2_msgs/TFMessage.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "arm/body_types.h"
#include "drivers_support.h"
#include "ros/body_driver.h"
#include "ros/input_topics.h"

namespace softarm::drivers {
namespace {

using ::testing::Contains;
using ::testing::Pair;
using ::testing::SizeIs;

const char* const kBodies[] = {"base", "ring_1", "ring_2"};

/// Pose of base, ring_1, ring_2 at instant i; z points down.
Eigen::Isometry3d pose_of(int body, int i) {
  const Eigen::Vector3d p = body == 0 ? Eigen::Vector3d(0, 1e-6 * i, 1.0) : ring_at(body - 1, i);
  return Eigen::Translation3d(p) * Eigen::AngleAxisd(3.1 + 0.01 * body, Eigen::Vector3d::UnitX());
}

std_msgs::Header header_at(int i, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = ros::Time(kStart_s + kPeriod_s * i);
  header.frame_id = frame;
  return header;
}

template <class Vector>
void set(Vector* to, const Eigen::Vector3d& p) {
  to->x = p.x();
  to->y = p.y();
  to->z = p.z();
}

void set(geometry_msgs::Quaternion* to, const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  to->x = q.x();
  to->y = q.y();
  to->z = q.z();
  to->w = q.w();
}

void expect_poses(const TestBag::Result& result, int frames) {
  ASSERT_THAT(result.frames, SizeIs(frames));
  for (int i = 0; i < frames; ++i) {
    const trial::Frame& frame = result.frames[static_cast<std::size_t>(i)];
    ASSERT_TRUE(frame.base_body) << i;
    EXPECT_TRUE(frame.base_body->isApprox(pose_of(0, i), 1e-9)) << i;
    for (int k = 0; k < 2; ++k) {
      const trial::BodyObservation* ring = observed(frame, k);
      if (!ring) continue;
      EXPECT_LT((ring->p_mocap - pose_of(k + 1, i).translation()).norm(), 1e-9) << i;
      ASSERT_TRUE(ring->q_mocap);
      EXPECT_LT(ring->q_mocap->angularDistance(Eigen::Quaterniond(pose_of(k + 1, i).linear())), 1e-7) << i;
    }
  }
}

TEST(DriversPoses, YUpAndFramesWithAndWithoutASlash) {
  // The driver's x, y (up), z are our x, z, -y.
  Eigen::Matrix3d driver_from_mocap;
  driver_from_mocap << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    for (int body = 0; body < 3; ++body) {
      geometry_msgs::PoseStamped message;
      message.header = header_at(i, body == 0 ? "" : body == 1 ? "/world" : i == 7 ? "lab" : "world");
      set(&message.pose.position, driver_from_mocap * pose_of(body, i).translation());
      set(&message.pose.orientation, driver_from_mocap * pose_of(body, i).linear());
      bag.write(std::string("/vrpn/") + kBodies[body] + "/pose", kStart_s + kPeriod_s * i + 0.003, message);
    }
  }
  const auto result =
      bag.read(arm_with("inputs: {bodies: {topic: /vrpn/<body>/pose, frame: world, axes: x -z y}}"));
  expect_poses(result, 10);
  EXPECT_THAT(result.rejected, Contains(Pair("other_frame ring_2", 1u)));
  EXPECT_EQ(observed(result.frames[7], 1), nullptr);
}

TEST(DriversPoses, AMirroredFrameGivesRightHandedPoses) {
  Eigen::Matrix3d mirror;
  mirror << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  TestBag bag;
  for (int i = 0; i < 5; ++i) {
    for (int body = 0; body < 3; ++body) {
      geometry_msgs::PoseStamped message;
      message.header = header_at(i, "");
      set(&message.pose.position, mirror * pose_of(body, i).translation());
      set(&message.pose.orientation, mirror * pose_of(body, i).linear() * mirror.transpose());
      bag.write(std::string("/vrpn/") + kBodies[body] + "/pose", kStart_s + kPeriod_s * i, message);
    }
  }
  expect_poses(bag.read(arm_with("inputs: {bodies: {topic: /vrpn/<body>/pose, axes: x z y}}")), 5);
}

TEST(DriversPoses, TransformsOfVicon) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    for (int body = 0; body < 3; ++body) {
      if (body == 2 && i == 4) continue;  // occluded: left out
      geometry_msgs::TransformStamped message;
      message.header = header_at(i, "/vicon/world");
      message.child_frame_id = "vicon/x";
      set(&message.transform.translation, pose_of(body, i).translation());
      set(&message.transform.rotation, pose_of(body, i).linear());
      const std::string name = kBodies[body];
      bag.write("/vicon/" + name + "/" + name, kStart_s + kPeriod_s * i, message);
    }
  }
  const auto result =
      bag.read(arm_with("inputs: {bodies: {topic: /vicon/<body>/<body>, type: "
                        "geometry_msgs/TransformStamped, frame: vicon/world}}"));
  expect_poses(result, 10);
  EXPECT_EQ(observed(result.frames[4], 1), nullptr);
  EXPECT_NE(observed(result.frames[5], 1), nullptr);
}

TEST(DriversPoses, OdometryThatComesTwicePerFrame) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    for (int twice = 0; twice < 2; ++twice) {
      for (int body = 0; body < 3; ++body) {
        nav_msgs::Odometry message;
        message.header = header_at(i, "world");
        if (twice) message.header.stamp += ros::Duration(1e-4);  // each is stamped when it is sent
        set(&message.pose.pose.position, pose_of(body, i).translation());
        set(&message.pose.pose.orientation, pose_of(body, i).linear());
        bag.write(std::string("/mocap/") + kBodies[body] + "/odom", kStart_s + kPeriod_s * i + 0.001,
                  message);
      }
    }
  }
  const auto result =
      bag.read(arm_with("inputs: {bodies: {topic: /mocap/<body>/odom, type: nav_msgs/Odometry}}"));
  expect_poses(result, 10);
  EXPECT_THAT(result.rejected, Contains(Pair("duplicate ring_2", 10u)));
}

TEST(DriversPoses, TfAmongOthersOldRecordingsToo) {
  for (const std::string type : {"tf2_msgs/TFMessage", "tf/tfMessage"}) {
    TestBag bag;
    for (int i = 0; i < 10; ++i) {
      tf2_msgs::TFMessage message;
      for (int body = 0; body < 3; ++body) {
        geometry_msgs::TransformStamped transform;
        transform.header = header_at(i, "/world");
        transform.child_frame_id = std::string(body == 1 ? "/vicon/" : "vicon/") + kBodies[body];
        set(&transform.transform.translation, pose_of(body, i).translation());
        set(&transform.transform.rotation, pose_of(body, i).linear());
        message.transforms.push_back(transform);
      }
      message.transforms.push_back(message.transforms.back());  // of another parent: not ours
      message.transforms.back().header.frame_id = "camera";
      message.transforms.push_back(message.transforms.front());
      message.transforms.back().child_frame_id = "robot";
      bag.write_as(type, "/tf", kStart_s + kPeriod_s * i, message);
    }
    const auto result = bag.read(
        arm_with("inputs: {bodies: {type: tf2_msgs/TFMessage, frame: world, child_frame: vicon/<body>}}"));
    expect_poses(result, 10);
    EXPECT_THAT(result.rejected, Contains(Pair("other_frame ring_2", 10u)));
    EXPECT_TRUE(result.warnings.empty());
  }
}

TEST(DriversPoses, PointsWithStampsOfReceiptAndLatency) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    for (int k = 0; k < 2; ++k) {
      geometry_msgs::PointStamped message;  // never stamped
      message.header.frame_id = "arm_ring_" + std::to_string(k);
      set(&message.point, 1e3 * ring_at(k, i));
      bag.write("/natnet/ring_" + std::to_string(k + 1) + "/marker0/pose",
                kStart_s + kPeriod_s * i + 2e-4 * k, message);
    }
  }
  const auto result =
      bag.read(arm_with(std::string(kFixedBase) +
                        "inputs: {bodies: {topic: /natnet/<body>/marker0/pose, unit: mm, "
                        "type: geometry_msgs/PointStamped, stamp: receipt, latency_s: 0.002}}"));
  ASSERT_THAT(result.frames, SizeIs(10));
  for (int i = 0; i < 10; ++i) {
    const trial::Frame& frame = result.frames[static_cast<std::size_t>(i)];
    const ros::Time received(kStart_s + kPeriod_s * i);
    EXPECT_EQ(frame.stamp_ns, static_cast<std::int64_t>(received.toNSec()) - 2'000'000);
    ASSERT_THAT(frame.bodies, SizeIs(2));
    EXPECT_LT((observed(frame, 1)->p_mocap - ring_at(1, i)).norm(), 1e-9);
    EXPECT_FALSE(observed(frame, 1)->q_mocap);
  }
}

TEST(DriversPoses, ABaseThatComesAnotherWay) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    geometry_msgs::PoseStamped base;
    base.header = header_at(i, "world");
    set(&base.pose.position, pose_of(0, i).translation());
    set(&base.pose.orientation, Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix());
    bag.write("/natnet/base/pose", kStart_s + kPeriod_s * i, base);
    sensor_msgs::PointCloud cloud;
    cloud.header = header_at(i, "world");
    for (int k = 1; k >= 0; --k) {
      cloud.points.emplace_back();
      set(&cloud.points.back(), ring_at(k, i));
    }
    bag.write("/natnet/pointcloud", kStart_s + kPeriod_s * i + 0.001, cloud);
  }
  const auto result =
      bag.read(arm_with("inputs: {base: {topic: /natnet/<body>/pose}, bodies: {topic: /natnet/pointcloud, "
                        "type: sensor_msgs/PointCloud}}"));
  ASSERT_THAT(result.frames, SizeIs(20));
  for (std::size_t i = 3; i < 20; ++i) {
    EXPECT_TRUE(result.frames[i].base_body);
    ASSERT_THAT(result.frames[i].bodies, SizeIs(2)) << i;
    EXPECT_LT((observed(result.frames[i], 0)->p_mocap - ring_at(0, static_cast<int>(i))).norm(), 1e-6);
  }
}

/// Frames of a base that is fixed and two points, to carry inputs.
void write_points(TestBag* bag, int i) {
  for (int k = 0; k < 2; ++k) {
    geometry_msgs::PointStamped message;
    message.header = header_at(i, "");
    set(&message.point, ring_at(k, i));
    bag->write("/p/ring_" + std::to_string(k + 1), kStart_s + kPeriod_s * i, message);
  }
}

const std::string kInputsOnPoints =
    std::string(kFixedBase) + "inputs:\n  bodies: {topic: /p/<body>, type: geometry_msgs/PointStamped}\n";

constexpr char kStateDefinition[] = R"(# A rig's own message.
string name
Channel[] channels
bool[2] open
================================================================================
MSG: my_rig_msgs/Channel
uint8 id
float32 pressure
)";

struct State {
  std::vector<float> bar;
};

}  // namespace
}  // namespace softarm::drivers

namespace ros::serialization {
template <>
struct Serializer<softarm::drivers::State> {
  template <class Stream>
  static void write(Stream& stream, const softarm::drivers::State& m) {
    stream.next(std::string("rig"));
    stream.next(static_cast<std::uint32_t>(m.bar.size()));
    for (const float value : m.bar) {
      stream.next(std::uint8_t{1});
      stream.next(value);
    }
    stream.next(std::uint8_t{1});
    stream.next(std::uint8_t{0});
  }
  static std::uint32_t serializedLength(const softarm::drivers::State& m) {
    return 7 + 4 + 5 * static_cast<std::uint32_t>(m.bar.size()) + 2;
  }
};
}  // namespace ros::serialization

namespace softarm::drivers {
namespace {

TEST(DriversInputs, FieldsOfOwnMessagesUnitsAndStamps) {
  const arm::Arm arm = arm_with(kInputsOnPoints + R"(  pressures:
    - {name: p1, topic: /rig/state, type: my_rig_msgs/State, field: "channels[1].pressure", unit: bar}
    - {name: p2, topic: /valves, type: std_msgs/Float32MultiArray, element: 1, unit: kPa, reference: gauge}
    - {name: p3, topic: /sensor, stamp: receipt}
    - {name: p4, topic: /sensor4}
    - {name: core, topic: /rig/state, type: my_rig_msgs/State, field: "channels[0].pressure", unit: bar, vacuum: true}
  tensions:
    - {name: t1, topic: /joint_states, type: sensor_msgs/JointState, field: "effort[1]", zero: 2}
  ambient_pressure_pa: 100000
)");
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    const double receipt_s = kStart_s + kPeriod_s * i - 0.005;
    bag.write_as("my_rig_msgs/State", "0123456789abcdef0123456789abcdef", kStateDefinition, "/rig/state",
                 receipt_s, State{i < 8 ? std::vector<float>{0.25f, 1.5f} : std::vector<float>{0.25f}});
    std_msgs::Float32MultiArray valves;
    valves.data = {99.0f, 40.0f};
    bag.write("/valves", receipt_s, valves);
    sensor_msgs::FluidPressure sensor;
    sensor.header.stamp = ros::Time(1.0);  // a clock that is worthless
    sensor.fluid_pressure = 130000;
    bag.write("/sensor", receipt_s, sensor);
    bag.write("/sensor4", receipt_s, sensor);
    sensor_msgs::JointState joints;
    joints.header.stamp = ros::Time(receipt_s);
    joints.effort = {1, 7};
    bag.write("/joint_states", receipt_s, joints);
    write_points(&bag, i);
  }
  const auto result = bag.read(arm);
  ASSERT_THAT(result.frames, SizeIs(10));
  const arm::InputValues& values = result.frames[5].inputs;
  ASSERT_THAT(values, SizeIs(6));
  EXPECT_NEAR(values[0].value(), 50000.0, 1e-6);
  EXPECT_NEAR(values[1].value(), 40000.0, 1e-6);
  EXPECT_NEAR(values[2].value(), 30000.0, 1e-6);
  EXPECT_FALSE(values[3]);  // its own stamps say that it is 999 s old
  EXPECT_NEAR(values[4].value(), 75000.0, 1e-6);
  EXPECT_NEAR(values[5].value(), 5.0, 1e-9);
  EXPECT_THAT(result.rejected, Contains(Pair("input_nan p1", 2u)));
}

TEST(DriversInputs, BytesThatDoNotFitTheDefinitionAreCounted) {
  const arm::Arm arm =
      arm_with(kInputsOnPoints +
               "  pressures:\n    - {name: p1, topic: /rig/state, type: my_rig_msgs/State, field: name}\n");
  TestBag bag;
  for (int i = 0; i < 3; ++i) {
    write_points(&bag, i);
    const std::string definition = i == 0   ? "uint32 a\n"  // too short
                                   : i == 1 ? std::string(kStateDefinition) + "float64 more\n"
                                            : "Unknown a\n";
    bag.write_as("my_rig_msgs/State", "0123456789abcdef0123456789abcde" + std::to_string(i), definition,
                 "/rig/state", kStart_s + kPeriod_s * i, State{{1.0f}});
  }
  const auto result = bag.read(arm);
  EXPECT_THAT(result.rejected, Contains(Pair("undecodable p1", 3u)));
  // The definitions may be what is wrong: the rest is read.
  EXPECT_THAT(result.warnings, ::testing::ElementsAre(::testing::HasSubstr(
                                   "3 of 3 messages of topic /rig/state (p1) cannot be read")));
  EXPECT_THAT(result.frames, SizeIs(3));
}

TEST(DriversDoc, EverySnippetLoads) {
  std::ifstream file(SOFTARM_SOURCE_DIR "/doc/drivers.md");
  std::string line, snippet, name;
  int snippets = 0;
  std::set<std::string> types;
  for (bool inside = false; std::getline(file, line);) {
    if (line.rfind("```yaml", 0) == 0) {
      inside = true;
      name = line.substr(7);
      snippet.clear();
    } else if (inside && line == "```") {
      inside = false;
      ++snippets;
      try {
        const arm::Arm arm = arm_with(snippet);
        EXPECT_FALSE(input_topics(arm).empty());
        types.insert(arm.inputs.bodies.type);
      } catch (const std::exception& e) {
        ADD_FAILURE() << "doc/drivers.md, snippet" << name << ": " << e.what();
      }
    } else if (inside) {
      snippet += line + "\n";
    }
  }
  EXPECT_GE(snippets, 10);
  EXPECT_GE(types.size(), 9u);  // a snippet for each kind of driver
}

/// The third cells of the table of drivers, and the rows that they stand in.
std::map<std::string, std::string> types_of_page() {
  std::ifstream file(SOFTARM_SOURCE_DIR "/doc/drivers.md");
  std::map<std::string, std::string> types;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| driver | publishes | `inputs.bodies.type` |", 0) == 0) inside = true;
    if (line.empty()) inside = false;
    if (!inside || line.find("| driver |") == 0) continue;
    std::istringstream row(line);
    std::string cell;
    for (int column = 0; column <= 3; ++column) std::getline(row, cell, '|');
    for (std::size_t from = cell.find('`'); from != std::string::npos;) {
      const std::size_t to = cell.find('`', from + 1);
      types[cell.substr(from + 1, to - from - 1)] += line + "\n";
      from = cell.find('`', to + 1);
    }
  }
  return types;
}

TEST(DriversDoc, TheTableOfThePageIsTheTableOfTheDrivers) {
  auto page = types_of_page();
  for (const arm::yaml::BodyType& row : arm::yaml::body_types()) {
    EXPECT_EQ(page.count(row.type), 1u) << row.type << " has no row in doc/drivers.md";
    if (row.unit == "mm") {
      EXPECT_NE(page[row.type].find("millimetres"), std::string::npos) << row.type;
    }
    page.erase(row.type);
  }
  for (const auto& left : page) ADD_FAILURE() << "doc/drivers.md: no driver has the type " << left.first;
}

TEST(DriversTable, EveryRowHasAConverterAndEveryConverterARow) {
  std::set<std::string> rows, defined;
#define SOFTARM_NAME(name, type, message, unit, server_time) rows.insert(#name);
  SOFTARM_BODY_TYPES(SOFTARM_NAME)
#undef SOFTARM_NAME
  const std::regex definition(R"(BodyDriver driver_(\w+)\(\) \{)");
  for (const auto& file : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/src/ros")) {
    std::ifstream in(file.path());
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    for (std::sregex_iterator found(text.begin(), text.end(), definition), end; found != end; ++found)
      defined.insert((*found)[1]);
  }
  EXPECT_EQ(rows, defined) << "rows of arm/body_types.h, and driver_...() of src/ros";
  EXPECT_EQ(body_drivers().size(), arm::yaml::body_types().size());
}

TEST(DriversTable, AConverterMakesTopicsOfItsRowsTypeAndKind) {
  const Bodies bodies{{"ring_1", 0}, {"ring_2", 1}};
  const arm::Arm arm = arm_with("");
  for (const arm::yaml::BodyType& row : arm::yaml::body_types()) {
    using Kind = arm::yaml::BodyMessage;
    const bool one_per_body = row.message == Kind::kPose || row.message == Kind::kPoint;
    arm::BodySource source = arm.inputs.bodies;
    source.type = row.type;
    source.topic = one_per_body ? "/mocap/<body>" : "/mocap";
    source.child_frame = "<body>";
    source.labelled = row.message == Kind::kMarkers;
    const std::vector<InputTopic> topics = body_drivers().at(row.type).topics(arm, source, bodies);
    ASSERT_EQ(topics.size(), one_per_body ? 2u : 1u) << row.type;
    EXPECT_EQ(topics[0].type, row.type);
    EXPECT_EQ(topics[0].feeds, one_per_body ? "ring_1" : "ring_1, ring_2") << row.type;
  }
}

}  // namespace
}  // namespace softarm::drivers
