// Orientations that turn over by 180 degrees between samples, and signs of quaternions that alternate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math_of_poses.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

std::string axis_description(const Eigen::Vector3d& axis) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    if (std::abs(axis(k)) > kPolicy.tracking.along_axis) return fmt::format("its {} axis", kNames[k]);
  }
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) of its frame", axis.x(), axis.y(), axis.z());
}

struct Turns {
  std::vector<bool> over;                                    // per pose
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // of the first time: q = true * turn
  std::size_t count = 0, poses = 0;
};

/// Follows the orientation through its leaps: what it was before a leap goes on under it.
Turns follow(const Track& track) {
  Turns turns;
  turns.over.assign(track.poses.size(), false);
  std::optional<Eigen::Quaterniond> truth;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < track.poses.size(); ++i) {
    if (!track.poses[i].q) continue;
    const Eigen::Quaterniond& q = *track.poses[i].q;
    ++turns.poses;
    if (!truth) {
      truth = q;
      continue;
    }
    const double as_is = rotation_between(*truth, q).norm();
    if (as_is < kPolicy.tracking.over_rad) {
      truth = q;
      continue;
    }
    if (turns.count == 0 ||
        rotation_between(*truth, q * turn.conjugate()).norm() > kPolicy.tracking.back_rad) {
      turn = truth->conjugate() * q;
    }
    if (turns.count == 0) turns.turn = turn;
    turns.over[i] = true;
    ++turns.count;
    truth = (q * turn.conjugate()).normalized();
  }
  return turns;
}

/// Removes the turn from the poses that have it.
void turn_back(Track& track, const std::vector<bool>& over) {
  std::optional<Eigen::Quaterniond> last;
  for (std::size_t i = 0; i < track.poses.size(); ++i) {
    auto& q = track.poses[i].q;
    if (!q) continue;
    if (over[i]) {
      q.reset();
      continue;
    }
    last = q;
  }
}

std::size_t sign_changes(const std::vector<trial::RecordedPose>& poses) {
  std::size_t changes = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const auto &a = poses[i - 1].q_mocap, &b = poses[i].q_mocap;
    if (a && b && a->coeffs().dot(b->coeffs()) < -kPolicy.tracking.negative * a->norm() * b->norm())
      ++changes;
  }
  return changes;
}

void check_turned_over(Context& context) {
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    Track& track = context.tracks[b];
    if (const std::size_t changes = sign_changes(context.recording.bodies[b])) {
      context.add(
          "quaternion_sign", track.name,
          fmt::format("its quaternion changes to its negative {} times: the same orientation, harmless",
                      changes));
    }
    Turns turns = follow(track);
    if (turns.count == 0) continue;
    if (2 * turns.count > turns.poses) {
      // What was there first is the exception. The turn the other way round is the same half turn.
      turns.over.flip();
      turns.count = turns.poses - turns.count;
    }
    std::vector<double> times;
    for (std::size_t i = 0; i < track.poses.size(); ++i) {
      if (turns.over[i] && track.poses[i].q) times.push_back(track.poses[i].t_s);
    }
    turn_back(track, turns.over);
    const Eigen::Vector3d turn = math::log_so3(turns.turn);
    const bool matters = track.is_base() || track.body->orientation_usable ||
                         !track.body->section_in_body.translation().isZero();
    const double share = static_cast<double>(turns.count) / static_cast<double>(turns.poses);
    const bool serious = track.is_base() || (matters && share > kPolicy.tracking.serious_over_share);
    const std::vector<CheckSpan> spans = spans_of(times, kPolicy.tracking.over_periods * track.period_s);
    CheckFinding& finding = context.add(
        serious   ? Severity::kSerious
        : matters ? Severity::kWarning
                  : Severity::kInformation,
        "turned_over", track.name,
        fmt::format("its orientation is turned over by {:.0f} deg about {} in {} samples ({:.1f} %)",
                    turn.norm() / kDegree, axis_description(turn.normalized()), times.size(), 100.0 * share));
    finding.figure = turn.norm();
    finding.unit = "rad";
    finding.spans = spans;
    finding.remedy = "a marker set that looks the same from two sides: rearrange it. ";
    if (track.is_base()) {
      finding.remedy += "The mount does not turn: give its attitude as fixed";
      finding.setting = fixed_base(context);
    } else if (matters) {
      finding.remedy += "Do without its orientation, or leave these stretches out";
      finding.setting = without_orientation(context, track);
    } else {
      finding.remedy += "Here its orientation is not used, so it does no harm";
    }
  }
}

}  // namespace

Check make_turned_over() {
  return {check_turned_over, {{"quaternion_sign", Severity::kInformation}, {"turned_over", {}}}};
}

}  // namespace softarm::check
