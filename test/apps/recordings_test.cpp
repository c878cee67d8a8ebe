// Simulated, imported and real recordings through the program.
#include <geometry_msgs/PoseStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "csv_rows.h"
#include "estimate/estimates_csv.h"
#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

template <typename Message>
std::vector<std::pair<double, Message>> recorded(const std::string& bag_path, const std::string& topic) {
  rosbag::Bag bag(bag_path, rosbag::bagmode::Read);
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  std::vector<std::pair<double, Message>> messages;
  for (const rosbag::MessageInstance& m : view) {
    const auto message = m.instantiate<Message>();
    if (message) messages.emplace_back(m.getTime().toSec(), *message);
  }
  return messages;
}

TEST(SoftarmImport, ASyntheticRecordingReadsBackInSi) {
  const TestFolder dir;
  const std::string layout = dir.write("lab.yaml", R"(
separator: semicolon
header: true
time: {column: t_ms, unit: ms, start_stamp_s: 1000}
mocap:
  unit: mm
  up: y
  bodies:
    - {name: base, position: [x, y, z], orientation: [qw, qx, qy, qz], orientation_order: wxyz}
pressures:
  unit: bar
  reference: gauge
  ambient_pa: 100000
  inputs: [{topic: /pressure/chamber_1, column: p}]
payload: [{from_s: -1, kg: 0.1}, {from_s: 0.015, kg: 0.3}]
)");
  const std::string csv = dir.write("lab.csv",
                                    "t_ms;x;y;z;qw;qx;qy;qz;p\n"
                                    "10;100;200;300;1;0;0;0;0.5\n"
                                    "20;110;210;310;1;0;0;0;oops\n"
                                    "30;120;220;320;1;0;0;0;-0.25\n");
  const Outcome o = softarm_program("import " + layout + " " + csv + " --out " + dir / "lab.bag");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("2 of 3 rows"));
  EXPECT_THAT(o.err, HasSubstr("lab.csv:3:"));

  const auto poses = recorded<geometry_msgs::PoseStamped>(dir / "lab.bag", "/mocap/base/pose");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].second.header.frame_id, "mocap");
  EXPECT_NEAR(poses[1].second.header.stamp.toSec(), 1000.03, 1e-9);
  EXPECT_NEAR(poses[1].first, 1000.03, 1e-9);
  EXPECT_NEAR(poses[1].second.pose.position.x, 0.12, 1e-12);
  EXPECT_NEAR(poses[1].second.pose.position.y, -0.32, 1e-12);
  EXPECT_NEAR(poses[1].second.pose.position.z, 0.22, 1e-12);
  EXPECT_NEAR(poses[1].second.pose.orientation.x, std::sqrt(0.5), 1e-12);
  const auto pressures = recorded<sensor_msgs::FluidPressure>(dir / "lab.bag", "/pressure/chamber_1");
  ASSERT_EQ(pressures.size(), 2u);
  EXPECT_NEAR(pressures[0].second.fluid_pressure, 150e3, 1e-6);
  EXPECT_NEAR(pressures[1].second.fluid_pressure, 75e3, 1e-6);
  const auto payload = recorded<std_msgs::Float64>(dir / "lab.bag", "/payload");
  ASSERT_EQ(payload.size(), 2u);
  EXPECT_EQ(payload[0].second.data, 0.1);
  EXPECT_LT(payload[0].first, poses[0].first);
  EXPECT_EQ(payload[1].second.data, 0.3);
  EXPECT_NEAR(payload[1].first, 1000.015, 1e-5);
}

TEST(SoftarmImport, PayloadAndTimesToLeaveOutAreToldOnTheCommandLine) {
  const TestFolder dir;
  const std::string layout = dir.write("lab.yaml", R"(
time: {column: 1, unit: s, start_stamp_s: 1000}
mocap:
  unit: m
  up: z
  bodies: [{name: tip, position: [2, 3, 4], fixed_orientation: [0, 0, 0, 1]}]
payload: [{from_s: 0, kg: 7}]
)");
  const std::string csv = dir.write("lab.csv", "0,1,0,0\n1,2,0,0\n2,3,0,0\n3,4,0,0\n4,5,0,0\n");
  const std::string call = "import " + layout + " " + csv + " --out " + dir / "lab.bag ";
  const Outcome o = softarm_program(call + "--payload 0.1 --payload 2.5:0.3 --leave-out 1:3");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("3 of 5 rows"));
  EXPECT_THAT(o.out, HasSubstr("rows left out, as requested: 2"));
  const auto poses = recorded<geometry_msgs::PoseStamped>(dir / "lab.bag", "/mocap/tip/pose");
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_NEAR(poses[1].first, 1003.0, 1e-9);
  const auto payload = recorded<std_msgs::Float64>(dir / "lab.bag", "/payload");
  ASSERT_EQ(payload.size(), 2u);
  EXPECT_EQ(payload[0].second.data, 0.1);
  EXPECT_EQ(payload[1].second.data, 0.3);
  EXPECT_NEAR(payload[1].first, 1002.5, 1e-5);

  const std::size_t entries = dir.entries();
  for (const auto& [bad, named] :
       std::map<std::string, std::string>{{"--payload x", "--payload x"},
                                          {"--payload 2:-1", "0 to 100 kg"},
                                          {"--payload 3:1 --payload 2:1", "later"},
                                          {"--leave-out 3:1", "FROM:TO"},
                                          {"--leave-out -1:9", "leaves nothing"}}) {
    const Outcome refused = softarm_program(call + bad);
    EXPECT_NE(refused.status, 0) << bad;
    EXPECT_THAT(refused.err, HasSubstr(named));
  }
  EXPECT_EQ(dir.entries(), entries);
}

