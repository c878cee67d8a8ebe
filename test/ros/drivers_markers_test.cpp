// Lists of markers and clouds as their drivers send them, faults included, from a bag.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <softarm_estimator/MocapMarkerList.h>
#include <softarm_estimator/PhasespaceMarkers.h>
#include <softarm_estimator/ViconMarkers.h>
#include <visualization_msgs/Marker.h>

#include <limits>

#include "drivers_support.h"

namespace softarm::drivers {
namespace {

using ::testing::Contains;
using ::testing::Pair;
using ::testing::SizeIs;

constexpr double kDelay_s = 0.004;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void expect_near(const Eigen::Vector3d& p, const Eigen::Vector3d& expected, double tolerance = 1e-9) {
  EXPECT_LT((p - expected).norm(), tolerance) << p.transpose() << " against " << expected.transpose();
}

geometry_msgs::Point point_of(const Eigen::Vector3d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

TEST(DriversMirrors, HaveTheMd5SumsOfTheOriginals) {
  EXPECT_STREQ(ros::message_traits::md5sum<softarm_estimator::ViconMarkers>(),
               "579f0637989aa8139ce6bf98cf7aabda");
  EXPECT_STREQ(ros::message_traits::md5sum<softarm_estimator::MocapMarkerList>(),
               "a2118b2995486d302a0c33e52d38f452");
}

softarm_estimator::ViconMarker vicon(const std::string& name, const Eigen::Vector3d& p_m,
                                     bool occluded = false) {
  softarm_estimator::ViconMarker marker;
  marker.marker_name = name;
  marker.subject_name = name.empty() ? "" : "arm";
  marker.translation = point_of(1e3 * p_m);
  marker.occluded = occluded;
  return marker;
}

softarm_estimator::ViconMarkers vicon_frame(int i) {
  softarm_estimator::ViconMarkers message;
  message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);  // no frame_id
  message.markers = {vicon("", {0.3, 0.3, 0.3}), vicon("ring_2", ring_at(1, i)),
                     vicon("a", ring_at(0, i) + Eigen::Vector3d(0, 0.02, 0)),
                     vicon("b", ring_at(0, i) - Eigen::Vector3d(0, 0.02, 0))};
  return message;
}

const std::string kViconArm = std::string(kFixedBase) + R"(bodies:
  - {name: ring_1, arclength_m: 0.1, labelled_markers: [{label: "arm:a"}, {label: "arm/b"}]}
  - {name: ring_2, arclength_m: tip}
inputs: {bodies: {topic: /vicon/markers, type: vicon_bridge/Markers}}
)";

TEST(DriversVicon, MillimetresLabelsAndOcclusion) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    auto message = vicon_frame(i);
    if (i == 5) message.markers[1].occluded = true;  // its position stays filled
    if (i == 6) message.markers.pop_back();          // half of ring_1 is gone
    if (i == 7) message.markers[2] = message.markers[3];
    bag.write_as("vicon_bridge/Markers", "/vicon/markers", kStart_s + kPeriod_s * i + kDelay_s, message);
    if (i == 8) bag.write_as("vicon_bridge/Markers", "/vicon/markers", kStart_s + 0.086, message);  // twice
  }
  const auto result = bag.read(arm_with(kViconArm));
  ASSERT_THAT(result.frames, SizeIs(20));
  for (int i = 0; i < 20; ++i) {
    const trial::Frame& frame = result.frames[static_cast<std::size_t>(i)];
    EXPECT_NEAR(frame.stamp_s(), kStart_s + kPeriod_s * i, 1e-6);
    EXPECT_EQ(observed(frame, 0) != nullptr, i != 6 && i != 7) << i;
    EXPECT_EQ(observed(frame, 1) != nullptr, i != 5) << i;
    if (observed(frame, 0)) {
      expect_near(observed(frame, 0)->p_mocap, ring_at(0, i));
      EXPECT_FALSE(observed(frame, 0)->q_mocap);
    }
    if (observed(frame, 1)) expect_near(observed(frame, 1)->p_mocap, ring_at(1, i));
  }
  EXPECT_THAT(result.rejected, Contains(Pair("occluded ring_2", 1u)));
  EXPECT_THAT(result.rejected, Contains(Pair("not_reported ring_1", 2u)));
  EXPECT_THAT(result.rejected, Contains(Pair("duplicate ring_2", 1u)));
  EXPECT_TRUE(result.warnings.empty());
}

