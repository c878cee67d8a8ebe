#include "sensors.h"

#include <algorithm>

#include "backbone_kinematics.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kMocapPurpose = 0x6d6f6361;

}  // namespace

Sensors::Sensors(const Scenario& scenario, const Protocol& protocol)
    : scenario_(scenario),
      protocol_(protocol),
      noise_(scenario.seed, kMocapPurpose),
      duplicates_(stream_of(scenario.seed, SensorPurpose::kDuplicate)),
      poses_(scenario),
      tracking_(scenario),
      mocap_clock_(scenario, MessageStream::kMocap, 0),
      inputs_(scenario, protocol) {}

void Sensors::observe(const PoseAt& pose_at, Sample& sample) {
  const MocapSpec& mocap = scenario_.mocap;
  const std::vector<Pose>& rings = sample.truth.rings_base;
  for (const Pose& pose : poses_.observe(sample.stamp_s, rings, pose_at)) {
    const bool is_base = mocap.base_measured && sample.bodies.empty();
    sample.bodies.push_back(with_noise(pose, is_base ? mocap.base_noise : mocap.ring_noise));
  }
  tracking_.track(sample.stamp_s, rings, sample.bodies);
  dropouts_ += static_cast<std::size_t>(std::count(sample.bodies.begin(), sample.bodies.end(), std::nullopt));
  const Timing timing = mocap_clock_.time(sample.stamp_s);
  sample.mocap_stamp_s = timing.stamp_s;
  sample.mocap_receipt_s = timing.receipt_s;
  if (duplicates_.uniform() < scenario_.sensors.duplicate_probability) sample.mocap_copies = 2;
  sample.inputs = inputs_.messages_until(sample.stamp_s);
  if (scenario_.payload.publish) add_payload(sample);
}

std::optional<Pose> Sensors::with_noise(Pose pose, const PoseNoise& sd) {
  // All numbers are drawn even for a lost body: dropouts do not change the noise of the others.
  const bool lost = noise_.uniform() < scenario_.mocap.dropout_probability;
  pose.p += sd.position_sd_m * noise_.normal3();
  const Eigen::Vector3d turn = sd.orientation_sd_rad * noise_.normal3();
  if (lost) return std::nullopt;
  pose.q = (pose.q * Eigen::Quaterniond(rotation_of(turn))).normalized();
  return pose;
}

void Sensors::add_payload(Sample& sample) {
  const PayloadChange change = protocol_.payload_known_at(sample.stamp_s);
  if (published_kg_ && change.kg == *published_kg_) return;
  sample.payload = PayloadSample{change.t_s, change.kg};
  published_kg_ = change.kg;
}

}  // namespace softarm::rig
