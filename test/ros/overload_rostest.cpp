// Poses that come faster than the node can answer: it answers the newest, says what it skipped, and its
// latency does not grow. ~rate_hz, ~seconds; ~must_skip: false where a machine that keeps up is fine, and the
// median of the latency is the 20 ms that are promised, whatever else the machine does.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/FluidPressure.h>
#include <softarm_estimator/ArmEstimate.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "math/statistics.h"
#include "rig_trial.h"

namespace softarm {
namespace {

constexpr double kTrialS = 2.0;  // simulated once, and played forwards and backwards
constexpr std::size_t kNoticedWithinS = 2;
constexpr double kPromisedS = 0.02;  // ~overload_latency of the node

/// Latency of each estimate, from the stamp of its poses to its receipt here, and what the node says of
/// itself.
class Ear {
 public:
  explicit Ear(ros::NodeHandle& nh)
      : estimates_(nh.subscribe("/softarm_estimator/estimate", 5000, &Ear::on_estimate, this,
                                ros::TransportHints().tcpNoDelay())),
        diagnostics_(nh.subscribe("/diagnostics", 100, &Ear::on_diagnostics, this)) {}

  std::vector<std::vector<double>> latency_s;  // by second
  std::vector<double> solve_s;
  std::map<std::string, std::string> values;  // of all tasks of the node

  double number(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? 0.0 : std::stod(found->second);
  }

 private:
  void on_estimate(const ros::MessageEvent<softarm_estimator::ArmEstimate const>& event) {
    const softarm_estimator::ArmEstimate& message = *event.getConstMessage();
    if (start_.isZero()) start_ = message.header.stamp;
    const auto second = static_cast<std::size_t>((message.header.stamp - start_).toSec());
    latency_s.resize(std::max(latency_s.size(), second + 1));
    latency_s[second].push_back((event.getReceiptTime() - message.header.stamp).toSec());
    solve_s.push_back(message.solve_time);
  }
  void on_diagnostics(const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
    for (const auto& status : message->status) {
      if (status.name.rfind("softarm_estimator: ", 0) != 0) continue;
      for (const auto& value : status.values) values[value.key] = value.value;
    }
  }

  ros::Subscriber estimates_, diagnostics_;
  ros::Time start_;
};

class Publisher {
 public:
  Publisher(ros::NodeHandle& nh, const RigTrial& trial) : trial_(trial) {
    for (const std::string& body : trial.bodies)
      bodies_.push_back(nh.advertise<geometry_msgs::PoseStamped>("/mocap/" + body + "/pose", 100));
    for (int i = 0; i < 3; ++i) {
      pressures_.push_back(
          nh.advertise<sensor_msgs::FluidPressure>(rig::topic_of(rig::InputKind::kChamber, i), 100));
    }
    payload_ = nh.advertise<std_msgs::Float64>("/payload", 1, true);
    payload_.publish(std_msgs::Float64());
  }
  bool connected() const {
    return std::all_of(bodies_.begin(), bodies_.end(),
                       [](const auto& p) { return p.getNumSubscribers() > 0; });
  }
  void frame(std::uint64_t k, ros::Time stamp) {
    const std::uint64_t last = trial_.samples.size() - 1, step = k % (2 * last);
    const rig::Sample& sample = trial_.samples[std::min(step, 2 * last - step)];
    for (const rig::InputSample& input : sample.inputs) {
      if (input.kind != rig::InputKind::kChamber) continue;
      sensor_msgs::FluidPressure message;
      message.header.stamp = stamp;
      message.fluid_pressure = input.value;
      pressures_[static_cast<std::size_t>(input.number)].publish(message);
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const auto& pose = sample.bodies[i];
      if (!pose) continue;
      bodies_[i].publish(pose_message(*pose, stamp));
    }
  }