TEST(SoftarmSimulate, TheSameSeedGivesTheSameBytesAndAnotherDoesNot) {
  const TestFolder dir;
  const auto simulate = [&](const std::string& name, const std::string& more) {
    const Outcome o =
        softarm_program("simulate trial_10s --seconds 3 " + more + " --out " + dir / name + ".bag");
    EXPECT_EQ(o.status, 0) << o.err;
    EXPECT_THAT(o.out, HasSubstr("truth_sha256: "));
    return text_of(dir / name + ".bag");
  };
  const std::string a = simulate("a", "--seed 5");
  EXPECT_GT(a.size(), 10000u);
  EXPECT_TRUE(a == simulate("b", "--seed 5"));
  EXPECT_FALSE(a == simulate("c", "--seed 6"));
  EXPECT_EQ(text_of(dir / "a.truth.csv"), text_of(dir / "b.truth.csv"));
}

TEST(SoftarmSimulate, TheBagHoldsTheTopicsOfATrialAndNothingElse) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --out " + dir / "a.bag").status, 0);
  rosbag::Bag bag(dir / "a.bag", rosbag::bagmode::Read);
  std::set<std::string> topics;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* c : view.getConnections()) topics.insert(c->topic);
  EXPECT_EQ(topics,
            (std::set<std::string>{"/mocap/base/pose", "/mocap/ring_1/pose", "/mocap/ring_2/pose",
                                   "/mocap/ring_3/pose", "/mocap/ring_4/pose", "/payload",
                                   "/pressure/chamber_1", "/pressure/chamber_2", "/pressure/chamber_3"}));
}

TEST(SoftarmEstimate, ASimulatedTrialIsEstimatedCloseToItsTruth) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --out " + dir / "a.bag").status, 0);
  const Outcome o = softarm_program("estimate --arm online_200mm " + dir / "a.bag" + " --out " + dir / "out");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("frames_per_s: "));
  EXPECT_EQ(text_of(dir / "out/a/estimates.csv").substr(0, estimate::estimates_csv_header().size() + 1),
            estimate::estimates_csv_header() + "\n");
  EXPECT_THAT(text_of(dir / "out/a/summary.txt"), HasSubstr("frames ok"));

  std::map<long, Row> truth;
  const auto key = [](const Row& row) { return std::lround((std::stod(row.at("stamp")) - 1.6e9) * 1e4); };
  for (const Row& row : csv_rows(dir / "a.truth.csv")) truth[key(row)] = row;
  const std::vector<Row> rows = csv_rows(dir / "out/a/estimates.csv");
  ASSERT_GT(rows.size(), 1100u);
  std::size_t ok = 0, identifiable = 0, identifiable_close = 0;
  double sum_tip_m2 = 0.0;
  for (const Row& row : rows) {
    if (row.at("status") != "ok") continue;
    ++ok;
    const Row& t = truth.at(key(row));
    for (const char* c : {"tip_x", "tip_y", "tip_z"})
      sum_tip_m2 += std::pow(std::stod(row.at(c)) - std::stod(t.at(c)), 2);
    if (row.at("identifiable_EI") != "1" || t.at("payload_steadied") == "1") continue;
    ++identifiable;
    identifiable_close += std::abs(std::stod(row.at("EI")) / std::stod(t.at("EI")) - 1.0) < 0.75;
  }
  EXPECT_GT(ok, rows.size() * 95 / 100);
  // The markers' noise is 0.5 mm per coordinate; the rod's shape cannot be much worse than that.
  EXPECT_LT(std::sqrt(sum_tip_m2 / static_cast<double>(ok)), 1.5e-3);
  ASSERT_GT(identifiable, 50u);
  // Identifiable means a standard deviation of 25 % or less: three of them, in a trial that moves.
  EXPECT_GT(identifiable_close, identifiable * 95 / 100);
}