TEST(DriversVicon, AMessageWithADamagedStampIsDropped) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    auto message = vicon_frame(i);
    if (i == 5) message.header.stamp += ros::Duration(1e6);
    if (i == 9) message.header.stamp -= ros::Duration(500.0);
    bag.write_as("vicon_bridge/Markers", "/vicon/markers", kStart_s + kPeriod_s * i, message);
  }
  const auto result = bag.read(arm_with(kViconArm));
  EXPECT_THAT(result.frames, SizeIs(18));
  EXPECT_EQ(result.time_jumps, 0u);
  for (const std::string ring : {"ring_1", "ring_2"}) {
    EXPECT_THAT(result.rejected, Contains(Pair("time_gap " + ring, 1u)));
    EXPECT_THAT(result.rejected, Contains(Pair("time_jump " + ring, 1u)));
  }
}

TEST(DriversVicon, ALabelThatTwoMarkersHaveIsRefused) {
  TestBag bag;
  for (int i = 0; i < 5; ++i) {
    auto message = vicon_frame(i);
    message.markers.push_back(vicon("ring_2", {1, 1, 1}));
    message.markers.back().subject_name = "hand";
    bag.write_as("vicon_bridge/Markers", "/vicon/markers", kStart_s + kPeriod_s * i, message);
  }
  const auto result = bag.read(arm_with(kViconArm));
  EXPECT_THAT(result.rejected, Contains(Pair("ambiguous_label ring_2", 5u)));
  for (const trial::Frame& frame : result.frames) EXPECT_EQ(observed(frame, 1), nullptr);
}

/// The version of vicon_bridge that has a quality, written by hand: no class of it is here.
struct Quality {
  softarm_estimator::ViconMarkers message;
};

}  // namespace
}  // namespace softarm::drivers

namespace ros::serialization {
template <>
struct Serializer<softarm::drivers::Quality> {
  template <class Stream, class T>
  static void allInOne(Stream& stream, T m) {
    stream.next(m.message.header);
    stream.next(m.message.frame_number);
    stream.next(static_cast<std::uint32_t>(m.message.markers.size()));
    for (const auto& marker : m.message.markers) {
      stream.next(marker);
      stream.next(0.5);
    }
  }
  template <class Stream>
  static void write(Stream& stream, const softarm::drivers::Quality& m) {
    allInOne<Stream, const softarm::drivers::Quality&>(stream, m);
  }
  static std::uint32_t serializedLength(const softarm::drivers::Quality& m) {
    LStream stream;
    allInOne<LStream, const softarm::drivers::Quality&>(stream, m);
    return stream.getLength();
  }
};
}  // namespace ros::serialization

