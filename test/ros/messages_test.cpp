// Estimates as messages and markers, and the guard against what is not finite.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>

#include "arm/actuators/actuator.h"
#include "ros/backbone_sampling.h"
#include "ros/conversions.h"
#include "ros/estimate_message.h"
#include "ros/finite.h"
#include "ros/labels.h"
#include "ros/markers.h"
#include "ros/mismatch_message.h"

namespace softarm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

arm::Arm one_ring_arm() {
  arm::Arm arm;
  arm.name = "arm";
  arm.segments.resize(1);
  arm.segments[0].name = "segment_1";
  arm.segments[0].length_m = 0.2;
  arm.segments[0].diameter_m = 0.04;
  arm.segments[0].mass_per_length_kg_m = 1.0;
  arm::MeasuredBody ring;
  ring.name = "ring_1";
  ring.arclength_m = 0.1;
  arm.bodies.push_back(ring);
  arm.payload.arclength_m = 0.2;
  return arm;
}

/// A circle of a quarter turn in the plane of x and z.
estimate::Estimate quarter_circle() {
  estimate::Estimate estimate;
  estimate.status = estimate::Status::kOk;
  const double curvature = 0.5 * M_PI / 0.2;
  for (int i = 0; i <= 8; ++i) {
    estimate::BackbonePoint point;
    point.arclength_m = 0.025 * i;
    const double angle = curvature * point.arclength_m;
    point.p_base = Eigen::Vector3d(1.0 - std::cos(angle), 0.0, std::sin(angle)) / curvature;
    point.q_base = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY());
    point.curvature_per_m = {0.0, curvature, 0.0};
    estimate.backbone.push_back(point);
  }
  estimate::SegmentEstimate segment;
  segment.bending_stiffness_nm2 = 0.0312;
  segment.sd_bending_stiffness_nm2 = 0.0021;
  segment.identifiable_stiffness = true;
  segment.direction_rad = -0.52341;
  segment.sd_direction_rad = 0.0231;
  segment.length_m = 0.20134;
  segment.sd_length_m = 0.00042;
  estimate.segments.push_back(segment);
  estimate.payload_kg = 0.2;
  estimate::BodyResidual residual;
  residual.measured_base = backbone_at(estimate.backbone, 0.1).p_base + Eigen::Vector3d(0, 1e-3, 0);
  residual.estimated_base = backbone_at(estimate.backbone, 0.1).p_base;
  estimate.residuals.push_back(residual);
  return estimate;
}

struct Fixture {
  arm::Arm arm = one_ring_arm();
  arm::EstimatorOptions options;
  FrameNames frames{"mocap", "arm"};
  MessageContext context{arm, options, frames, ros::Time(100, 5)};
};

std::set<std::string> namespaces(const visualization_msgs::MarkerArray& array, int action) {
  std::set<std::string> names;
  for (const auto& marker : array.markers) {
    if (marker.action == action) names.insert(marker.ns);
  }
  return names;
}

/// Of the markers `text`, with the lines from top to bottom.
std::string text_of(const visualization_msgs::MarkerArray& array) {
  std::string text;
  double above = 1e9;
  for (const auto& marker : array.markers) {
    if (marker.ns != "text") continue;
    EXPECT_EQ(marker.text.find('\n'), std::string::npos) << "rviz sets lines apart by a height of its own";
    EXPECT_LT(marker.pose.position.z, above);
    above = marker.pose.position.z;
    text += (text.empty() ? "" : "\n") + marker.text;
  }
  return text;
}

TEST(BackboneSampling, FollowsACircleBetweenItsPointsAndHoldsTheEnds) {
  const estimate::Estimate estimate = quarter_circle();
  const double radius = 0.2 / (0.5 * M_PI);
  for (int i = 0; i <= 100; ++i) {
    const estimate::BackbonePoint point = backbone_at(estimate.backbone, 0.002 * i);
    const double angle = 0.5 * M_PI * i / 100.0;
    const Eigen::Vector3d exact = radius * Eigen::Vector3d(1.0 - std::cos(angle), 0.0, std::sin(angle));
    EXPECT_LT((point.p_base - exact).norm(), 0.2e-3);
    EXPECT_LT(
        point.q_base.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()))),
        1e-9);
  }
  EXPECT_EQ(backbone_at(estimate.backbone, 1.0).p_base, estimate.backbone.back().p_base);
  EXPECT_EQ(backbone_at(estimate.backbone, -1.0).p_base, estimate.backbone.front().p_base);
  EXPECT_EQ(resample_backbone(estimate.backbone, 33).size(), 33u);
}