/// Median of a column over the frames that are ok.
double median_of(const std::vector<Row>& rows, const std::string& column) {
  std::vector<double> values;
  for (const Row& row : rows) {
    if (row.at("status") == "ok" && !row.at(column).empty()) values.push_back(std::stod(row.at(column)));
  }
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

TEST(SoftarmEstimate, StiffnessAndPayloadAtOnceNeedThePriorAndGainByTheWindow) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 5 --out " + dir / "a.bag").status, 0);
  const auto run = [&](const std::string& options) {
    const Outcome o = softarm_program("estimate --arm online_200mm --unknown both --force " + options + " " +
                                      dir / "a.bag" + " --out " + dir / "out");
    EXPECT_EQ(o.status, 0) << o.err;
    return o;
  };
  const std::string note = "softarm: note: one frame cannot separate EI and payload: enable the prior\n";
  EXPECT_EQ(run("").err, note);
  const double alone_kg = median_of(csv_rows(dir / "out/a/estimates.csv"), "sd_payload");
  EXPECT_EQ(run("--prior on").err, "");
  const double prior_kg = median_of(csv_rows(dir / "out/a/estimates.csv"), "sd_payload");
  EXPECT_THAT(run("--prior on --window 0.5").out, HasSubstr("unknown: both, prior: on, window: 0.5 s"));
  const std::vector<Row> rows = csv_rows(dir / "out/a/estimates.csv");
  const double window_kg = median_of(rows, "sd_payload");
  EXPECT_FALSE(alone_kg < 2.0 * prior_kg) << alone_kg << " kg alone, " << prior_kg << " kg with the prior";
  EXPECT_LT(window_kg, 0.7 * prior_kg);
  EXPECT_GT(median_of(rows, "payload"), 0.0);
}

TEST(SoftarmEstimate, AnInputThatThePriorLacksIsNamed) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 2 --out " + dir / "a.bag").status, 0);
  std::string text = text_of(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const std::string topic = "topic: /pressure/chamber_2";
  text.replace(text.find(topic), topic.size(), "topic: /pressure/elsewhere");
  const std::string arm = dir.write("arm.yaml", text);
  const std::string call = "estimate --arm " + arm + " " + dir / "a.bag" + " --out " + dir / "out";
  const Outcome o = softarm_program(call + " --prior on");
  EXPECT_EQ(o.status, 1) << "not one frame has an estimate";
  EXPECT_THAT(o.err, HasSubstr("no topic /pressure/elsewhere (chamber_2)"));
  EXPECT_THAT(o.err, HasSubstr("could be estimated: missing_inputs ("));
  for (const Row& row : csv_rows(dir / "out/a/estimates.csv")) ASSERT_EQ(row.at("status"), "missing_inputs");
  softarm_program(call + " --prior off --force");
  EXPECT_EQ(csv_rows(dir / "out/a/estimates.csv").at(100).at("status"), "ok");
}

TEST(SoftarmEstimate, TwoRunsWriteTheSameFilesWhateverTheJobs) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 3 --seed 1 --out " + dir / "a.bag").status, 0);
  ASSERT_EQ(softarm_program("simulate trial_10s --seconds 3 --seed 2 --out " + dir / "b.bag").status, 0);
  const std::string call = "estimate --arm online_200mm " + dir / "a.bag" + " " + dir / "b.bag";
  ASSERT_EQ(softarm_program(call + " --jobs 1 --out " + dir / "one").status, 0);
  ASSERT_EQ(softarm_program(call + " --jobs 2 --out " + dir / "two").status, 0);
  for (const std::string name : {"a/estimates.csv", "b/estimates.csv", "a/summary.txt", "b/summary.txt"}) {
    EXPECT_FALSE(text_of(dir / "one/" + name).empty());
    EXPECT_EQ(text_of(dir / "one/" + name), text_of(dir / "two/" + name)) << name;
  }
}

TEST(SoftarmRecordings, PouchArmOneSegment) {
  if (recordings().empty()) GTEST_SKIP() << "the recordings of the pouch arm are absent (SOFTARM_DATA)";
  const TestFolder dir;
  const std::string source = recordings() + "/pouch_arm/one_segment/";
  const Outcome imported =
      softarm_program("import pouch_arm_one_segment " + source + "*/*.txt --out " + dir / "bags/");
  ASSERT_EQ(imported.status, 0) << imported.err;
  const Outcome o =
      softarm_program("estimate --arm pouch_arm_one_segment " + dir / "bags/*.bag" + " --out " + dir / "out");
  ASSERT_EQ(o.status, 0) << o.err;
  for (const std::string name :
       {"no_load_data_collect_1", "load_400g_data_collect_1", "load_400g_data_collect_3"}) {
    SCOPED_TRACE(name);
    const std::vector<Row> rows = csv_rows(dir / "out/" + name + "/estimates.csv");
    ASSERT_GT(rows.size(), 500u);
    std::size_t ok = 0, in_sd = 0, with_sd = 0;
    for (const Row& row : rows) {
      if (row.at("status") != "ok") continue;
      ++ok;
      EXPECT_GT(std::stod(row.at("L")), 0.10);
      EXPECT_LT(std::stod(row.at("L")), 0.16);
      // A payload that is identifiable must carry its standard deviation, of 25 % or better.
      if (row.at("identifiable_payload") == "1") {
        ASSERT_FALSE(row.at("sd_payload").empty());
        ++with_sd;
        in_sd += std::stod(row.at("sd_payload")) <= 0.2501 * std::stod(row.at("payload"));
      }
    }
    EXPECT_GT(ok, rows.size() * 9 / 10);
    EXPECT_EQ(in_sd, with_sd);
  }
}

}  // namespace
}  // namespace softarm