namespace softarm::drivers {
namespace {

std::string with_field_after(std::string definition, const std::string& line, const std::string& field) {
  const std::size_t at = definition.find(line + "\n");
  EXPECT_NE(at, std::string::npos);
  return definition.insert(at + line.size() + 1, field + "\n");
}

TEST(DriversVicon, AVersionWithMoreFieldsIsRead) {
  const std::string definition = with_field_after(
      ros::message_traits::definition<softarm_estimator::ViconMarkers>(), "bool occluded", "float64 quality");
  TestBag bag;
  for (int i = 0; i < 5; ++i) {
    bag.write_as("vicon_bridge/Markers", "0123456789abcdef0123456789abcdef", definition, "/vicon/markers",
                 kStart_s + kPeriod_s * i, Quality{vicon_frame(i)});
  }
  const auto result = bag.read(arm_with(kViconArm));
  ASSERT_THAT(result.frames, SizeIs(5));
  expect_near(observed(result.frames[4], 1)->p_mocap, ring_at(1, 4));
}

TEST(DriversVicon, WithoutADefinitionTheMirrorServesAndAnUnknownOneIsCounted) {
  const std::string md5 = ros::message_traits::md5sum<softarm_estimator::ViconMarkers>();
  TestBag bag;
  for (int i = 0; i < 5; ++i) {
    bag.write_as("vicon_bridge/Markers", md5, "", "/vicon/markers", kStart_s + kPeriod_s * i, vicon_frame(i));
  }
  EXPECT_THAT(bag.read(arm_with(kViconArm)).frames, SizeIs(5));

  TestBag unknown;
  unknown.write_as("vicon_bridge/Markers", "0123456789abcdef0123456789abcdef", "", "/vicon/markers", kStart_s,
                   vicon_frame(0));
  EXPECT_THAT(unknown.read(arm_with(kViconArm)).rejected, Contains(Pair("undecodable ring_1, ring_2", 1u)));
}

TEST(DriversVicon, MarkersWithPlacesTellAPose) {
  const std::vector<Eigen::Vector3d> places{{0.05, 0, 0}, {-0.05, 0, 0}, {0, 0.04, 0}, {0, 0, 0.03}};
  std::string arm = "base:\n  body: mount\n  labelled_markers:\n";
  for (int k = 0; k < 4; ++k) {
    arm += "    - {label: m" + std::to_string(k) + ", position_m: [" + std::to_string(places[k].x()) + ", " +
           std::to_string(places[k].y()) + ", " + std::to_string(places[k].z()) + "]}\n";
  }
  arm += "inputs: {bodies: {topic: /vicon/markers, type: vicon_bridge/Markers}}\n";
  TestBag bag;
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 8; ++i) {
    Eigen::Isometry3d pose = Eigen::Translation3d(0.1, 1e-4 * i, 1.0) *
                             Eigen::AngleAxisd(3.0 + 1e-3 * i, Eigen::Vector3d(1, 2, 3).normalized());
    poses.push_back(pose);
    softarm_estimator::ViconMarkers message;
    message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);
    for (int k = 0; k < 4; ++k) message.markers.push_back(vicon("m" + std::to_string(k), pose * places[k]));
    if (i == 2) message.markers[1].occluded = true;                                // three do
    if (i == 3) message.markers[0].occluded = message.markers[1].occluded = true;  // two do not
    if (i == 4) std::swap(message.markers[0].translation, message.markers[2].translation);
    message.markers.push_back(vicon("ring_1", ring_at(0, i)));
    message.markers.push_back(vicon("ring_2", ring_at(1, i)));
    bag.write_as("vicon_bridge/Markers", "/vicon/markers", kStart_s + kPeriod_s * i, message);
  }
  const auto result = bag.read(arm_with(arm));
  ASSERT_THAT(result.frames, SizeIs(8));
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_EQ(result.frames[i].base_body.has_value(), i != 3 && i != 4) << i;
    if (result.frames[i].base_body) {
      EXPECT_TRUE(result.frames[i].base_body->isApprox(poses[i], 1e-9)) << i;
    }
  }
  EXPECT_THAT(result.rejected, Contains(Pair("occluded mount", 1u)));
  EXPECT_THAT(result.rejected, Contains(Pair("markers_misfit mount", 1u)));
}

TEST(DriversQualisys, NotTrackedNanAndOtherFrames) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    softarm_estimator::MocapMarkerList message;
    message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);
    message.header.frame_id = i == 9 ? "lab" : "/mocap";
    for (int k = 0; k < 2; ++k) {
      softarm_estimator::MocapMarker marker;
      marker.id = "ring_" + std::to_string(k + 1);
      marker.labeled = marker.tracked = true;
      marker.position = point_of(ring_at(k, i));
      message.markers.push_back(marker);
    }
    if (i == 3) {
      message.markers[0].tracked = false;
      message.markers[0].position = point_of({kNan, kNan, kNan});
    }
    if (i == 4) message.markers[1].position.x = kNan;
    if (i == 5) message.markers[1].position = point_of({0, 0, 0});
    bag.write_as("mocap_base/MarkerList", "/qualisys/markers", kStart_s + kPeriod_s * i + kDelay_s, message);
  }
  const auto result = bag.read(
      arm_with(std::string(kFixedBase) +
               "inputs: {bodies: {topic: /qualisys/markers, type: mocap_base/MarkerList, frame: mocap}}\n"));
  ASSERT_THAT(result.frames, SizeIs(9));
  EXPECT_EQ(observed(result.frames[3], 0), nullptr);
  EXPECT_EQ(observed(result.frames[4], 1), nullptr);
  EXPECT_EQ(observed(result.frames[5], 1), nullptr);
  expect_near(observed(result.frames[8], 1)->p_mocap, ring_at(1, 8));
  EXPECT_THAT(result.rejected, Contains(Pair("not_tracked ring_1", 1u)));
  EXPECT_THAT(result.rejected, Contains(Pair("nan ring_2", 1u)));
  EXPECT_THAT(result.rejected, Contains(Pair("all_zero ring_2", 1u)));
  EXPECT_THAT(result.rejected, Contains(Pair("other_frame markers", 1u)));
}

