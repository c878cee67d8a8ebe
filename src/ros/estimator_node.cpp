#include "estimator_node.h"

#include <ros/callback_queue.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "input_topics.h"
#include "markers.h"
#include "master_watch.h"
#include "mismatch_message.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

constexpr std::uint32_t kPublisherQueue = 1000;
// More messages, or more time by their stamps, at once than come in a few milliseconds: the machine was busy
// elsewhere. Well below what frames wait for a body.
constexpr std::uint64_t kHiccupMessages = 100;
constexpr double kHiccup_s = 0.1;
constexpr double kHiccupOfStream_s =
    0.05;  // of a stream of thousands of messages a second, as many as come in that
constexpr double kHiccupGrace_s = 0.02;
// A body or an input that has been on time until now is given up so long after it was missed: once, not by
// frame.
constexpr double kGiveUp_s = 0.2;
constexpr int kHiccupRounds = 8;  // a stream that never pauses is worked off as it comes
constexpr double kIdle_s = 0.1;

trial::FrameAssembler::Params assembler_params() {
  trial::FrameAssembler::Params params;
  params.close_when_taken = true;
  return params;
}

}  // namespace

EstimatorNode::EstimatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                             const NodeParams& params)
    : nh_(nh),
      private_nh_(private_nh),
      params_(params),
      estimator_(params.arm, params.options, params.effects),
      assembler_(params.arm, assembler_params()),
      overload_(params.overload_latency_s),
      base_in_mocap_(params.arm.base.fixed_pose),
      updater_(nh_, private_nh_, ros::this_node::getName()) {
  for (const arm::MeasuredBody& body : params_.arm.bodies) body_names_.push_back(body.name);
  if (const std::string note = estimate::advice(params.options); !note.empty()) ROS_WARN("%s", note.c_str());
  for (const std::string& note : estimator_.effect_notes()) ROS_INFO("effects: %s", note.c_str());
  if (params_.monitor) {
    monitor_.emplace(params_.arm, params_.alarm);
    monitor_->set_unknown(params_.options.unknown);
    mismatch_publisher_ = private_nh_.advertise<softarm_estimator::Mismatch>("mismatch", kPublisherQueue);
  }

  estimate_publisher_ = private_nh_.advertise<softarm_estimator::ArmEstimate>("estimate", kPublisherQueue);
  markers_publisher_ = private_nh_.advertise<visualization_msgs::MarkerArray>("markers", 10);
  path_publisher_ = private_nh_.advertise<nav_msgs::Path>("backbone", kPublisherQueue);
  services_.push_back(private_nh_.advertiseService("reset", &EstimatorNode::on_reset, this));
  services_.push_back(private_nh_.advertiseService("set_payload", &EstimatorNode::on_set_payload, this));
  services_.push_back(private_nh_.advertiseService("set_mode", &EstimatorNode::on_set_mode, this));

  updater_.setHardwareID(params_.arm.name);
  updater_.add("frames", this, &EstimatorNode::diagnose_frames);
  updater_.add("inputs", this, &EstimatorNode::diagnose_inputs);
  updater_.add("fit", this, &EstimatorNode::diagnose_fit);
  updater_.add("mismatch", this, &EstimatorNode::diagnose_mismatch);
  period_start_ = second_start_ = ros::SteadyTime::now();
  // Wall time: diagnostics must also come when simulated time stands still.
  diagnostics_timer_ = nh_.createWallTimer(ros::WallDuration(1.0),
                                           [this](const ros::WallTimerEvent&) { on_diagnostics_timer(); });

  for (InputTopic& input : input_topics(params_.arm)) {
    sources_.push_back(std::make_unique<Source>());
    Source& source = *sources_.back();
    source.input = std::move(input);
    source.subscriber = source.input.subscribe(
        nh_, assembler_, [this, &source](const std_msgs::Header* header, const std::string& publisher) {
          on_message(source, header, publisher);
        });
  }
}

void EstimatorNode::spin() {
  const MasterWatch watch(services_);
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kIdle_s));
    drain();
    process();
  }
}

