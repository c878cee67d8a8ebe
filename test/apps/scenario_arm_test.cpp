// Arm files as scenarios: the virtual rig is that arm, with its bodies, base, topics and units.
#include <gmock/gmock.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/FluidPressure.h>

#include <boost/algorithm/string.hpp>
#include <cmath>
#include <map>

#include "csv_rows.h"
#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

/// Of the rows of estimates.csv.
struct ArmEstimated {
  std::size_t rows = 0, ok = 0, identifiable = 0;
  double length_m = 0.0;    ///< median of the first segment's, where ok
  double residual_m = 0.0;  ///< median
};

ArmEstimated estimated_of(const std::string& csv) {
  ArmEstimated found;
  std::vector<double> lengths, residuals;
  for (const Row& row : csv_rows(csv)) {
    ++found.rows;
    if (row.at("status") != "ok") continue;
    ++found.ok;
    found.identifiable += row.at("identifiable_EI") == "1";
    lengths.push_back(std::stod(row.at("L")));
    residuals.push_back(std::stod(row.at("rms_residual")));
  }
  std::sort(lengths.begin(), lengths.end());
  std::sort(residuals.begin(), residuals.end());
  if (!lengths.empty()) found.length_m = lengths[lengths.size() / 2];
  if (!residuals.empty()) found.residual_m = residuals[residuals.size() / 2];
  return found;
}

/// Simulates an arm file and estimates what was recorded.
ArmEstimated shown(const TestFolder& dir, const std::string& arm, const std::string& estimate_flags = "") {
  const Outcome simulated = softarm_program("simulate " + arm + " --seconds 6 --out " + dir / "trial.bag");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const Outcome o = softarm_program("estimate --arm " + arm + " " + dir / "trial.bag" + " --out " +
                                    dir / "out " + estimate_flags);
  EXPECT_EQ(o.status, 0) << o.err;
  return estimated_of(dir / "out/trial/estimates.csv");
}

struct Kind {
  const char *name, *flags;
  double length_m;
  const char* estimate_flags;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class ArmAsScenario : public ::testing::TestWithParam<Kind> {};

TEST_P(ArmAsScenario, HasItsBodiesAndIsConsistent) {
  const TestFolder dir;
  const std::string arm = dir / "arm.yaml";
  const Outcome made = softarm_program(std::string("new-arm ") + GetParam().flags + " --out " + arm);
  ASSERT_EQ(made.status, 0) << made.err;
  const ArmEstimated found = shown(dir, arm, GetParam().estimate_flags);
  EXPECT_GT(found.rows, 700u);
  EXPECT_GT(static_cast<double>(found.ok), 0.98 * static_cast<double>(found.rows));
  EXPECT_GT(found.identifiable, found.rows / 4);
  EXPECT_NEAR(found.length_m, GetParam().length_m, 0.05 * GetParam().length_m);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ArmAsScenario,
    ::testing::Values(
        Kind{"chambers",
             "--kind chambers --segments 1 --length 0.3 --mass 0.2 --diameter 0.04 --actuators 3 --bodies "
             "left:0.07,middle:0.19,top:tip",
             0.3, ""},
        Kind{"tendons_fixed_base",
             "--kind tendons --segments 1 --length 0.25 --mass 0.1 --diameter 0.03 --actuators 3 --bodies 4 "
             "--base "
             "horizontal",
             0.25, ""},
        Kind{"two_segments",
             "--kind chambers,cables --segments 2 --length 0.12,0.1 --mass 0.12,0.05 --diameter 0.04,0.03 "
             "--actuators 3,2 --angles 0,120,240/0,90 --bodies a:0.06,b:0.12,c:0.17,d:0.22 --base clamp",
             0.12, "--prior on --window 0.5"}),
    [](const auto& parameter) { return parameter.param.name; });

/// Poses off the backbone in mm on tf, the driver's y up; kPa above ambient in an array.
TEST(ArmAsScenarios, TopicsTypesAndUnitsAreTheFiles) {
  const TestFolder dir;
  std::string text = text_of(SOFTARM_SOURCE_DIR "/config/arms/semi_physical_200mm.yaml");
  const auto put = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    boost::replace_first(text, from, to);
  };
  const std::size_t inputs = text.find("\ninputs:");
  ASSERT_NE(inputs, std::string::npos);
  const std::size_t after = text.find("\nestimator:", inputs);
  text.replace(inputs, (after == std::string::npos ? text.size() : after) - inputs, R"(
inputs:
  bodies: {topic: /tf, type: tf2_msgs/TFMessage, unit: mm, axes: "x -z y", child_frame: lab/<body>, latency_s: 0.01}
  pressures:
    - {name: chamber_1, topic: /valves, type: std_msgs/Float32MultiArray, element: 2, unit: kPa, reference: gauge, zero: 3}
    - {name: chamber_2, topic: /valves, type: std_msgs/Float32MultiArray, element: 0, unit: kPa, reference: gauge}
    - {name: chamber_3, topic: /valves, type: std_msgs/Float32MultiArray, element: 1, unit: kPa, reference: gauge}
    - {name: vacuum, topic: /pump, type: std_msgs/Float64, unit: mbar, vacuum: true}
  payload_topic: /scales
)");
  const std::string ring = "  - name: ring_1\n";
  put(ring, ring + "    section_in_body: {position_m: [0, 0.03, 0.004], rpy_deg: [0, 20, 90]}\n");
  // Wrong pressures would contradict the bodies.
  const ArmEstimated found = shown(dir, dir.write("arm.yaml", text), "--prior on --window 0.5");
  EXPECT_GT(static_cast<double>(found.ok), 0.98 * static_cast<double>(found.rows));
  EXPECT_GT(found.rows, 700u);
  EXPECT_LT(found.residual_m, 1.2e-3);  // with bar for kPa 2.7 mm
}