const std::string kPhasespaceBodies = std::string(kFixedBase) + R"(bodies:
  - {name: ring_1, arclength_m: 0.1, labelled_markers: [{label: "7"}]}
  - {name: ring_2, arclength_m: tip, labelled_markers: [{label: tip_led}]}
)";

TEST(DriversPhasespace, WithoutAHeaderReceiptCountsAndConditionDecides) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) {
    softarm_estimator::PhasespaceMarkers message;
    for (int k = 0; k < 2; ++k) {
      softarm_estimator::PhasespaceMarker marker;
      marker.id = static_cast<std::uint32_t>(7 + k);
      marker.name = k == 0 ? "" : "tip_led";
      marker.position = point_of(ring_at(k, i));
      marker.condition = i == 4 && k == 1 ? -1.0f : i == 5 && k == 1 ? 0.0f : 3.0f;
      message.markers.push_back(marker);
    }
    bag.write_as("phasespace_msgs/Markers", "/phasespace/markers", kStart_s + kPeriod_s * i, message);
  }
  const auto result = bag.read(arm_with(
      kPhasespaceBodies + "inputs: {bodies: {topic: /phasespace/markers, type: phasespace_msgs/Markers}}\n"));
  ASSERT_THAT(result.frames, SizeIs(10));
  EXPECT_NEAR(result.frames[3].stamp_s(), kStart_s + 0.03, 1e-6);
  expect_near(observed(result.frames[3], 1)->p_mocap, ring_at(1, 3));
  EXPECT_THAT(result.rejected, Contains(Pair("bad_condition ring_2", 2u)));
}

/// What phasespace_bringup sends: no named class, positions in a row, the server's time, y and z exchanged.
struct Led {
  std::uint32_t id, flags;
  std::uint64_t time_us;
  float x, y, z, cond;
};
struct Leds {
  std_msgs::Header header;
  std::vector<Led> markers;
};

constexpr char kLedsDefinition[] = R"(Header header
Marker[] markers
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: phasespace_msgs/Marker
uint32 FLAG=5  # a constant
uint32 id
uint32 flags
uint64 time
float32 x
float32 y
float32 z
float32 cond
)";

}  // namespace
}  // namespace softarm::drivers

namespace ros::serialization {
template <>
struct Serializer<softarm::drivers::Leds> {
  template <class Stream>
  static void write(Stream& stream, const softarm::drivers::Leds& m) {
    stream.next(m.header);
    stream.next(static_cast<std::uint32_t>(m.markers.size()));
    for (const auto& led : m.markers) {
      stream.next(led.id);
      stream.next(led.flags);
      stream.next(led.time_us);
      for (const float value : {led.x, led.y, led.z, led.cond}) stream.next(value);
    }
  }
  static std::uint32_t serializedLength(const softarm::drivers::Leds& m) {
    return serializationLength(m.header) + 4 + static_cast<std::uint32_t>(m.markers.size()) * 32;
  }
};
}  // namespace ros::serialization

