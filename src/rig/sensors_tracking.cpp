#include "sensors_tracking.h"

#include <cmath>

#include "sensors_poses.h"

namespace softarm::rig {

Tracking::Tracking(const Scenario& scenario) : spec_(scenario.sensors) {
  const double frame_s = 1.0 / scenario.mocap.rate_hz;
  const int rings = static_cast<int>(scenario.mocap.ring_fractions.size());
  for (int number = scenario.mocap.base_measured ? 0 : 1; number <= rings; ++number) {
    Body body;
    body.number = number;
    const auto part = static_cast<std::size_t>(number);
    for (std::size_t i = 0; i < spec_.jumps.size(); ++i)
      if (concerns(spec_.jumps[i].body, number))
        body.jumps.push_back({&spec_.jumps[i], stream_of(scenario.seed, SensorPurpose::kJump, i, part)});
    for (std::size_t i = 0; i < spec_.bursts.size(); ++i) {
      const DropoutBursts& burst = spec_.bursts[i];
      if (concerns(burst.body, number))
        body.bursts.push_back({Telegraph(burst.share, burst.mean_length_s, frame_s),
                               stream_of(scenario.seed, SensorPurpose::kBurst, i, part)});
    }
    bodies_.push_back(std::move(body));
  }
}

void Tracking::track(double t_s, const std::vector<Pose>& rings_base,
                     std::vector<std::optional<Pose>>& poses) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    jump(body, poses[i]);
    flip(t_s, body, poses[i]);
    bool lost = is_hidden(body, rings_base);
    for (Bursting& burst : body.bursts) lost = burst.telegraph.next(burst.random) || lost;
    if (lost) poses[i].reset();
    freeze(t_s, body, poses[i]);
  }
  for (const SwappedBodies& swap : spec_.swapped) {
    if (!swap.times.has(t_s)) continue;
    const auto first = static_cast<std::size_t>(swap.first - bodies_[0].number);
    std::swap(poses[first], poses[static_cast<std::size_t>(swap.second - bodies_[0].number)]);
  }
  for (const Gap& gap : spec_.gaps)
    if (gap.stream == MessageStream::kMocap && gap.times.has(t_s)) poses.assign(poses.size(), std::nullopt);
}

void Tracking::jump(Body& body, std::optional<Pose>& pose) const {
  for (Jumping& one : body.jumps) {
    // All numbers are drawn in every frame, also for a body that is lost.
    const bool jumps = one.random.uniform() < one.spec->probability;
    const Eigen::Vector3d where = direction_from(one.random), about = direction_from(one.random);
    if (!jumps || !pose) continue;
    pose->p += one.spec->size_m * where;
    turn_in_body(one.spec->turn_rad * about, *pose);
  }
}

void Tracking::flip(double t_s, const Body& body, std::optional<Pose>& pose) const {
  for (const FlippedBody& flipped : spec_.flipped) {
    if (!pose || !concerns(flipped.body, body.number) || !flipped.times.has(t_s)) continue;
    if (flipped.axis.isZero(0.0))
      pose->q.coeffs() = -pose->q.coeffs();
    else
      pose->q = pose->q * Eigen::Quaterniond(0.0, flipped.axis.x(), flipped.axis.y(), flipped.axis.z());
  }
}

bool Tracking::is_hidden(const Body& body, const std::vector<Pose>& rings_base) const {
  if (body.number == 0) return false;
  const Eigen::Vector3d tangent =
      rings_base[static_cast<std::size_t>(body.number) - 1].q * Eigen::Vector3d::UnitZ();
  const double bent = std::atan2(tangent.head<2>().norm(), tangent.z());
  const double towards = std::atan2(tangent.y(), tangent.x());
  for (const Occlusion& occlusion : spec_.occlusions)
    if (concerns(occlusion.body, body.number) && bent > occlusion.beyond_rad &&
        std::abs(std::remainder(towards - occlusion.towards_rad, 2.0 * M_PI)) <= occlusion.within_rad)
      return true;
  return false;
}

void Tracking::freeze(double t_s, Body& body, std::optional<Pose>& pose) const {
  for (const FrozenBody& frozen : spec_.frozen)
    if (concerns(frozen.body, body.number) && frozen.times.has(t_s) && body.last_seen) pose = body.last_seen;
  if (pose) body.last_seen = pose;
}

}  // namespace softarm::rig
