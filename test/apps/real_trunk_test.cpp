// Recordings of the tendon trunk through import, identify and estimate. Absent: skipped by name.
#include <geometry_msgs/PoseStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/Float64.h>

#include <boost/algorithm/string.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

struct Payload {
  double kg = 0.0, sd_kg = 0.0;
  bool identifiable = false;
};

/// Of the last frame, whose window holds the most.
Payload last_payload(const std::string& path) {
  std::istringstream file(text_of(path));
  std::vector<std::string> names, cells;
  std::string line, last;
  std::getline(file, line);
  boost::split(names, line, [](char c) { return c == ','; });
  while (std::getline(file, line)) last = line;
  boost::split(cells, last, [](char c) { return c == ','; });
  const auto cell = [&](const std::string& name) {
    return cells.at(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
  };
  EXPECT_EQ(cell("status"), "ok") << path;
  return {std::stod(cell("payload")), std::stod(cell("sd_payload")), cell("identifiable_payload") == "1"};
}

class RealTrunk : public ::testing::Test {
 protected:
  void SetUp() override {
    data_ = recordings().empty() ? "" : recordings() + "/tendon_trunk/";
    if (data_.empty() || !std::filesystem::exists(data_ + "observations_controlled_1.csv"))
      GTEST_SKIP() << "the recordings of the tendon trunk are absent (SOFTARM_DATA)";
  }

  /// Pieces of 15 s of a recording under the known inputs: NAME_0.bag ... NAME_9.bag.
  void import(const TestFolder& dir, const std::string& name, const std::string& payload) {
    const Outcome o = softarm_program("import tendon_trunk_controlled " + data_ + name + ".csv --inputs " +
                                      data_ + "control_inputs_controlled_1.csv --payload " + payload +
                                      " --split-every 15 --leave-out 150:151 --out " + dir / "bags/");
    ASSERT_EQ(o.status, 0) << o.err;
    EXPECT_THAT(o.out, HasSubstr("15000 of 15001 rows"));
    EXPECT_THAT(o.out, HasSubstr("lacks: 1\n")) << "the last row has no inputs";
  }

  std::string data_;
};

TEST_F(RealTrunk, ImportJoinsTheInputsAndTurnsYUp) {
  const TestFolder dir;
  ASSERT_NO_FATAL_FAILURE(import(dir, "observations_controlled_1", "0"));
  rosbag::Bag bag(dir / "bags/observations_controlled_1_0.bag", rosbag::bagmode::Read);
  std::map<std::string, int> counts;
  for (const rosbag::MessageInstance& m : rosbag::View(bag)) {
    if (++counts[m.getTopic()] > 1) continue;
    if (m.getTopic() == "/mocap/disc_3/pose") {
      const auto pose = m.instantiate<geometry_msgs::PoseStamped>()->pose;
      EXPECT_NEAR(pose.position.x, 0.10867263, 1e-8);
      EXPECT_NEAR(pose.position.y, -0.10748907, 1e-8);
      EXPECT_NEAR(pose.position.z, -0.31190690, 1e-8);
      EXPECT_EQ(pose.orientation.w, 0.0) << "only positions were measured";
    }
    if (m.getTopic() == "/servo/1/angle") {
      EXPECT_NEAR(m.instantiate<std_msgs::Float64>()->data, 2.193359375 * M_PI / 180.0, 1e-12);
    }
    if (m.getTopic() == "/servo/2/command") {
      EXPECT_NEAR(m.instantiate<std_msgs::Float64>()->data, 3.7647425014272926 * M_PI / 180.0, 1e-12);
    }
  }
  EXPECT_EQ(counts.size(), 3u + 6u + 6u + 1u + 1u) << "discs, angles, commands, payload, the layout";
  EXPECT_EQ(counts["/servo/6/command"], 1500);
}

TEST_F(RealTrunk, ReleasesByHandBecomeTrialsOfTheirOwn) {
  const TestFolder dir;
  const Outcome o = softarm_program("import tendon_trunk_decay " + data_ +
                                    "observations_manual_decay_200g.csv --out " + dir / "bags/");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("(13 bags): 5689 of 5689 rows"));
  EXPECT_TRUE(std::filesystem::exists(dir / "bags/observations_manual_decay_200g_12.bag"));
}

TEST_F(RealTrunk, ShapeFollowsFromTheMotorsAndPayloadsComeOutInOrderWithHonestIntervals) {
  const TestFolder dir;
  ASSERT_NO_FATAL_FAILURE(import(dir, "observations_controlled_1", "0"));
  ASSERT_NO_FATAL_FAILURE(import(dir, "observations_controlled_1_100g", "0.1"));
  ASSERT_NO_FATAL_FAILURE(import(dir, "observations_controlled_1_300g", "0.3"));
  const std::string none = dir / "bags/observations_controlled_1_", some = none + "100g_",
                    most = none + "300g_";
  // 100 g is not fitted at all, nor is the block 5 of the others.
  std::string bags, held_out = "observations_controlled_1_5,observations_controlled_1_300g_5";
  for (const int i : {0, 1, 3, 5, 6}) {
    for (const std::string& stem : {none, some, most}) bags += " " + stem + std::to_string(i) + ".bag";
    held_out += ",observations_controlled_1_100g_" + std::to_string(i);
  }
  const Outcome o = softarm_program("identify --arm tendon_trunk" + bags + " --hold-out " + held_out +
                                    " --tie '*.bending_stiffness.base' --also-free '*.rest_curvature.*'"
                                    " --not-robust --frames 30 --json " +
                                    dir / "id.json --out " + dir / "arm.yaml");
  ASSERT_EQ(o.status, 0) << o.err;
  const auto json = nlohmann::json::parse(text_of(dir / "id.json"));
  EXPECT_LT(json.at("held_out").at("mean_m").get<double>(), 0.008);
  EXPECT_GT(json.at("held_out").at("mean_m").get<double>(), 0.003) << "too good: is it unseen?";

  const Outcome e =
      softarm_program("estimate --arm " + dir / "arm.yaml " + none + "5.bag " + some + "5.bag " + most +
                      "5.bag --unknown payload --prior on --window 5 --out " + dir / "out");
  ASSERT_EQ(e.status, 0) << e.err;
  const Payload p0 = last_payload(dir / "out/observations_controlled_1_5/estimates.csv"),
                p100 = last_payload(dir / "out/observations_controlled_1_100g_5/estimates.csv"),
                p300 = last_payload(dir / "out/observations_controlled_1_300g_5/estimates.csv");
  EXPECT_NEAR(p0.kg, 0.0, 2.5 * p0.sd_kg);
  EXPECT_NEAR(p100.kg, 0.1, 2.5 * p100.sd_kg);
  EXPECT_NEAR(p300.kg, 0.3, 2.5 * p300.sd_kg);
  EXPECT_LE(p0.kg, p100.kg + 1e-6);
  EXPECT_LT(p100.kg, p300.kg);
  EXPECT_FALSE(p0.identifiable) << "nothing hangs on it";
}

}  // namespace
}  // namespace softarm
