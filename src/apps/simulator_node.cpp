// The virtual rig in real time: publishes what a laboratory's mocap and controllers would, and, on
// ~truth for reports alone, what really happened.
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/FluidPressure.h>
#include <softarm_estimator/Truth.h>
#include <std_msgs/Float64.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <variant>

#include "rig/receipt_queue.h"
#include "rig/simulator.h"

namespace {

using softarm::rig::InputKind;
using softarm::rig::InputSample;
using softarm::rig::PayloadSample;
using softarm::rig::PoseSample;
using softarm::rig::Received;
using softarm::rig::Sample;

constexpr std::uint32_t kQueue = 1000;
constexpr double kBehind_s = 0.25;

std::string read_scenario(const ros::NodeHandle& nh, std::string& path) {
  std::string scenario, directory;
  nh.param<std::string>("scenario", scenario, "");
  nh.param<std::string>("scenarios_dir", directory, "");
  const std::string name = "parameter " + nh.resolveName("scenario");
  if (scenario.empty())
    throw std::runtime_error(name + " is not set: a scenario file, or the name of a shipped one");
  for (const std::string& candidate : {scenario, directory + "/" + scenario + ".yaml"}) {
    std::ifstream file(candidate);
    std::ostringstream text;
    if (file && text << file.rdbuf()) {
      path = candidate;
      return text.str();
    }
  }
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

geometry_msgs::Point to_point(const Eigen::Vector3d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

/// Publishes the samples of a rig with stamps counted from an epoch.
class Rig {
 public:
  Rig(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const softarm::rig::Simulator& simulator,
      ros::Time epoch)
      : nh_(nh), private_nh_(private_nh), epoch_(epoch) {
    for (const std::string& body : simulator.body_names()) {
      bodies_.push_back(nh_.advertise<geometry_msgs::PoseStamped>("/mocap/" + body + "/pose", kQueue));
    }
    if (simulator.scenario().payload.publish) {
      payload_ = nh_.advertise<std_msgs::Float64>("/payload", 10, true);
    }
    truth_ = private_nh_.advertise<softarm_estimator::Truth>("truth", kQueue);
    // Now, not with the first message: subscribers need time to connect.
    const softarm::rig::Scenario& scenario = simulator.scenario();
    for (int i = 0; i < scenario.arm.chambers; ++i) publisher_of(InputKind::kChamber, i);
    for (int i = 0; i < scenario.arm.tendons; ++i) publisher_of(InputKind::kTendon, i);
    for (int i = 0; i < scenario.arm.servos; ++i) publisher_of(InputKind::kServo, i);
    if (!scenario.vacuum.schedule.empty()) publisher_of(InputKind::kVacuum, 0);
  }

  void publish(const Received& received) {
    std::visit([this](const auto& message) { publish(message); }, received.message);
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
    for (const Eigen::Vector3d& p : truth.backbone_base) message.backbone.push_back(to_point(p));
    truth_.publish(message);
  }

 private:
  ros::Time stamp(double t_s) const { return epoch_ + ros::Duration(t_s); }

  static bool is_pressure(InputKind kind) {
    return kind == InputKind::kChamber || kind == InputKind::kVacuum;
  }

  ros::Publisher& publisher_of(InputKind kind, int number) {
    ros::Publisher& publisher = inputs_[{kind, number}];
    if (!publisher) {
      const std::string topic = softarm::rig::topic_of(kind, number);
      publisher = is_pressure(kind) ? nh_.advertise<sensor_msgs::FluidPressure>(topic, kQueue)
                                    : nh_.advertise<std_msgs::Float64>(topic, kQueue);
    }
    return publisher;
  }

  void publish(const PayloadSample& sample) {
    std_msgs::Float64 message;
    message.data = sample.kg;
    payload_.publish(message);
  }

  void publish(const InputSample& sample) {
    const ros::Publisher& publisher = publisher_of(sample.kind, sample.number);
    if (is_pressure(sample.kind)) {
      sensor_msgs::FluidPressure message;
      message.header.stamp = stamp(sample.stamp_s);
      message.fluid_pressure = sample.value;
      publisher.publish(message);
    } else {
      std_msgs::Float64 message;
      message.data = sample.value;
      publisher.publish(message);
    }
  }

  void publish(const PoseSample& sample) {
    const softarm::rig::Pose& pose = sample.pose;
    geometry_msgs::PoseStamped message;
    message.header.stamp = stamp(sample.stamp_s);
    message.header.frame_id = "mocap";
    message.pose.position = to_point(pose.p);
    message.pose.orientation.w = pose.q.w();
    message.pose.orientation.x = pose.q.x();
    message.pose.orientation.y = pose.q.y();
    message.pose.orientation.z = pose.q.z();
    bodies_[sample.body].publish(message);
  }

  ros::NodeHandle nh_, private_nh_;
  ros::Time epoch_;
  std::vector<ros::Publisher> bodies_;
  std::map<std::pair<InputKind, int>, ros::Publisher> inputs_;
  ros::Publisher payload_, truth_;
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

void run(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) {
  std::string path;
  const std::string text = read_scenario(private_nh, path);
  softarm::rig::Scenario scenario = softarm::rig::parse_scenario(text, path);
  if (private_nh.param("endless", false)) scenario.duration_s = 0.0;
  softarm::rig::Simulator simulator(scenario);
  const ros::WallTime start =
      ros::WallTime::now() + ros::WallDuration(0.5);  // until subscribers are connected
  Rig rig(nh, private_nh, simulator, ros::Time(start.sec, start.nsec));
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