/// Of a driver whose epoch is 1900, or nobody's: a node must live with what an assembler takes.
TEST(Conversions, StampsOfAnotherEpochAreTimes) {
  const ros::Time now(1796000000, 500000000);
  constexpr std::int64_t kSince1900_ns = 2208988800LL * 1'000'000'000;
  const auto now_ns = static_cast<std::int64_t>(now.toNSec());
  EXPECT_EQ(nearest_time(now_ns), now);
  EXPECT_DOUBLE_EQ(seconds_since(now_ns - 250'000'000, now), 0.25);
  EXPECT_EQ(nearest_time(now_ns + kSince1900_ns).sec, 1796000000u + 2208988800u);
  EXPECT_DOUBLE_EQ(seconds_since(now_ns + kSince1900_ns, now), -2208988800.0);
  EXPECT_EQ(nearest_time(trial::Stamp(8.9e9).ns), ros::Time(0xFFFFFFFFu, 999999999u));
  EXPECT_EQ(nearest_time(-5), ros::Time());
  monitor::Mismatch mismatch;
  mismatch.onset_s = 8.9e9;
  Fixture f;
  EXPECT_EQ(to_message(mismatch, f.context).onset, ros::Time(0xFFFFFFFFu, 999999999u));
  mismatch.onset_s = -1.0;
  EXPECT_TRUE(to_message(mismatch, f.context).onset.isZero());
}

TEST(AllFinite, FindsWhatIsNotFiniteHoweverDeep) {
  Fixture f;
  softarm_estimator::ArmEstimate message = to_message(quarter_circle(), f.context, 1e-4);
  EXPECT_TRUE(all_finite(message));
  auto broken = message;
  broken.segments[0].covariance[7] = kNan;
  EXPECT_FALSE(all_finite(broken));
  broken = message;
  broken.backbone.back().orientation.y = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(all_finite(broken));
  broken = message;
  broken.reduced_chi_square = kNan;
  EXPECT_FALSE(all_finite(broken));
  visualization_msgs::MarkerArray markers = to_markers(quarter_circle(), f.context);
  EXPECT_TRUE(all_finite(markers));
  markers.markers.back().color.a = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(all_finite(markers));
}

TEST(EstimateMessage, CarriesValuesFlagsAndBackbone) {
  Fixture f;
  const auto message = to_message(quarter_circle(), f.context, 1e-4);
  EXPECT_EQ(message.header.frame_id, "arm/base");
  EXPECT_EQ(message.header.stamp, ros::Time(100, 5));
  EXPECT_EQ(message.status, softarm_estimator::ArmEstimate::STATUS_OK);
  ASSERT_EQ(message.segments.size(), 1u);
  EXPECT_EQ(message.segments[0].name, "segment_1");
  EXPECT_TRUE(message.segments[0].identifiable_bending_stiffness);
  EXPECT_DOUBLE_EQ(message.segments[0].bending_stiffness, 0.0312);
  EXPECT_FALSE(message.segments[0].has_moment);
  EXPECT_TRUE(message.payload_is_known);
  EXPECT_FALSE(message.prior);
  EXPECT_EQ(message.window, 0.0);
  EXPECT_EQ(message.backbone.size(), 9u);
  EXPECT_EQ(message.body_names, std::vector<std::string>{"ring_1"});
}

TEST(EstimateMessage, WithoutEstimateThereIsNoShape) {
  Fixture f;
  estimate::Estimate estimate = quarter_circle();  // what was left in the estimator from before
  estimate.status = estimate::Status::kNotEnoughBodies;
  estimate.detail = "1 of 4 bodies";
  const auto message = to_message(estimate, f.context, 1e-4);
  EXPECT_EQ(message.status, softarm_estimator::ArmEstimate::STATUS_NOT_ENOUGH_BODIES);
  EXPECT_EQ(message.detail, "1 of 4 bodies");
  EXPECT_TRUE(message.segments.empty());
  EXPECT_TRUE(message.backbone.empty());
  EXPECT_FALSE(message.has_payload);
}