bool EstimatorNode::is_hiccup(std::uint64_t messages) {
  const double elapsed_s = (ros::SteadyTime::now() - second_start_).toSec();
  messages_of_second_ += messages;
  if (elapsed_s >= 1.0) {
    messages_per_s_ = static_cast<double>(std::exchange(messages_of_second_, 0)) / elapsed_s;
    second_start_ = ros::SteadyTime::now();
  }
  const std::optional<double> before_s = std::exchange(drained_to_s_, assembler_.newest_s());
  const bool leapt = drained_to_s_ && !(before_s && std::abs(*drained_to_s_ - *before_s) < kHiccup_s);
  const bool many =
      messages >= kHiccupMessages && static_cast<double>(messages) >= kHiccupOfStream_s * messages_per_s_;
  // A node that cannot keep up has no time to give.
  return (leapt || many) && !overload_.lasts();
}

void EstimatorNode::drain() {
  // roscpp's network thread reads one socket after the other, and this one runs beside it: what came first
  // may be decoded last. Where much has piled up, and where a stream begins, it gets the time to read them
  // all: a frame must not be closed in vain while its bodies wait in a socket.
  ros::CallbackQueue& queue = *ros::getGlobalCallbackQueue();
  const ros::SteadyTime give_up = ros::SteadyTime::now() + ros::WallDuration(kGiveUp_s);
  for (int round = 0; ros::ok(); ++round) {
    const bool hiccup = is_hiccup(std::exchange(messages_, 0));
    const bool in_vain = !overload_.lasts() && assembler_.gives_up() && ros::SteadyTime::now() < give_up;
    if (!in_vain && (round >= kHiccupRounds || (!hiccup && queue.isEmpty()))) return;
    queue.callAvailable(ros::WallDuration(hiccup || in_vain ? kHiccupGrace_s : 0.0));
  }
}

void EstimatorNode::on_message(Source& source, const std_msgs::Header* header, const std::string& publisher) {
  ++source.messages;
  ++messages_;
  const auto sequence = header ? std::optional<std::uint32_t>(header->seq) : std::nullopt;
  const std::uint32_t lost = source.publishers.add(publisher, sequence);
  if (lost > 0) statistics_.lost[source.input.topic] += lost;
  if (source.said_two) return;
  if (const std::optional<std::string> two = source.two_publishers()) {
    source.said_two = true;
    ROS_WARN("two publishers on %s: %s: their messages are mixed, stop one of them",
             nh_.resolveName(source.input.topic).c_str(), two->c_str());
  }
}

void EstimatorNode::process() {
  answer(assembler_.take_before_jump());
  if (assembler_.take_time_jump()) {
    ROS_WARN("time went back: starting afresh");
    estimator_.reset();
    if (monitor_) monitor_->reset();
    last_marker_s_.reset();
  }
  answer(assembler_.take());
}

void EstimatorNode::answer(std::vector<trial::Frame> frames) {
  const auto seconds = [start = std::chrono::steady_clock::now()] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const std::size_t stride = overload_.stride(frames.size(), ros::SteadyTime::now().toSec());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if ((frames.size() - 1 - i) % stride == 0) {
      const double before_s = seconds();
      handle(frames[i]);
      overload_.took(seconds() - before_s);
      continue;
    }
    // What came of the inputs still counts for what remembers them.
    std::vector<trial::InputSample>& samples = frames[i].samples;
    samples.insert(samples.end(), frames[i + 1].samples.begin(), frames[i + 1].samples.end());
    frames[i + 1].samples = std::move(samples);
    ++statistics_.dropped["overload"];
  }
}

void EstimatorNode::handle(const trial::Frame& frame) {
  payload_kg_ = frame.payload_kg;
  const auto start = std::chrono::steady_clock::now();
  const estimate::Estimate* estimate = nullptr;
  try {
    estimate = &estimator_.estimate(frame);
  } catch (const std::exception& e) {
    // One frame's trouble must not end the node; it is counted and said.
    ROS_ERROR_THROTTLE(1.0, "frame dropped, internal error: %s", e.what());
    ++statistics_.dropped["internal_error"];
    estimator_.reset();
    return;
  }
  const std::chrono::duration<double> solve_time = std::chrono::steady_clock::now() - start;
  // First: what is drawn of this frame has its mismatch in it.
  const bool alarm_changed = watch(frame);
  publish(*estimate, frame, solve_time.count());
  if (alarm_changed) on_diagnostics_timer();  // at once: half a second counts
}

