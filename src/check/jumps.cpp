// Single poses that no arm can reach: ghosts, exchanged markers, quaternion spikes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "context.h"
#include "math/statistics.h"
#include "math_of_poses.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

constexpr int kReach = kPolicy.tracking.neighbours;
constexpr double kReachS = kPolicy.tracking.neighbours_s;

using Offsets = std::vector<double>;

Eigen::Vector3d median_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d result;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> numbers;
    for (const Eigen::Vector3d& p : points) numbers.push_back(p(k));
    // Even numbers of neighbours, the same on both sides: the mean of the two middle ones follows a motion.
    result(k) = math::median(std::move(numbers));
  }
  return result;
}

/// Distance of each pose from the median of its neighbours, those before and those after in equal numbers;
/// less than 0 where they are too few.
void offsets_of(const Track& track, Offsets* distance_m, Offsets* angle_rad) {
  const auto& poses = track.poses;
  const auto n = static_cast<std::ptrdiff_t>(poses.size());
  distance_m->assign(poses.size(), -1.0);
  angle_rad->assign(poses.size(), -1.0);
  std::vector<Eigen::Vector3d> points, turns;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const TrackPose& pose = poses[static_cast<std::size_t>(i)];
    if (!pose.good) continue;
    points.clear();
    turns.clear();
    for (std::ptrdiff_t d = 1; d <= kReach; ++d) {
      if (i - d < 0 || i + d >= n) break;
      const TrackPose &before = poses[static_cast<std::size_t>(i - d)],
                      &after = poses[static_cast<std::size_t>(i + d)];
      if (!before.good || !after.good) break;
      if (pose.t_s - before.t_s > kReachS || after.t_s - pose.t_s > kReachS) break;
      points.push_back(before.p);
      points.push_back(after.p);
      if (pose.q && before.q && after.q) {
        turns.push_back(rotation_between(*pose.q, *before.q));
        turns.push_back(rotation_between(*pose.q, *after.q));
      }
    }
    if (points.size() < kPolicy.tracking.least_neighbours) continue;
    (*distance_m)[static_cast<std::size_t>(i)] = (median_of(points) - pose.p).norm();
    if (turns.size() >= kPolicy.tracking.least_neighbours)
      (*angle_rad)[static_cast<std::size_t>(i)] = median_of(turns).norm();
  }
}

/// Whether a pose goes on smoothly on one side: the far end of a step (a bump, an end of a freeze), no spike.
bool goes_on(const Track& track, std::size_t at, double limit_m) {
  constexpr std::ptrdiff_t kSide = 2 * kReach;
  const auto n = static_cast<std::ptrdiff_t>(track.poses.size());
  const auto here = static_cast<std::ptrdiff_t>(at);
  const TrackPose& pose = track.poses[at];
  std::vector<Eigen::Vector3d> velocities;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(1, here - kSide); k < std::min(n, here + kSide); ++k) {
    const TrackPose &a = track.poses[static_cast<std::size_t>(k - 1)],
                    &b = track.poses[static_cast<std::size_t>(k)];
    velocities.push_back((b.p - a.p) / std::max(b.t_s - a.t_s, 1e-4));
  }
  if (velocities.empty()) return false;
  const Eigen::Vector3d velocity = median_of(velocities);
  for (const std::ptrdiff_t side : {-1, 1}) {
    int near = 0;
    for (std::ptrdiff_t d = 1; d <= kSide; ++d) {
      const std::ptrdiff_t k = here + side * d;
      if (k < 0 || k >= n) continue;
      const TrackPose& other = track.poses[static_cast<std::size_t>(k)];
      if ((other.p - pose.p - (other.t_s - pose.t_s) * velocity).norm() < limit_m) ++near;
    }
    if (near > kReach) return true;
  }
  return false;
}