TEST(EstimateMessage, TransformsAreBaseRingsAndTip) {
  Fixture f;
  estimate::Estimate estimate = quarter_circle();
  estimate.base_in_mocap.translation() = Eigen::Vector3d(0, 0, 1);
  const auto transforms = to_transforms(estimate, f.context);
  ASSERT_EQ(transforms.size(), 3u);
  EXPECT_EQ(transforms[0].header.frame_id, "mocap");
  EXPECT_EQ(transforms[0].child_frame_id, "arm/base");
  EXPECT_EQ(transforms[0].transform.translation.z, 1.0);
  EXPECT_EQ(transforms[1].child_frame_id, "arm/ring_1");
  EXPECT_EQ(transforms[2].child_frame_id, "arm/tip");
  EXPECT_NEAR(transforms[2].transform.translation.x, 0.2 / (0.5 * M_PI), 1e-12);
}

TEST(Markers, ShowShapePointsLoadAndNumbers) {
  Fixture f;
  const auto array = to_markers(quarter_circle(), f.context);
  const std::set<std::string> all{"backbone", "rings", "measured", "estimated", "residuals",
                                  "payload",  "scale", "legend",   "text"};
  EXPECT_EQ(namespaces(array, visualization_msgs::Marker::ADD), all);
  for (const auto& marker : array.markers) {
    EXPECT_EQ(marker.header.frame_id, "mocap");
    EXPECT_GT(marker.lifetime.toSec(), 0.0);
    EXPECT_TRUE(marker.colors.empty() || marker.colors.size() == marker.points.size());
  }
  EXPECT_EQ(text_of(array),
            "arm\nEI 31.2 ± 2.1 mN m²\nφ -30.0 ± 1.3°   L 201.34 ± 0.42 mm\npayload 200.0 g (known)");
}

TEST(Markers, FiguresHaveTwoSignificantDigitsOfTheirStandardDeviation) {
  EXPECT_EQ(plus_minus(26.4312, 3.3123), "26.4 ± 3.3");
  EXPECT_EQ(plus_minus(201.3, 0.04213), "201.300 ± 0.042");
  EXPECT_EQ(plus_minus(1234.5, 231.0), "1230 ± 230");
  EXPECT_EQ(plus_minus(1.0, 0.0996), "1.00 ± 0.10");
  EXPECT_EQ(plus_minus(-0.001, 9.96), "0 ± 10");
  EXPECT_EQ(plus_minus(31.249, 0.0), "31.2");
}

TEST(Markers, ScaleAndLegendSayWhatTheColoursAre) {
  Fixture f;
  const auto array = to_markers(quarter_circle(), f.context);
  std::set<std::string> words;
  for (const auto& marker : array.markers) {
    if (marker.ns == "scale" || marker.ns == "legend") words.insert(marker.text);
    if (marker.text == "measured") {
      const auto dots = std::find_if(array.markers.begin(), array.markers.end(),
                                     [](const auto& one) { return one.ns == "measured"; });
      EXPECT_EQ(marker.color, dots->colors.front());
    }
  }
  EXPECT_EQ(words,
            (std::set<std::string>{"", "curvature", "12.5 1/m", "0", "measured", "estimated", "payload"}));
  const auto bar = std::find_if(array.markers.begin(), array.markers.end(),
                                [](const auto& marker) { return marker.ns == "scale"; });
  ASSERT_NE(bar, array.markers.end());
  EXPECT_GT(bar->colors.front().b, bar->colors.front().r);
  EXPECT_GT(bar->colors.back().r, bar->colors.back().b);
}

TEST(Markers, SayWhatIsWaitedFor) {
  Fixture f;
  const auto array = waiting_markers("waiting for /mocap/base/pose, /mocap/ring_1/pose and 3 more",
                                     Eigen::Isometry3d::Identity(), f.context);
  ASSERT_EQ(array.markers.size(), 3U);
  EXPECT_EQ(text_of(array), "arm\nwaiting for /mocap/base/pose,\n/mocap/ring_1/pose and 3 more");
  EXPECT_GT(array.markers[0].lifetime.toSec(), 1.0) << "it comes once a second";
}

