// The virtual rig in real time: publishes what a laboratory's mocap and controllers would, and, on
// ~truth for reports alone, what really happened.
#include <ros/ros.h>
#include <softarm_estimator/Truth.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <variant>
#include <vector>

#include "rig/receipt_queue.h"
#include "rig/simulator.h"
#include "ros/conversions.h"
#include "ros/master_watch.h"
#include "softarm/rig_messages.h"
#include "softarm/scenario_file.h"

namespace {

using softarm::rig::PayloadSample;
using softarm::rig::Received;
using softarm::rig::Sample;

constexpr std::uint32_t kQueue = 1000;
constexpr double kBehind_s = 0.25;
constexpr double kConnecting_s = 0.5, kLongestConnecting_s = 2.0;  // that subscribers are waited for
constexpr double kLead_s = 0.05;                                   // of the first sample

/// The scenario's path.
std::string find_scenario(const ros::NodeHandle& nh) {
  std::string scenario, directory;
  nh.param<std::string>("scenario", scenario, "");
  nh.param<std::string>("scenarios_dir", directory, "");
  const std::string name = "parameter " + nh.resolveName("scenario");
  if (scenario.empty())
    throw std::runtime_error(name + " is not set: a scenario or arm file, or the name of a shipped scenario");
  std::error_code no_file;
  for (const std::string& candidate : {scenario, directory + "/" + scenario + ".yaml"})
    if (std::filesystem::is_regular_file(candidate, no_file)) return candidate;
  std::set<std::string> shipped;
  std::error_code no_folder;
  for (const auto& entry : std::filesystem::directory_iterator(directory, no_folder)) {
    if (entry.path().extension() == ".yaml") shipped.insert(entry.path().stem().string());
  }
  std::string names;
  for (const std::string& one : shipped) names += (names.empty() ? "" : ", ") + one;
  throw std::runtime_error(name + " is '" + scenario + "': no such file" +
                           (names.empty() ? "" : ", nor a shipped scenario (" + names + ")"));
}

/// Publishes the samples of a rig with stamps counted from an epoch.
class Rig {
 public:
  Rig(ros::NodeHandle nh, ros::NodeHandle private_nh, softarm::app::RigMessages messages)
      : messages_(std::move(messages)) {
    truth_ = private_nh.advertise<softarm_estimator::Truth>("truth", kQueue);
    // Now, not with the first message: subscribers need time to connect.
    for (const softarm::LabMessage& blank : messages_.blank()) {
      const auto advertise = [&](const auto& content) {
        using Message = std::decay_t<decltype(content)>;
        publishers_[blank.topic] = nh.advertise<Message>(blank.topic, kQueue, blank.latched);
      };
      if (publishers_.count(blank.topic) == 0) std::visit(advertise, blank.content);
    }
  }

  /// Stamps count from here.
  void begin(ros::Time epoch) { epoch_ = epoch; }

  /// Some have subscribers and others not yet: a node is connecting to them one by one.
  bool is_being_connected() const {
    std::size_t connected = 0;
    for (const auto& [topic, publisher] : publishers_) connected += publisher.getNumSubscribers() > 0;
    return connected > 0 && connected < publishers_.size();
  }

  void publish(const Received& received) {
    for (const softarm::LabMessage& message :
         messages_.of(received, [this](double t_s) { return stamp(t_s); }))
      std::visit([&](const auto& content) { publishers_[message.topic].publish(content); }, message.content);
  }

  void publish_truth(const Sample& sample) {
    const softarm::rig::Truth& truth = sample.truth;
    softarm_estimator::Truth message;
    message.header.stamp = stamp(sample.stamp_s);
    for (const softarm::rig::SegmentTruth& segment : truth.segments) {
      message.moment.push_back(segment.moment_nm.norm());
      message.direction.push_back(std::atan2(segment.moment_nm.y(), segment.moment_nm.x()));
      message.bending_stiffness.push_back(segment.bending_stiffness_nm2);
      message.length.push_back(segment.length_m);
    }
    message.payload = truth.payload_kg;
    message.payload_steadied = truth.payload_steadied;
    message.tip_angle = truth.tip_angle_rad;
    for (const Eigen::Vector3d& p : truth.backbone_base) message.backbone.push_back(softarm::to_point(p));
    truth_.publish(message);
  }

 private:
  ros::Time stamp(double t_s) const { return epoch_ + ros::Duration(t_s); }

  softarm::app::RigMessages messages_;
  ros::Time epoch_;
  std::map<std::string, ros::Publisher> publishers_;  ///< by topic
  ros::Publisher truth_;
};

/// Publishes what is received by a time, each message then.
void deliver(softarm::rig::ReceiptQueue& queue, double until_s, ros::WallTime start, Rig& rig) {
  while (const std::optional<Received> received = queue.take(until_s)) {
    // What has no stamp holds from when it is received: the first payload must not come after its frame.
    const bool is_first_payload =
        received->receipt_s == 0.0 && std::holds_alternative<PayloadSample>(received->message);
    if (!is_first_payload) ros::WallTime::sleepUntil(start + ros::WallDuration(received->receipt_s));
    if (!ros::ok()) return;
    rig.publish(*received);
  }
}

/// On a loaded machine they connect late, and frames without their payload and inputs are no demonstration.
/// Who starts later, or wants some topics only, is not waited for.
ros::WallTime wait_for_subscribers(const Rig& rig) {
  const ros::WallTime begun = ros::WallTime::now();
  const auto waited_s = [&] { return (ros::WallTime::now() - begun).toSec(); };
  while (ros::ok() &&
         (waited_s() < kConnecting_s || (rig.is_being_connected() && waited_s() < kLongestConnecting_s))) {
    ros::spinOnce();
    ros::WallDuration(0.02).sleep();
  }
  return ros::WallTime::now();
}

void run(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) {
  softarm::app::LoadedScenario loaded = softarm::app::load_scenario(find_scenario(private_nh));
  softarm::rig::Scenario& scenario = loaded.scenario;
  if (private_nh.param("endless", false)) scenario.duration_s = 0.0;
  softarm::rig::Simulator simulator(scenario);
  Rig rig(nh, private_nh, softarm::app::RigMessages(simulator, loaded.arm));
  const softarm::MasterWatch watch(std::vector<ros::ServiceServer>{});
  const ros::WallTime start = wait_for_subscribers(rig) + ros::WallDuration(kLead_s);
  rig.begin(ros::Time(start.sec, start.nsec));
  softarm::rig::ReceiptQueue queue;
  while (ros::ok()) {
    const std::optional<Sample> sample = simulator.next();
    if (!sample) break;
    const ros::WallTime due = start + ros::WallDuration(sample->stamp_s);
    const double behind_s = (ros::WallTime::now() - due).toSec();
    if (behind_s > kBehind_s) ROS_WARN_THROTTLE(5.0, "the simulation is %.2f s behind real time", behind_s);
    queue.add(*sample);
    deliver(queue, sample->stamp_s, start, rig);
    ros::WallTime::sleepUntil(due);
    rig.publish_truth(*sample);
    ros::spinOnce();
  }
  deliver(queue, std::numeric_limits<double>::infinity(), start, rig);
  if (ros::ok()) ROS_INFO("the scenario is over");
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "softarm_rig");
  ros::NodeHandle nh, private_nh("~");
  try {
    run(nh, private_nh);
  } catch (const std::exception& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