namespace softarm::drivers {
namespace {

const std::string kLedsArm = std::string(kFixedBase) + R"(bodies:
  - {name: ring_1, arclength_m: 0.1, labelled_markers: [{label: m7}]}
  - {name: ring_2, arclength_m: tip, labelled_markers: [{label: "8"}]}
inputs: {bodies: {topic: /phasespace/markers, type: phasespace_msgs/Markers, axes: x z y, stamp: server}}
)";

Leds leds_at(int i) {
  Leds message;  // a header that is never stamped
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3f p = ring_at(k, i).cast<float>();
    message.markers.push_back({static_cast<std::uint32_t>(7 + k), 0,
                               5000000u + 10000u * static_cast<std::uint64_t>(i), p.x(), p.z(), p.y(), 2.0f});
  }
  return message;
}

void write_leds(TestBag& bag, int i, const Leds& message) {
  bag.write_as("phasespace_msgs/Markers", "0123456789abcdef0123456789abcdef", kLedsDefinition,
               "/phasespace/markers", kStart_s + kPeriod_s * i + kDelay_s * (i % 2), message);
}

TEST(DriversPhasespace, AMessageWithoutMarkersHasNoTimeOfTheServers) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) write_leds(bag, i, i == 4 || i == 5 ? Leds() : leds_at(i));
  const auto result = bag.read(arm_with(kLedsArm));
  EXPECT_EQ(result.time_jumps, 0u);
  EXPECT_THAT(result.frames, SizeIs(8));
  EXPECT_THAT(result.rejected, Contains(Pair("no_points markers", 2u)));
}

TEST(DriversPhasespace, MirroredAxesAndTheServersTime) {
  TestBag bag;
  for (int i = 0; i < 10; ++i) write_leds(bag, i, leds_at(i));
  const auto result = bag.read(arm_with(kLedsArm));
  ASSERT_THAT(result.frames, SizeIs(10));
  for (int i = 0; i < 10; ++i) {
    const trial::Frame& frame = result.frames[static_cast<std::size_t>(i)];
    EXPECT_NEAR(frame.stamp_s(), 5.0 + 0.01 * i, 1e-9);
    expect_near(observed(frame, 1)->p_mocap, ring_at(1, i), 1e-6);
  }
}

/// Rings in changing order with a ghost.
std::vector<Eigen::Vector3d> shuffled(int i) {
  std::vector<Eigen::Vector3d> points{ring_at(0, i), ring_at(1, i), {0.4, 0.3 + 1e-4 * i, 0.2}};
  std::rotate(points.begin(), points.begin() + i % 3, points.end());
  return points;
}

void expect_rings(const TestBag::Result& result, int frames) {
  ASSERT_THAT(result.frames, SizeIs(frames));
  int found = 0;
  for (int i = 0; i < frames; ++i) {
    for (int k = 0; k < 2; ++k) {
      const trial::BodyObservation* ring = observed(result.frames[static_cast<std::size_t>(i)], k);
      if (!ring) continue;
      ++found;
      expect_near(ring->p_mocap, ring_at(k, i), 1e-6);
    }
  }
  EXPECT_GE(found, 2 * frames - 4);
  EXPECT_GE(result.rejected.at("ghost markers"), static_cast<std::uint64_t>(frames - 2));
}

/// The points of instant i, which are stamped `late_s` later.
sensor_msgs::PointCloud cloud_at(int i, double late_s) {
  sensor_msgs::PointCloud message;
  message.header.stamp = ros::Time(kStart_s + kPeriod_s * i + late_s);
  for (const Eigen::Vector3d& p : shuffled(i)) {
    geometry_msgs::Point32 point;
    point.x = static_cast<float>(p.x());
    point.y = static_cast<float>(p.y());
    point.z = static_cast<float>(p.z());
    message.points.push_back(point);
  }
  return message;
}

TEST(DriversCloud, PointsOfPointCloudAreAssociated) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    sensor_msgs::PointCloud message = cloud_at(i, 0.0);
    message.header.frame_id = "world";
    bag.write("/natnet/pointcloud", kStart_s + kPeriod_s * i + kDelay_s, message);
    if (i == 9) bag.write("/natnet/pointcloud", kStart_s + kPeriod_s * i + 2 * kDelay_s, message);
  }
  const auto result =
      bag.read(arm_with(std::string(kFixedBase) +
                        "inputs: {bodies: {topic: /natnet/pointcloud, type: sensor_msgs/PointCloud}}\n"));
  expect_rings(result, 20);
  EXPECT_THAT(result.rejected, Contains(Pair("duplicate markers", 1u)));
}