void EstimatorNode::publish(const estimate::Estimate& estimate, const trial::Frame& frame,
                            double solve_time_s) {
  const MessageContext context{params_.arm, estimator_.options(), params_.frames,
                               nearest_time(frame.stamp_ns)};
  const double stamp_s = frame.stamp_s();
  if (!publish_finite(estimate_publisher_, to_message(estimate, context, solve_time_s))) {
    ++statistics_.dropped["not_finite"];
    estimator_.reset();  // whatever led here must not warm-start the next frame
    return;
  }
  statistics_.add(estimate, seconds_since(frame.stamp_ns, ros::Time::now()), solve_time_s, body_names_);

  const bool ok = estimate.status == estimate::Status::kOk && !estimate.backbone.empty();
  if (ok) base_in_mocap_ = estimate.base_in_mocap;
  if (ok && params_.publish_tf) {
    tf2_msgs::TFMessage transforms;
    transforms.transforms = to_transforms(estimate, context);
    if (all_finite(transforms)) {
      tf_.sendTransform(transforms.transforms);
    } else {
      ++statistics_.not_finite_messages;
    }
  }
  if (ok && path_publisher_.getNumSubscribers() > 0)
    publish_finite(path_publisher_, to_path(estimate, context));
  const bool due = !last_marker_s_ || std::abs(stamp_s - *last_marker_s_) * params_.marker_rate_hz >= 0.999;
  if (params_.marker_rate_hz > 0.0 && due && markers_publisher_.getNumSubscribers() > 0) {
    last_marker_s_ = stamp_s;
    visualization_msgs::MarkerArray markers = to_markers(estimate, context);
    if (ok && mismatch_) {
      for (visualization_msgs::Marker& m : to_markers(*mismatch_, estimate, context).markers)
        markers.markers.push_back(std::move(m));
    }
    publish_finite(markers_publisher_, markers);
  }
}

bool EstimatorNode::on_reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  process();
  assembler_.reset();
  estimator_.reset();
  if (monitor_) monitor_->reset();
  last_marker_s_.reset();
  response.success = true;
  response.message = "forgot all frames; the payload and the mode stay";
  return true;
}

bool EstimatorNode::on_set_payload(softarm_estimator::SetPayload::Request& request,
                                   softarm_estimator::SetPayload::Response& response) {
  const arm::Range& range = params_.arm.payload.range_kg;
  if (!request.unknown && !(request.payload >= range.low && request.payload <= range.high)) {
    response.success = false;
    response.message = "payload " + std::to_string(request.payload) + " kg is outside of the arm's range [" +
                       std::to_string(range.low) + ", " + std::to_string(range.high) + "] kg";
    return true;
  }
  assembler_.add_payload(headerless_stamp(to_stamp(ros::Time::now()), assembler_),
                         request.unknown ? std::nullopt : std::optional(request.payload));
  response.success = true;
  response.message = request.unknown ? "the payload is unknown" : "the payload is known";
  if (estimator_.options().unknown != arm::Unknown::kStiffness) {
    response.message += "; it is not used while the payload is what is estimated (see set_mode)";
  }
  return true;
}

bool EstimatorNode::on_set_mode(softarm_estimator::SetMode::Request& request,
                                softarm_estimator::SetMode::Response& response) {
  try {
    arm::EstimatorOptions wanted = estimator_.options();
    wanted.unknown = arm::parse_unknown(request.unknown);
    if (const std::string why = estimate::advice(wanted); !why.empty())
      throw std::invalid_argument("unknown stays " + to_string(estimator_.options().unknown) + ": " + why +
                                  " (prior:=true of the launch file, or estimator.prior of the arm file)");
    estimator_.set_unknown(wanted.unknown);
    if (monitor_) monitor_->set_unknown(estimator_.options().unknown);
    response.success = true;
    response.message = "unknown is " + to_string(estimator_.options().unknown);
  } catch (const std::invalid_argument& e) {
    response.success = false;
    response.message = e.what();
  }
  return true;
}

}  // namespace softarm
