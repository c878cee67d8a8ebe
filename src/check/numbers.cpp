// Samples that are no measurement.
#include <fmt/format.h>

#include <cmath>

#include "context.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

void say_not_numbers(Context& context, const Track& track, const std::vector<trial::RecordedPose>& poses) {
  std::size_t bad = 0, no_rotation = 0, zero = 0;
  for (const trial::RecordedPose& pose : poses) {
    if (!pose.p_mocap.allFinite()) {
      ++bad;
    } else if (pose.p_mocap.squaredNorm() == 0.0) {
      ++zero;
    } else if (!pose.q_mocap || !pose.q_mocap->coeffs().allFinite() ||
               std::abs(pose.q_mocap->norm() - 1.0) > kPolicy.tracking.unit_norm) {
      ++no_rotation;
    }
  }
  const auto share = [&](std::size_t n) {
    return static_cast<double>(n) / static_cast<double>(poses.size());
  };
  if (bad + zero > 0) {
    CheckFinding& finding =
        context.add(share(bad + zero) > kPolicy.tracking.serious_lost_share ? Severity::kSerious
                    : share(bad + zero) > kPolicy.tracking.no_pose_share    ? Severity::kWarning
                                                                            : Severity::kInformation,
                    "no_pose", track.name,
                    fmt::format("{} of {} samples are not a number or all zero: the driver publishes bodies "
                                "even when they are lost",
                                bad + zero, poses.size()));
    finding.figure = share(bad + zero);
    finding.unit = "1";
    finding.remedy =
        "nothing to do: they are not used; if there are many, make sure that the cameras see the markers";
  }
  const bool needed = track.is_base() || track.body->orientation_usable ||
                      !track.body->section_in_body.translation().isZero();
  if (no_rotation > 0) {
    CheckFinding& finding =
        context.add(!needed           ? Severity::kInformation
                    : track.is_base() ? Severity::kSerious
                                      : Severity::kWarning,
                    "no_orientation", track.name,
                    fmt::format("{} of {} samples have no unit quaternion{}", no_rotation, poses.size(),
                                needed ? ", which the arm file relies on" : ""));
    finding.figure = share(no_rotation);
    finding.unit = "1";
    if (needed) finding.remedy = "send a rigid body's pose, not a single marker; or give the base as fixed";
    if (needed) finding.setting = without_orientation(context, track);
  }
}

void check_numbers(Context& context) {
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    if (!context.recording.bodies[b].empty())
      say_not_numbers(context, context.tracks[b], context.recording.bodies[b]);
  }
}

}  // namespace

Check make_numbers() {
  return {check_numbers, {{"no_pose", {}}, {"no_orientation", {}}}};
}

}  // namespace softarm::check
