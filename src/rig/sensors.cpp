#include "sensors.h"

#include <algorithm>

#include "backbone_kinematics.h"

namespace softarm::rig {
namespace {

constexpr std::uint64_t kMocapPurpose = 0x6d6f6361;

}  // namespace

Sensors::Sensors(const Scenario& scenario, const Protocol& protocol)
    : scenario_(scenario), protocol_(protocol), noise_(scenario.seed, kMocapPurpose) {}

void Sensors::observe(Sample& sample) {
  const MocapSpec& mocap = scenario_.mocap;
  if (mocap.base_measured) sample.bodies.push_back(measure(Pose{}, mocap.base_noise));
  for (const Pose& ring : sample.truth.rings_base) sample.bodies.push_back(measure(ring, mocap.ring_noise));
  add_inputs(sample);
  if (scenario_.payload.publish) add_payload(sample);
}

std::optional<Pose> Sensors::measure(const Pose& base_pose, const PoseNoise& sd) {
  // All numbers are drawn even for a lost body: dropouts do not change the noise of the others.
  const bool lost = noise_.uniform() < scenario_.mocap.dropout_probability;
  const Eigen::Vector3d position_noise = sd.position_sd_m * noise_.normal3();
  const Eigen::Vector3d turn = sd.orientation_sd_rad * noise_.normal3();
  if (lost) {
    ++dropouts_;
    return std::nullopt;
  }
  const MountSpec& mount = scenario_.mount;
  Pose measured;
  measured.p = mount.p_mocap_base + mount.q_mocap_base * base_pose.p + position_noise;
  measured.q = (mount.q_mocap_base * base_pose.q * Eigen::Quaterniond(rotation_of(turn))).normalized();
  return measured;
}

template <typename Add>
void Sensors::messages_until(double until_s, const DriveSpec& spec, std::size_t& count,
                             const Add& add) const {
  for (;; ++count) {
    const double stamp_s = static_cast<double>(count) / spec.rate_hz;
    if (stamp_s > until_s) return;
    add(stamp_s, protocol_.at(stamp_s));
  }
}

void Sensors::add_inputs(Sample& sample) {
  std::vector<InputSample>& inputs = sample.inputs;
  const double until_s = sample.stamp_s;
  const auto add_all = [&](double stamp_s, InputKind kind, const std::vector<double>& values, double zero) {
    for (std::size_t i = 0; i < values.size(); ++i)
      inputs.push_back({stamp_s, kind, static_cast<int>(i), zero + values[i]});
  };
  messages_until(until_s, scenario_.pressures, pressure_messages_, [&](double t_s, const Commands& sent) {
    add_all(t_s, InputKind::kChamber, sent.pressures_pa, scenario_.pressures.ambient_pa);
    if (!scenario_.vacuum.schedule.empty())
      inputs.push_back({t_s, InputKind::kVacuum, 0, scenario_.pressures.ambient_pa - sent.vacuum_pa});
  });
  if (scenario_.arm.tendons > 0)
    messages_until(until_s, scenario_.tensions, tension_messages_, [&](double t_s, const Commands& sent) {
      add_all(t_s, InputKind::kTendon, sent.tensions_n, 0.0);
    });
  if (scenario_.arm.servos > 0)
    messages_until(until_s, scenario_.angles, angle_messages_, [&](double t_s, const Commands& sent) {
      add_all(t_s, InputKind::kServo, sent.angles_rad, 0.0);
    });
  std::stable_sort(inputs.begin(), inputs.end(),
                   [](const InputSample& a, const InputSample& b) { return a.stamp_s < b.stamp_s; });
}

void Sensors::add_payload(Sample& sample) {
  const PayloadChange change = protocol_.payload_known_at(sample.stamp_s);
  if (published_kg_ && change.kg == *published_kg_) return;
  sample.payload = PayloadSample{change.t_s, change.kg};
  published_kg_ = change.kg;
}

}  // namespace softarm::rig