TEST(DriversCloud, ADamagedStampLosesNoTrackAndANewTimeIsFollowed) {
  const std::string parts =
      std::string(kFixedBase) + "inputs: {bodies: {topic: /cloud, type: sensor_msgs/PointCloud}}\n";
  for (double shift : {-500.0, 1e6}) {
    TestBag damaged, looped;
    for (int i = 0; i < 40; ++i) {
      damaged.write("/cloud", kStart_s + kPeriod_s * i, cloud_at(i, i == 9 ? shift : 0.0));
      looped.write("/cloud", kStart_s + kPeriod_s * i, cloud_at(i, i < 20 ? 0.0 : -500.0));
    }
    const auto kept = damaged.read(arm_with(parts));
    EXPECT_THAT(kept.frames, SizeIs(39));
    EXPECT_EQ(kept.time_jumps, 0u);
    EXPECT_EQ(kept.rejected.count("association_restarted markers"), 0u);
    const auto followed = looped.read(arm_with(parts));
    EXPECT_THAT(followed.frames, SizeIs(39));
    EXPECT_EQ(followed.time_jumps, 1u);
  }
}

TEST(DriversCloud, PointsOfPointCloud2AreAssociated) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    sensor_msgs::PointCloud2 message;
    message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);
    sensor_msgs::PointCloud2Modifier modifier(message);
    modifier.setPointCloud2FieldsByString(1, "xyz");
    const auto points = shuffled(i);
    modifier.resize(points.size());
    sensor_msgs::PointCloud2Iterator<float> x(message, "x"), y(message, "y"), z(message, "z");
    for (const Eigen::Vector3d& p : points) {
      *x = static_cast<float>(p.x());
      *y = static_cast<float>(p.y());
      *z = static_cast<float>(p.z());
      ++x, ++y, ++z;
    }
    if (i == 19) message.data.resize(3);  // cut off
    bag.write("/cloud", kStart_s + kPeriod_s * i, message);
  }
  const auto result = bag.read(arm_with(
      std::string(kFixedBase) + "inputs: {bodies: {topic: /cloud, type: sensor_msgs/PointCloud2}}\n"));
  expect_rings(result, 19);
  EXPECT_THAT(result.rejected, Contains(Pair("no_points markers", 1u)));
}

TEST(DriversCloud, SpheresThatADriverDrawsWithYUp) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    visualization_msgs::Marker message;
    message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);
    message.type = visualization_msgs::Marker::SPHERE_LIST;
    for (const Eigen::Vector3d& p : shuffled(i)) message.points.push_back(point_of({p.x(), p.z(), -p.y()}));
    bag.write("/mocap/markers/vis", kStart_s + kPeriod_s * i, message);
  }
  expect_rings(
      bag.read(arm_with(std::string(kFixedBase) +
                        "inputs: {bodies: {topic: /mocap/markers/vis, type: visualization_msgs/Marker, "
                        "axes: x -z y}}\n")),
      20);
}

TEST(DriversCloud, AListWhoseLabelsDoNotHold) {
  TestBag bag;
  for (int i = 0; i < 20; ++i) {
    softarm_estimator::MocapMarkerList message;
    message.header.stamp = ros::Time(kStart_s + kPeriod_s * i);
    for (const Eigen::Vector3d& p : shuffled(i)) {
      softarm_estimator::MocapMarker marker;
      marker.id = std::to_string(message.markers.size());
      marker.tracked = true;
      marker.position = point_of(p);
      message.markers.push_back(marker);
    }
    bag.write_as("mocap_base/MarkerList", "/qualisys/markers", kStart_s + kPeriod_s * i, message);
  }
  expect_rings(bag.read(arm_with(std::string(kFixedBase) +
                                 "inputs: {bodies: {topic: /qualisys/markers, type: mocap_base/MarkerList, "
                                 "labels: false}}\n")),
               20);
}

}  // namespace
}  // namespace softarm::drivers