 private:
  const RigTrial& trial_;
  std::vector<ros::Publisher> bodies_, pressures_;
  ros::Publisher payload_;
};

/// Says what it was, second by second and in all; from kNoticedWithinS on it is bounded.
void expect_latency(const std::vector<std::vector<double>>& by_second, double most_median_s,
                    double most_90_s) {
  std::vector<double> all;
  for (std::size_t second = 0; second < by_second.size(); ++second) {
    const std::vector<double>& latency = by_second[second];
    std::cout << "second " << second << ": " << latency.size() << " answers, latency median "
              << 1e3 * math::quantile(latency, 0.5) << ", 99 % " << 1e3 * math::quantile(latency, 0.99)
              << ", most " << 1e3 * math::quantile(latency, 1.0) << " ms\n";
    if (second < kNoticedWithinS) continue;
    EXPECT_LT(math::quantile(latency, 0.5), most_median_s);
    EXPECT_LT(math::quantile(latency, 0.9), most_90_s);
    all.insert(all.end(), latency.begin(), latency.end());
  }
  ASSERT_FALSE(all.empty());
  std::cout << "from second " << kNoticedWithinS << " on: latency median " << 1e3 * math::quantile(all, 0.5)
            << ", 99 % " << 1e3 * math::quantile(all, 0.99) << " ms\n";
}

TEST(Overload, TheNewestIsAnsweredAndTheLatencyDoesNotGrow) {
  const double rate_hz = ros::param::param<double>("~rate_hz", 4000.0);
  const double seconds = ros::param::param<double>("~seconds", 8.0);
  const bool must_skip = ros::param::param<bool>("~must_skip", true);
  const RigTrial trial = simulated_trial(kTrialS, rate_hz);
  ros::NodeHandle nh;
  Ear ear(nh);
  Publisher publisher(nh, trial);
  const ros::WallTime patience = ros::WallTime::now() + ros::WallDuration(30.0);
  while (!publisher.connected() && ros::WallTime::now() < patience) ros::WallDuration(0.05).sleep();
  ASSERT_TRUE(publisher.connected()) << "the node did not subscribe";

  ros::AsyncSpinner spinner(1);
  spinner.start();
  const ros::WallTime start = ros::WallTime::now();
  std::uint64_t sent = 0;
  for (; ros::ok(); ++sent) {
    const ros::WallTime due = start + ros::WallDuration(static_cast<double>(sent) / rate_hz);
    const ros::WallDuration early = due - ros::WallTime::now();
    if (early > ros::WallDuration(0.0)) early.sleep();
    if ((due - start).toSec() >= seconds) break;
    publisher.frame(sent, ros::Time::now());
  }
  ros::WallDuration(2.5).sleep();  // the last diagnostics
  spinner.stop();

  const std::uint64_t answers = std::accumulate(
      ear.latency_s.begin(), ear.latency_s.end(), std::uint64_t{0},
      [](std::uint64_t sum, const std::vector<double>& latency) { return sum + latency.size(); });
  const double solve_s = math::quantile(ear.solve_s, 0.5);
  const double skipped = ear.number("frames dropped: overload");
  // It takes a moment to be noticed. Beside other programs a frame takes several times what it would.
  expect_latency(ear.latency_s, kPromisedS + (must_skip ? 10.0 * solve_s : 0.0), 0.06 + 10.0 * solve_s);
  std::cout << sent << " frames sent, " << answers << " answered, " << skipped
            << " skipped, solve time median " << 1e6 * solve_s << " us" << std::endl;
  EXPECT_GT(answers, sent / 10);
  EXPECT_EQ(ear.number("frames received"), ear.number("frames estimated") + ear.number("frames refused") +
                                               ear.number("frames dropped") +
                                               ear.number("frames waiting for bodies"));
  if (!must_skip) return;
  if (skipped == 0.0 && answers + 100 > sent) GTEST_SKIP() << "this machine answers " << rate_hz << " Hz";
  EXPECT_GT(skipped, 0.0);
}

}  // namespace
}  // namespace softarm

int main(int argc, char** argv) {
  ros::init(argc, argv, "overload");
  ros::Time::init();
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
