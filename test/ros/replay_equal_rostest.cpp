// A simulated trial, played by rosbag into the running node, against `softarm estimate` on the same bag.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <softarm_estimator/ArmEstimate.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <vector>

#include "apps/program.h"

namespace softarm {
namespace {

using Row = std::map<std::string, std::string>;

std::int64_t microseconds(double stamp_s) {
  return std::llround(stamp_s * 1e6);
}

/// Rows of the first segment by stamp.
std::map<std::int64_t, Row> offline(const std::string& path) {
  std::map<std::int64_t, Row> rows;
  std::vector<std::string> names, cells;
  std::istringstream file(text_of(path));
  for (std::string line; std::getline(file, line);) {
    boost::split(cells, line, [](char c) { return c == ','; });
    if (names.empty()) {
      names = cells;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = cells.at(i);
    rows[microseconds(std::stod(row["stamp"]))] = row;
  }
  return rows;
}

/// The live message as a row of the file.
Row row_of(const softarm_estimator::ArmEstimate& m) {
  if (m.segments.empty()) return {};  // refused, as the file says by having no value either
  const auto& s = m.segments.at(0);
  const auto exact = [](bool present, double x) {
    std::ostringstream text;
    text.precision(12);
    text << x;
    return present ? text.str() : std::string();
  };
  const bool ok = m.status == softarm_estimator::ArmEstimate::STATUS_OK;
  Row row;
  row["M0"] = exact(s.has_moment, s.moment);
  row["phi"] = exact(s.has_moment, s.direction);
  row["EI"] = exact(s.has_bending_stiffness, s.bending_stiffness);
  row["L"] = exact(ok, s.length);
  row["sd_EI"] = exact(s.determined_bending_stiffness, s.sd_bending_stiffness);
  row["sd_M0"] = exact(s.determined_moment, s.sd_moment);
  row["payload"] = exact(m.has_payload, m.payload);
  row["sd_payload"] = exact(m.determined_payload, m.sd_payload);
  row["identifiable_EI"] = s.identifiable_bending_stiffness ? "1" : "0";
  row["rms_residual"] = exact(ok, m.rms_residual);
  row["settling"] = m.settling ? "1" : "0";
  if (!m.backbone.empty()) {
    row["tip_x"] = exact(true, m.backbone.back().position.x);
    row["tip_y"] = exact(true, m.backbone.back().position.y);
    row["tip_z"] = exact(true, m.backbone.back().position.z);
  }
  return row;
}

using Live = std::map<std::int64_t, softarm_estimator::ArmEstimate>;

/// First frame that has what a payload's message told: its payload, or, where that is unknown, frames settle
/// from the change on.
Live::const_iterator first_with(const Live& live, Live::const_iterator from, double kg, bool is_known) {
  return std::find_if(from, live.end(), [&](const auto& entry) {
    const softarm_estimator::ArmEstimate& m = entry.second;
    return is_known ? m.has_payload && std::abs(m.payload - kg) < 1e-9 : static_cast<bool>(m.settling);
  });
}

/// The bag as the node received it: a payload has no stamp of its own, and holds from its receipt on, which
/// on a busy machine is a few frames later or earlier than its record. It is recorded at the first frame that
/// has it, or `frames_later`; all else is as it was.
void record_payload_as_received(const std::string& bag, const Live& live, int frames_later,
                                const std::string& as_received) {
  rosbag::Bag in(bag, rosbag::bagmode::Read), out(as_received, rosbag::bagmode::Write);
  const bool is_known =
      std::any_of(live.begin(), live.end(), [](const auto& entry) { return entry.second.payload_is_known; });
  auto next = live.begin();
  std::optional<double> before_kg;
  for (const rosbag::MessageInstance& message : rosbag::View(in)) {
    ros::Time time = message.getTime();
    if (message.getTopic() == "/payload") {
      const double kg = message.instantiate<std_msgs::Float64>()->data;
      if (is_known || (before_kg && *before_kg != kg)) next = first_with(live, next, kg, is_known);
      ASSERT_NE(next, live.end()) << "no frame has the payload of " << kg << " kg";
      if (is_known || before_kg) {
        auto frame = next;
        for (int i = 0; i < frames_later && std::next(frame) != live.end(); ++i) ++frame;
        time = frame->second.header.stamp;
      }
      before_kg = kg;
    }
    out.write(message.getTopic(), time, message);
  }
}

bool same(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return a == b;
  const double x = std::stod(a), y = std::stod(b);
  return std::abs(x - y) <= 1e-9 + 1e-6 * std::max(std::abs(x), std::abs(y));
}

struct Comparison {
  std::size_t compared = 0, missing = 0, different = 0;
  std::string first;  ///< difference
};

Comparison compare(const std::map<std::int64_t, Row>& expected, const Live& live) {
  Comparison c;
  for (const auto& [stamp_us, row] : expected) {
    // The last frames stay open in the node, which cannot know that the recording has ended.
    if (stamp_us > expected.rbegin()->first - 300000) break;
    const auto found = live.find(stamp_us);
    if (found == live.end()) {
      ++c.missing;
      continue;
    }
    ++c.compared;
    // Refused by one and answered by the other is a difference, whatever else they say.
    c.different +=
        (row.at("status") == "ok") != (found->second.status == softarm_estimator::ArmEstimate::STATUS_OK);
    for (const auto& [column, value] : row_of(found->second)) {
      if (same(row.at(column), value)) continue;
      ++c.different;
      if (c.first.empty())
        c.first = row.at("stamp") + " " + column + ": " + row.at(column) + " offline, " + value + " live";
    }
  }
  return c;
}

TEST(ReplayEqual, TheNodeAndTheProgramAgreeOnTheSameBag) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate trial_10s --out " + dir / "trial.bag").status, 0);
  ros::NodeHandle nh;
  Live live;
  const boost::function<void(const softarm_estimator::ArmEstimate&)> keep =
      [&](const softarm_estimator::ArmEstimate& m) { live[microseconds(m.header.stamp.toSec())] = m; };
  const ros::Subscriber subscriber =
      nh.subscribe<softarm_estimator::ArmEstimate>("/softarm_estimator/estimate", 10000, keep);
  const ros::WallTime patience = ros::WallTime::now() + ros::WallDuration(30.0);
  while (subscriber.getNumPublishers() == 0 && ros::WallTime::now() < patience) {
    ros::WallDuration(0.05).sleep();
    ros::spinOnce();
  }
  ASSERT_GT(subscriber.getNumPublishers(), 0u) << "the node does not publish /softarm_estimator/estimate";

  // The delay lets the node subscribe to what rosbag advertises.
  const std::string play =
      "rosbag play --clock --hz=1000 --quiet --delay=3 " + dir / "trial.bag" + " </dev/null";
  std::future<int> player = std::async(std::launch::async, [&] { return std::system(play.c_str()); });
  while (player.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) ros::spinOnce();
  ASSERT_EQ(player.get(), 0) << play;
  // A busy machine may leave the node behind the bag: until nothing more comes.
  for (std::size_t before = 0; before != live.size();) {
    before = live.size();
    ros::WallDuration(2.0).sleep();
    ros::spinOnce();
  }

  ASSERT_FALSE(live.empty());
  // What the node beside this test was told.
  const auto options = ros::param::param<std::string>("~estimate_options", "");
  const auto arm = ros::param::param<std::string>("~estimate_arm", "online_200mm");
  // A payload that is unknown may have been seen to change a few frames before it was told.
  constexpr int kMostFrames = 24;  // a fifth of a second
  std::filesystem::create_directories(dir / "received");
  Comparison c;
  int later = 0;
  for (; later < kMostFrames; ++later) {
    record_payload_as_received(dir / "trial.bag", live, later, dir / "received/trial.bag");
    if (HasFatalFailure()) return;
    ASSERT_EQ(softarm_program("estimate --force --arm " + arm + " " + options + " " +
                              dir / "received/trial.bag" + " --out " + dir / "out")
                  .status,
              0);
    const std::map<std::int64_t, Row> expected = offline(dir / "out/trial/estimates.csv");
    ASSERT_GT(expected.size(), 1000u);
    const Comparison now = compare(expected, live);
    if (later == 0 || now.different < c.different) c = now;
    if (c.different == 0 || live.rbegin()->second.payload_is_known) break;
  }
  // The node was really told so.
  EXPECT_EQ(options.find("--unknown both") != std::string::npos, live.rbegin()->second.unknown == "both");
  EXPECT_EQ(options.find("--prior on") != std::string::npos, live.rbegin()->second.prior != 0);
  EXPECT_EQ(options.find("--window") != std::string::npos, live.rbegin()->second.window > 0.0);
  RecordProperty("frames_compared", static_cast<int>(c.compared));
  RecordProperty("payload_frames_later", later);
  EXPECT_GT(c.compared, 1000u);
  EXPECT_EQ(c.missing, 0u);
  EXPECT_EQ(c.different, 0u) << "first: " << c.first;
}

}  // namespace
}  // namespace softarm

int main(int argc, char** argv) {
  ros::init(argc, argv, "replay_equal");
  ros::Time::init();
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