/// Typical offset about each sample: what the motion makes of it there. Medians of blocks.
Offsets typical(const Track& track, const Offsets& offsets) {
  Offsets result(offsets.size(), 0.0);
  std::vector<double> block;
  std::size_t from = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (offsets[i] >= 0.0) block.push_back(offsets[i]);
    if (i + 1 == offsets.size() ||
        track.poses[i + 1].t_s - track.poses[from].t_s > kPolicy.tracking.usual_s) {
      std::fill(result.begin() + static_cast<std::ptrdiff_t>(from),
                result.begin() + static_cast<std::ptrdiff_t>(i) + 1, math::median(block));
      block.clear();
      from = i + 1;
    }
  }
  return result;
}

void say(Context& context, const Track& track, const std::string& id, const std::vector<double>& times,
         double worst, bool rotation) {
  const double share = static_cast<double>(times.size()) / static_cast<double>(track.poses.size());
  const bool matters = track.is_base() || !rotation || track.body->orientation_usable ||
                       !track.body->section_in_body.translation().isZero();
  const bool serious = matters && (share > kPolicy.tracking.serious_jump_share ||
                                   (track.is_base() && share > kPolicy.tracking.serious_base_share));
  CheckFinding& finding =
      context.add(serious   ? Severity::kSerious
                  : matters ? Severity::kWarning
                            : Severity::kInformation,
                  id, track.name,
                  rotation ? fmt::format("its quaternion spikes by up to {:.0f} deg in {} samples ({:.2f} %)",
                                         worst * 180.0 / M_PI, times.size(), 100.0 * share)
                           : fmt::format("jumps away by up to {:.3g} mm in {} samples ({:.2f} %)",
                                         1e3 * worst, times.size(), 100.0 * share));
  finding.figure = worst;
  finding.unit = rotation ? "rad" : "m";
  finding.spans = spans_of(times, kPolicy.tracking.jump_periods * track.period_s);
  if (rotation && track.is_base()) {
    finding.remedy =
        "the mount does not turn like that: make its marker set less symmetric, or give the base's "
        "attitude as fixed (a CSV layout takes fixed_orientation)";
    finding.setting = fixed_base(context);
  } else if (rotation) {
    finding.remedy = "a less symmetric marker set; where its tangent is not needed do not use it";
    finding.setting = without_orientation(context, track);
  } else {
    finding.remedy =
        "ghosts and exchanged markers: asymmetric marker sets, mask reflections; jumps beyond 1 cm "
        "are left out by the estimator, smaller ones only by robust: true";
  }
}

void check_jumps(Context& context) {
  for (Track& track : context.tracks) {
    Offsets distance, angle;
    offsets_of(track, &distance, &angle);
    const Offsets usual_m = typical(track, distance), usual_rad = typical(track, angle);
    std::vector<double> jumps, spikes;
    double worst_m = 0.0, worst_rad = 0.0;
    for (std::size_t i = 0; i < track.poses.size(); ++i) {
      TrackPose& pose = track.poses[i];
      const double limit_m =
          context.of_length(kPolicy.tracking.jump) + std::max(kPolicy.tracking.jump_noises * track.white_sd_m,
                                                              kPolicy.tracking.jump_motion * usual_m[i]);
      const double limit_rad =
          kPolicy.tracking.jump_rad + std::max(kPolicy.tracking.jump_noises * track.white_sd_rad,
                                               kPolicy.tracking.jump_motion * usual_rad[i]);
      if (pose.good && distance[i] > limit_m && !goes_on(track, i, limit_m)) {
        jumps.push_back(pose.t_s);
        worst_m = std::max(worst_m, distance[i]);
        pose.good = false;
      }
      if (pose.good && angle[i] > limit_rad) {
        spikes.push_back(pose.t_s);
        worst_rad = std::max(worst_rad, angle[i]);
        pose.q.reset();
      }
    }
    if (!jumps.empty()) say(context, track, "jumping_body", jumps, worst_m, false);
    if (!spikes.empty()) say(context, track, "quaternion_spikes", spikes, worst_rad, true);
  }
}

}  // namespace

Check make_jumps() {
  return {check_jumps, {{"jumping_body", {}}, {"quaternion_spikes", {}}}};
}

}  // namespace softarm::check
