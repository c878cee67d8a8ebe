#include "sensors_poses.h"

#include <cmath>

#include "backbone_kinematics.h"
#include "capture_space.h"

namespace softarm::rig {
namespace {

constexpr double kStandardGravity = 9.80665;  ///< m/s^2

}  // namespace

void turn_in_body(const Eigen::Vector3d& rotation_vector, Pose& pose) {
  if (!rotation_vector.isZero(0.0)) pose.q = pose.q * Eigen::Quaterniond(rotation_of(rotation_vector));
}

PoseSensors::PoseSensors(const Scenario& scenario)
    : scenario_(scenario), frame_s_(1.0 / scenario.mocap.rate_hz) {
  const SensorSpec& spec = scenario.sensors;
  const int rings = static_cast<int>(scenario.mocap.ring_fractions.size());
  for (int number = scenario.mocap.base_measured ? 0 : 1; number <= rings; ++number) {
    Body body;
    body.number = number;
    const MocapSpec& mocap = scenario.mocap;
    if (number == 0) body.tracked = &mocap.base;
    if (number > 0 && !mocap.rings.empty()) body.tracked = &mocap.rings[static_cast<std::size_t>(number) - 1];
    const auto part = static_cast<std::size_t>(number);
    for (const MarkerSlip& slip : spec.slips)
      if (concerns(slip.body, number)) body.slips.push_back(&slip);
    for (const SkinMarker& skin : spec.skin_markers)
      if (number > 0 && concerns(skin.body, number)) body.skins.push_back(&skin);
    for (std::size_t i = 0; i < spec.biases.size(); ++i) {
      const MarkerBias& bias = spec.biases[i];
      if (!concerns(bias.body, number)) continue;
      RandomStream random = stream_of(scenario.seed, SensorPurpose::kBias, i, part);
      body.bias_m += bias.given_m + bias.drawn.position_sd_m * random.normal3();
      body.bias_turn_rad += bias.drawn.orientation_sd_rad * random.normal3();
    }
    for (const WobblingRing& ring : spec.wobbling)
      if (number > 0 && concerns(ring.body, number)) body.wobbles.push_back({&ring, {}, {}});
    for (std::size_t i = 0; i < spec.correlated_noise.size(); ++i) {
      const CorrelatedNoise& noise = spec.correlated_noise[i];
      if (concerns(noise.body, number))
        body.coloured.push_back({stream_of(scenario.seed, SensorPurpose::kCorrelatedNoise, i, part),
                                 GaussMarkov(noise.sd.position_sd_m, frame_s_, noise.correlation_s),
                                 GaussMarkov(noise.sd.orientation_sd_rad, frame_s_, noise.correlation_s)});
    }
    bodies_.push_back(std::move(body));
  }
}

std::vector<Pose> PoseSensors::observe(double t_s, const std::vector<Pose>& rings_base,
                                       const PoseAt& pose_at) {
  std::vector<Pose> measured;
  const MountSpec& mount = scenario_.mount;
  for (Body& body : bodies_) {
    const Pose base_pose = true_pose(body, t_s, rings_base, pose_at);
    const Pose ring{mount.p_mocap_base + mount.q_mocap_base * base_pose.p, mount.q_mocap_base * base_pose.q};
    Pose pose = ring;
    for (Wobble& one : body.wobbles) wobble(one, ring, pose);
    pose.p += pose.q * body.bias_m;
    turn_in_body(body.bias_turn_rad, pose);
    if (body.tracked) pose = {pose.p + pose.q * body.tracked->p_section, pose.q * body.tracked->q_section};
    see(t_s, pose);
    for (Coloured& noise : body.coloured) {
      pose.p += noise.position.next(noise.random);
      turn_in_body(noise.orientation.next(noise.random), pose);
    }
    measured.push_back(pose);
  }
  return measured;
}

Pose PoseSensors::true_pose(const Body& body, double t_s, const std::vector<Pose>& rings_base,
                            const PoseAt& pose_at) const {
  const std::size_t ring = static_cast<std::size_t>(body.number) - 1;
  const double length_m = scenario_.arm.length_m();
  const double fraction = body.number == 0 ? 0.0 : scenario_.mocap.ring_fractions[ring];
  double along_m = 0.0;
  Eigen::Vector3d sideways_m = Eigen::Vector3d::Zero();
  for (const MarkerSlip* slip : body.slips)
    if (t_s >= slip->from_s) {
      along_m += slip->along_m;
      sideways_m += slip->sideways_m *
                    Eigen::Vector3d(std::cos(slip->direction_rad), std::sin(slip->direction_rad), 0.0);
    }
  Pose pose = body.number == 0 ? Pose{} : rings_base[ring];
  if (body.number == 0) {
    // The base's cluster sits on the clamp, which is rigid.
    pose.p.z() += along_m;
  } else if (along_m != 0.0) {
    const double slid = fraction + along_m / length_m;
    const double on_arm = std::min(std::max(slid, 0.0), 1.0);
    pose = pose_at(on_arm);
    pose.p += pose.q * Eigen::Vector3d(0.0, 0.0, (slid - on_arm) * length_m);
  }
  pose.p += pose.q * sideways_m;
  for (const SkinMarker* skin : body.skins) slide(*skin, fraction, pose_at, pose);
  return pose;
}

void PoseSensors::slide(const SkinMarker& skin, double fraction, const PoseAt& pose_at, Pose& pose) const {
  // The mean curvature about the ring, from how far the sections turn towards each other there.
  constexpr double kSleeve_m = 0.004;
  const double length_m = scenario_.arm.length_m();
  const bool sleeve = skin.form == SkinMarker::Form::kSleeve;
  const double half = 0.5 * (sleeve ? kSleeve_m : skin.patch_m) / length_m;
  const double from = std::max(0.0, fraction - half), to = std::min(1.0, fraction + half);
  const Pose before = pose_at(from), after = pose_at(to);
  const Eigen::AngleAxisd turn(before.q.conjugate() * after.q);
  const Eigen::Vector3d bend = turn.angle() / ((to - from) * length_m) * turn.axis();
  const Eigen::Vector3d inside(bend.y(), -bend.x(), 0.0);
  if (sleeve) {
    const double share = 1.0 / (1.0 + inside.norm() / skin.saturates_per_m);
    pose.p += pose.q * (skin.way_m2 * share * inside);
    turn_in_body(skin.tilt_rad_m * share * Eigen::Vector3d(bend.x(), bend.y(), 0.0), pose);
  } else {
    const double strain = inside.dot(Eigen::Vector3d(std::cos(skin.side_rad), std::sin(skin.side_rad), 0.0));
    pose.p += pose.q * Eigen::Vector3d(0.0, 0.0, skin.way_m2 * strain);
  }
}

void PoseSensors::wobble(Wobble& wobble, const Pose& ring_mocap, Pose& measured) const {
  const Eigen::Vector3d& p = ring_mocap.p;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // at the start the arm is at rest
  if (wobble.last_p.size() == 2)
    acceleration = (p - 2.0 * wobble.last_p[1] + wobble.last_p[0]) / (frame_s_ * frame_s_);
  wobble.last_p.push_back(p);
  if (wobble.last_p.size() > 2) wobble.last_p.erase(wobble.last_p.begin());

  const Eigen::Vector3d tangent = ring_mocap.q * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d apparent_g =
      (Eigen::Vector3d(0.0, 0.0, -scenario_.gravity_m_s2) - acceleration) / kStandardGravity;
  const Eigen::Vector3d across_g = apparent_g - apparent_g.dot(tangent) * tangent;
  const double lag_s = wobble.spec->lag_s;
  if (wobble.across_g && lag_s > 0.0)
    *wobble.across_g += (1.0 - std::exp(-frame_s_ / lag_s)) * (across_g - *wobble.across_g);
  else
    wobble.across_g = across_g;
  measured.p += wobble.spec->shift_m_per_g * *wobble.across_g;
  turn_in_body(measured.q.conjugate() * (wobble.spec->tilt_rad_per_g * tangent.cross(*wobble.across_g)),
               measured);
}

void PoseSensors::see(double t_s, Pose& pose) const {
  for (const BumpedCameras& bump : scenario_.sensors.bumps) {
    if (t_s < bump.from_s) continue;
    const Eigen::Quaterniond turn(rotation_of(bump.turn_rad));
    pose.p = turn * pose.p + bump.shift_m;
    pose.q = turn * pose.q;
  }
  pose.p = measured_at(scenario_.sensors, scenario_.session_s + t_s, pose.p);
}

}  // namespace softarm::rig