/// With the effect in its file, the arm's own estimate of what it recorded is consistent.
TEST(ArmAsScenarios, TheClockOfOneInputIsTheFiles) {
  const TestFolder dir;
  const std::string text = text_of(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const std::string arm = dir.write(
      "arm.yaml", text + "\neffects:\n  - {id: clock_offset, parameters: {offset_s: 0.2, input: 2}}\n");
  ASSERT_EQ(softarm_program("simulate " + arm + " --seconds 3 --out " + dir / "trial.bag").status, 0);
  const std::string truth = text_of(dir / "trial.truth.yaml");
  EXPECT_THAT(truth, HasSubstr("effect: input_clock"));
  std::map<std::string, double> ahead_s;  // of receipt
  std::map<std::string, std::size_t> sent;
  rosbag::Bag bag(dir / "trial.bag");
  for (const rosbag::MessageInstance& one : rosbag::View(bag))
    if (const auto message = one.instantiate<sensor_msgs::FluidPressure>()) {
      ahead_s[one.getTopic()] += (message->header.stamp - one.getTime()).toSec();
      ++sent[one.getTopic()];
    }
  for (const auto& [topic, sum_s] : ahead_s)
    EXPECT_NEAR(sum_s / static_cast<double>(sent.at(topic)), topic == "/pressure/chamber_2" ? -0.2 : 0.0,
                1e-6)
        << topic;
  EXPECT_EQ(sent.count("/pressure/chamber_2"), 1u);
}

/// Cables at right angles pass through a segment of chambers. With the effect in its file the arm estimates
/// itself.
TEST(ArmAsScenarios, CablesThatPassThroughAnotherSegmentAreTheFiles) {
  const TestFolder dir;
  const Outcome made = softarm_program(
      "new-arm --kind chambers,cables --segments 2 --length 0.12,0.1 --mass 0.12,0.05 --diameter 0.04,0.03 "
      "--actuators 3,2 --angles 0,120,240/0,90 --bodies a:0.06,b:0.12,c:0.17,d:0.22 --base clamp --out " +
      dir / "plain.yaml");
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string arm =
      dir.write("arm.yaml", text_of(dir / "plain.yaml") +
                                "\neffects:\n  - {id: tendon_length, parameters: {share: 0.75}}\n");
  const ArmEstimated found = shown(dir, arm, "--prior on --window 0.5");
  EXPECT_GT(static_cast<double>(found.ok), 0.98 * static_cast<double>(found.rows));
  const std::string truth = text_of(dir / "trial.truth.yaml");
  EXPECT_THAT(truth, HasSubstr("effect: tendon_length"));
  EXPECT_THAT(truth, HasSubstr("form: held"));
  EXPECT_THAT(truth, HasSubstr("share: 0.75"));
}

TEST(ArmAsScenarios, WhatTheRigDoesNotHaveIsOneLine) {
  const TestFolder dir;
  const auto refused = [&](const std::string& scenario, const std::string& says) {
    const std::size_t before = dir.entries();
    const Outcome o = softarm_program("simulate " + scenario + " --seconds 5 --out " + dir / "trial.bag");
    EXPECT_NE(o.status, 0);
    EXPECT_THAT(o.err, HasSubstr(says));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(dir.entries(), before);
  };
  ASSERT_EQ(softarm_program(
                "new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators "
                "3 --bodies 4 --base hanging --out " +
                dir / "arm.yaml")
                .status,
            0);
  std::string text = text_of(dir / "arm.yaml");
  boost::replace_first(text, "/mocap/<body>/pose", "/vicon/markers");
  boost::replace_first(text, "geometry_msgs/PoseStamped", "vicon_bridge/Markers");
  refused(dir.write("markers.yaml", text),
          "markers.yaml: key 'inputs.bodies.type': value vicon_bridge/Markers has no counterpart");
  refused(dir.write("other.yaml",
                    "format: 1\nname: other\nduration_s: 8\narm: online_200mm\nmocap: {ring_fractions: "
                    "[0.2, 1]}\n"),
          "other.yaml: key 'mocap.ring_fractions': other places than those of the 4 bodies of");
}

}  // namespace
}  // namespace softarm
