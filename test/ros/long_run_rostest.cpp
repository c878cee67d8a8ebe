// Ten minutes of rig data at 240 Hz through the running node, with faults at random: every frame answered or
// accounted for, no NaN, and no memory that grows. ~rate times real time; 0: as fast as the node answers.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <softarm_estimator/ArmEstimate.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "long_run_feeder.h"
#include "ros/finite.h"

namespace softarm {
namespace {

using testing_long_run::Feeder;
using testing_long_run::kRateHz;

constexpr double kTrialS = 20.0;  // simulated once, at rest at both ends, and repeated
// Frames sent and not yet answered, at most: more than those that may wait for a body (0.25 s), and few
// enough that no topic gets further ahead of another than real ones do.
constexpr std::uint64_t kInFlight = 75;
const char* const kNode = "/softarm_estimator";

/// Resident memory of the node, kB.
long resident_kb() {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = kNode;
  if (!ros::master::execute("lookupNode", request, response, uri, false)) return 0;
  std::string host;
  std::uint32_t port = 0;
  ros::network::splitURI(std::string(uri), host, port);
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue caller, answer;
  caller[0] = ros::this_node::getName();
  if (!client.execute("getPid", caller, answer)) return 0;
  std::ifstream status("/proc/" + std::to_string(static_cast<int>(answer[2])) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

/// What the node says, counted.
class Ear {
 public:
  explicit Ear(ros::NodeHandle& nh) {
    const std::string node = kNode;
    const ros::TransportHints quick = ros::TransportHints().tcpNoDelay();
    subscribers_ = {nh.subscribe(node + "/estimate", 5000, &Ear::on_estimate, this, quick),
                    nh.subscribe(node + "/backbone", 5000, &Ear::check<nav_msgs::Path>, this),
                    nh.subscribe(node + "/markers", 100, &Ear::check<visualization_msgs::MarkerArray>, this),
                    nh.subscribe("/tf", 5000, &Ear::check<tf2_msgs::TFMessage>, this),
                    nh.subscribe("/diagnostics", 100, &Ear::on_diagnostics, this)};
  }

  std::uint64_t estimates = 0, ok = 0, not_finite = 0, out_of_order = 0, diagnostics = 0;
  std::map<std::string, std::string> values;  // of all tasks of the node

  std::uint64_t number(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? 0 : std::stoull(found->second);
  }
  std::uint64_t sum(const std::string& prefix) const {
    std::uint64_t total = 0;
    for (const auto& [key, value] : values) total += key.rfind(prefix, 0) == 0 ? std::stoull(value) : 0;
    return total;
  }

 private:
  template <class Message>
  void check(const boost::shared_ptr<const Message>& message) {
    not_finite += !all_finite(*message);
  }
  void on_estimate(const softarm_estimator::ArmEstimate::ConstPtr& message) {
    check<softarm_estimator::ArmEstimate>(message);
    ++estimates;
    ok += message->status == softarm_estimator::ArmEstimate::STATUS_OK;
    out_of_order += message->header.stamp <= last_;
    last_ = message->header.stamp;
  }
  void on_diagnostics(const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
    for (const auto& status : message->status) {
      if (status.name.rfind("softarm_estimator: ", 0) != 0) continue;
      ++diagnostics;
      for (const auto& value : status.values) values[value.key] = value.value;
    }
  }

  std::vector<ros::Subscriber> subscribers_;
  ros::Time last_;
};

void listen_for(double wall_s) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(wall_s);
  while (ros::WallTime::now() < end && ros::ok()) {
    ros::spinOnce();
    ros::WallDuration(0.005).sleep();
  }
}

TEST(LongRun, NothingIsLostWithoutAReasonAndMemoryIsFlat) {
  const double minutes = ros::param::param<double>("~minutes", 10.0);
  const double rate = ros::param::param<double>("~rate", 0.0);
  const RigTrial trial = simulated_trial(kTrialS, kRateHz);
  ros::NodeHandle nh;
  Ear ear(nh);
  Feeder feeder(nh, trial, ros::Time(ros::WallTime::now().sec, 0), 5);
  const ros::WallTime patience = ros::WallTime::now() + ros::WallDuration(30.0);
  while (!(feeder.connected() && ear.diagnostics > 0) && ros::WallTime::now() < patience) listen_for(0.05);
  ASSERT_TRUE(feeder.connected()) << "the node did not subscribe";

  const auto frames = static_cast<std::uint64_t>(minutes * 60.0 * kRateHz);
  const ros::WallTime start = ros::WallTime::now();
  std::vector<long> memory_kb;
  for (std::uint64_t k = 0; k < frames && ros::ok(); ++k) {
    feeder.frame(k);
    ros::spinOnce();
    const double due_s = rate > 0.0 ? static_cast<double>(k) / kRateHz / rate : 0.0;
    const ros::WallTime stuck = ros::WallTime::now() + ros::WallDuration(2.0);
    // Frames that are dropped for a reason give no answer: they do not count as unanswered for ever.
    while ((ros::WallTime::now() - start).toSec() < due_s ||
           (feeder.sent() > ear.estimates + ear.sum("frames dropped: ") + kInFlight &&
            ros::WallTime::now() < stuck)) {
      ros::WallDuration(0.0005).sleep();
      ros::spinOnce();
    }
    if (k % (frames / 20) == 0) memory_kb.push_back(resident_kb());
  }
  const double spent_s = (ros::WallTime::now() - start).toSec();
  listen_for(3.0);
  memory_kb.push_back(resident_kb());

  // Frames: each is answered by an estimate, dropped for a reason, or still open; none is unknown to the
  // node.
  const std::uint64_t seen = ear.number("frames received"), estimated = ear.number("frames estimated"),
                      refused = ear.number("frames refused"), dropped = ear.number("frames dropped"),
                      open = ear.number("frames waiting for bodies");
  std::uint64_t faults = 0;
  std::ostringstream said;
  for (const auto& [name, count] : feeder.faults()) {
    said << "  sent " << count << " " << name << "\n";
    EXPECT_GT(count, 0u) << name;
    faults += count;
  }
  for (const auto& [key, value] : ear.values) {
    if (key.rfind("rejected", 0) == 0 || key.rfind("frames", 0) == 0 || key.rfind("waited", 0) == 0 ||
        key.rfind("messages", 0) == 0 || key.rfind("samples", 0) == 0)
      said << "  node: " << key << " " << value << "\n";
  }
  said << "  memory (kB):";
  for (long kb : memory_kb) said << " " << kb;
  std::cout << frames << " frames in " << spent_s << " s (" << static_cast<double>(frames) / kRateHz / spent_s
            << " times real time), " << feeder.sent() << " sent, " << seen << " received, " << ear.ok
            << " ok\n"
            << said.str() << std::endl;
  EXPECT_EQ(seen, estimated + refused + dropped + open);
  EXPECT_EQ(ear.estimates, estimated + refused);
  EXPECT_EQ(dropped, ear.sum("frames dropped: "));
  EXPECT_EQ(refused, ear.sum("frames refused: "));
  EXPECT_EQ(ear.number("messages lost on their way"), 0u);
  EXPECT_EQ(ear.number("samples rejected"), ear.sum("rejected: "));
  EXPECT_LE(seen, feeder.sent());
  // Instants of which nothing but a rejected or late sample came never were frames.
  EXPECT_GE(seen + ear.sum("rejected: time_gap") + ear.sum("rejected: late"), feeder.sent());
  EXPECT_LE(open, 100u);
  EXPECT_GT(ear.ok, frames * 95 / 100);
  EXPECT_EQ(ear.out_of_order, 0u);
  EXPECT_EQ(ear.number("time jumps"), 0u);
  EXPECT_EQ(ear.not_finite, 0u);
  EXPECT_EQ(ear.number("messages held back (not finite)"), 0u);
  EXPECT_GT(faults, 1000u * static_cast<std::uint64_t>(std::max(1.0, minutes / 10.0 * 5.0)));
  // What is used depends on how far the listeners lag, and a buffer that grows once is no leak: a leak grows
  // in every quarter of the run. 32 bytes per frame would be more than 1 MB in a quarter of ten minutes.
  ASSERT_GT(memory_kb.back(), 0);
  const auto quarter = static_cast<std::ptrdiff_t>(memory_kb.size() / 4);
  const auto typical_kb = [&](int which) {
    std::vector<long> part(memory_kb.begin() + which * quarter, memory_kb.begin() + (which + 1) * quarter);
    std::nth_element(part.begin(), part.begin() + quarter / 2, part.end());
    return part[static_cast<std::size_t>(quarter / 2)];
  };
  const long growth_kb = std::min(typical_kb(2) - typical_kb(1), typical_kb(3) - typical_kb(2));
  if (std::getenv("SOFTARM_SANITIZE") != nullptr) return;  // a sanitizer keeps what is freed
  EXPECT_LT(growth_kb, 1024);
  EXPECT_LT(memory_kb.back() - typical_kb(1), 8192);
}

}  // namespace
}  // namespace softarm

int main(int argc, char** argv) {
  ros::init(argc, argv, "long_run");
  ros::Time::init();
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