TEST(Markers, TendonsLieOnTheirSideOfTheBentArm) {
  Fixture f;
  f.arm.segments[0].tendons = {{"tendon_1", 0.0, 0.01}, {"tendon_2", M_PI, 0.01}};
  const estimate::Estimate estimate = quarter_circle();
  const auto array = to_markers(estimate, f.context);
  const auto found = std::find_if(array.markers.begin(), array.markers.end(),
                                  [](const auto& marker) { return marker.ns == "tendons"; });
  ASSERT_NE(found, array.markers.end());
  ASSERT_EQ(found->points.size() % 4, 0u);
  // The arm bends towards x: the first tendon is on the inner, shorter side, the second on the outer one.
  const auto length_m = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t i = from; i < from + found->points.size() / 2; i += 2) {
      const auto &a = found->points[i], &b = found->points[i + 1];
      sum += std::hypot(std::hypot(b.x - a.x, b.y - a.y), b.z - a.z);
    }
    return sum;
  };
  EXPECT_NEAR(length_m(0), 0.2 - 0.01 * 0.5 * M_PI, 5e-4);
  EXPECT_NEAR(length_m(found->points.size() / 2), 0.2 + 0.01 * 0.5 * M_PI, 5e-4);
}

TEST(Markers, EveryActuatorWhosePlaceIsKnownIsDrawnThere) {
  Fixture f;
  arm::Segment& segment = f.arm.segments[0];
  segment.tendons = {{"tendon_1", 0.3, 0.01}};
  segment.cables = {{"servo_1", 2.0, 5.0}, {"servo_2", -2.0, 5.0}};
  segment.chambers = {{"chamber_1", 1.0, 6e-6, 0.0, 0.0}};
  segment.central_chamber = {"chamber_2", 1e-4};
  segment.jamming_input = "vacuum";
  const estimate::Estimate estimate = quarter_circle();
  const auto array = to_markers(estimate, f.context);
  const auto found = std::find_if(array.markers.begin(), array.markers.end(),
                                  [](const auto& marker) { return marker.ns == "tendons"; });
  ASSERT_NE(found, array.markers.end());
  std::size_t lines = 0;
  for (const arm::ActuatorKind* kind : arm::actuator_kinds()) {
    EXPECT_GT(kind->count(segment), 0) << kind->traits().name << ": add some";
    for (int i = 0; i < kind->count(segment); ++i) {
      const auto place_m = kind->place_m(segment, i);
      if (!place_m) continue;
      ++lines;
      // At the base the section lies in the plane of x and y.
      EXPECT_TRUE(std::any_of(found->points.begin(), found->points.end(), [&](const auto& point) {
        return std::hypot(std::hypot(point.x - place_m->x(), point.y - place_m->y()), point.z) < 1e-9;
      })) << kind->traits().name;
    }
  }
  EXPECT_EQ(lines, 3u);
  EXPECT_EQ(found->points.size() % lines, 0u);
}

TEST(Markers, SayWhatAFrameDoesNotTell) {
  Fixture f;
  estimate::Estimate estimate = quarter_circle();
  estimate.segments[0].identifiable_stiffness = false;
  const std::string shape = "\nφ -30.0 ± 1.3°   L 201.34 ± 0.42 mm\n";
  EXPECT_EQ(estimate_text(estimate, f.arm, f.options),
            "EI not identifiable" + shape + "payload 200.0 g (known)");
  f.options.unknown = arm::Unknown::kPayload;
  EXPECT_EQ(estimate_text(estimate, f.arm, f.options),
            "EI 31.2 mN m² (known)" + shape + "payload not identifiable");
  estimate.identifiable_payload = true;
  estimate.sd_payload_kg = 0.01;
  estimate.segments[0].moment_nm = 0.1;
  estimate.segments[0].sd_direction_rad.reset();
  EXPECT_EQ(estimate_text(estimate, f.arm, f.options),
            "EI 31.2 mN m² (known)   M0 not identifiable\nφ not determined   L 201.34 ± 0.42 mm\n"
            "payload 200 ± 10 g");
  estimate.segments[0].sd_moment_nm = 0.01234;
  estimate.segments[0].identifiable_moment = true;
  EXPECT_THAT(estimate_text(estimate, f.arm, f.options), ::testing::HasSubstr("   M0 100 ± 12 mN m\n"));
}

TEST(Markers, AreDeletedWithTheEstimate) {
  Fixture f;
  estimate::Estimate estimate = quarter_circle();
  estimate.status = estimate::Status::kMissingPayload;
  estimate.detail = "the payload is not known";
  const auto array = to_markers(estimate, f.context);
  EXPECT_EQ(namespaces(array, visualization_msgs::Marker::DELETE).size(), 7u);
  EXPECT_EQ(namespaces(array, visualization_msgs::Marker::ADD), std::set<std::string>{"text"});
  EXPECT_EQ(text_of(array), "arm\nno estimate: the payload is not known");
}

}  // namespace
}  // namespace softarm
