// Samples that are no measurement, bodies that stand still while others move, bodies that are lost.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math_of_poses.h"
#include "policy.h"

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
               std::abs(pose.q_mocap->norm() - 1.0) > 0.1) {
      ++no_rotation;
    }
  }
  const auto share = [&](std::size_t n) {
    return static_cast<double>(n) / static_cast<double>(poses.size());
  };
  if (bad + zero > 0) {
    CheckFinding& finding = context.add(
        share(bad + zero) > 0.1 ? Severity::kWarning : Severity::kInformation, "no_pose", track.name,
        fmt::format(
            "{} of {} samples are not a number or all zero: the driver sends lost bodies all the same",
            bad + zero, poses.size()));
    finding.figure = share(bad + zero);
    finding.unit = "1";
    finding.remedy = "nothing: they are not used; if they are many, see that the cameras see the markers";
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
                                needed ? ", which the arm file counts on" : ""));
    finding.figure = share(no_rotation);
    finding.unit = "1";
    if (needed) finding.remedy = "send a rigid body's pose, not a single marker; or give the base as fixed";
    if (needed && !track.is_base()) finding.setting = "bodies[" + track.name + "].orientation_usable: false";
  }
}

bool same_pose(const TrackPose& a, const TrackPose& b) {
  if (a.p != b.p || a.q.has_value() != b.q.has_value()) return false;
  return !a.q || a.q->coeffs() == b.q->coeffs();
}

/// Times at which any other body's pose changes.
std::vector<double> changes_of_others(const Context& context, const Track& track) {
  std::vector<double> times;
  for (const Track& other : context.tracks) {
    if (&other == &track) continue;
    for (std::size_t i = 1; i < other.poses.size(); ++i) {
      if (!same_pose(other.poses[i - 1], other.poses[i])) times.push_back(other.poses[i].t_s);
    }
  }
  std::sort(times.begin(), times.end());
  return times;
}

void check_frozen(Context& context, Track& track, const std::vector<double>& others) {
  auto& poses = track.poses;
  std::vector<double> frozen;
  std::size_t repeated = 0, all_repeated = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) all_repeated += same_pose(poses[i - 1], poses[i]);
  double longest = 0.0;
  bool alone = true;
  for (std::size_t i = 0; i < poses.size();) {
    std::size_t j = i + 1;
    while (j < poses.size() && same_pose(poses[i], poses[j])) ++j;
    repeated += j - i - 1;
    const double from = poses[i].t_s, to = poses[j - 1].t_s;
    const auto changed =
        std::upper_bound(others.begin(), others.end(), from + 0.5 * kPolicy.tracking.frozen_s);
    const bool others_move = changed != others.end() && *changed < to;
    // A body that is noisy and else hardly ever repeats itself does not do so by standing still.
    const bool silenced =
        track.white_sd_m > kPolicy.tracking.white_m &&
        static_cast<double>(all_repeated - (j - i - 1)) < kPolicy.tracking.hardly * poses.size();
    if (j - i >= kPolicy.tracking.frozen_samples && to - from >= kPolicy.tracking.frozen_s &&
        (others_move || silenced)) {
      alone = alone && others_move;
      for (std::size_t k = i + 1; k < j; ++k) {
        poses[k].good = false;
        frozen.push_back(poses[k].t_s);
      }
      longest = std::max(longest, to - from);
    }
    i = j;
  }
  if (poses.empty()) return;
  const double all = static_cast<double>(poses.size());
  // A mount without noise (a filtered or a fixed pose) may well repeat itself throughout.
  const bool still_mount = track.is_base() && static_cast<double>(repeated) > 0.9 * all;
  if (!frozen.empty() && !still_mount) {
    const double share = static_cast<double>(frozen.size()) / all;
    CheckFinding& finding = context.add(
        share > 0.1 || longest > 2.0 ? Severity::kSerious : Severity::kWarning, "frozen_body", track.name,
        fmt::format("the same pose to the last bit for up to {:.2f} s {} ({:.1f} % of the samples)", longest,
                    alone ? "while others move" : "where it else has noise", 100.0 * share));
    finding.figure = longest;
    finding.unit = "s";
    finding.spans = spans_of(frozen, 3.0 * track.period_s);
    finding.remedy =
        "the driver repeats its last value: let it drop lost bodies. Repetitions beyond 0.25 s are "
        "not used";
  } else if (static_cast<double>(repeated - frozen.size()) > kPolicy.tracking.repeated_share * all &&
             !still_mount) {
    CheckFinding& finding =
        context.add(Severity::kWarning, "repeated_poses", track.name,
                    fmt::format("{:.0f} % of the samples only repeat the one before under a new stamp",
                                100.0 * repeated / all));
    finding.figure = repeated / all;
    finding.unit = "1";
    finding.remedy = "the logger is faster than the cameras: log on arrival; a CSV layout can drop them";
    finding.setting = "mocap.drop_repeated: true (of the layout)";
  }
  if (still_mount) {
    for (TrackPose& pose : poses) pose.good = true;
  }
}

}  // namespace

void check_numbers(Context& context) {
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    if (!context.recording.bodies[b].empty())
      say_not_numbers(context, context.tracks[b], context.recording.bodies[b]);
  }
}

void check_frozen(Context& context) {
  for (Track& track : context.tracks) check_frozen(context, track, changes_of_others(context, track));
}

void check_losses(Context& context) {
  // All instants at which any body reported; a body's own clock may differ by half a period.
  std::vector<double> all;
  double period_s = 0.0;
  for (const Track& track : context.tracks) {
    for (const TrackPose& pose : track.poses) all.push_back(pose.t_s);
    if (track.poses.size() > 1) period_s = std::max(period_s, track.period_s);
  }
  if (period_s <= 0.0) return;
  std::sort(all.begin(), all.end());
  std::vector<double> frames;
  for (const double t : all) {
    if (frames.empty() || t - frames.back() > 0.4 * period_s) frames.push_back(t);
  }
  for (const Track& track : context.tracks) {
    if (track.poses.empty()) continue;
    std::vector<double> lost;
    std::size_t at = 0;
    for (const double t : frames) {
      while (at < track.poses.size() && track.poses[at].t_s < t - 0.5 * period_s) ++at;
      if (at == track.poses.size() || track.poses[at].t_s > t + 0.5 * period_s) lost.push_back(t);
    }
    if (lost.empty()) continue;
    std::vector<CheckSpan> spans = spans_of(lost, 1.5 * period_s);
    double longest = 0.0;
    for (const CheckSpan& s : spans) longest = std::max(longest, s.to_s - s.from_s + period_s);
    const double share = static_cast<double>(lost.size()) / static_cast<double>(frames.size());
    const bool hurts =
        share > kPolicy.tracking.lost_share || longest > std::max(kPolicy.tracking.lost_s, 6.0 * period_s);
    const bool serious = share > 0.3 && !(track.is_base() && context.arm.base.hold_last);
    CheckFinding& finding = context.add(
        serious ? Severity::kSerious
        : hurts ? Severity::kWarning
                : Severity::kInformation,
        "lost_body", track.name,
        fmt::format("lost in {:.1f} % of the frames, for up to {:.2f} s", 100.0 * share, longest));
    finding.figure = share;
    finding.unit = "1";
    if (hurts) finding.spans = std::move(spans);
    finding.remedy = track.is_base() && context.arm.base.hold_last
                         ? "its last pose is held; see that the cameras see the mount"
                         : "see that the cameras see its markers in every posture: more cameras, larger or "
                           "more markers; an estimate needs enough bodies in each frame";
  }
}

}  // namespace softarm::check
