// Bodies that are lost.
#include <fmt/format.h>

#include <algorithm>

#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

void say_lost(Context& context, const Track& track, const std::vector<double>& lost, std::size_t frames,
              double period_s) {
  std::vector<CheckSpan> spans = spans_of(lost, kPolicy.tracking.lost_stretch * period_s);
  double longest = 0.0;
  for (const CheckSpan& s : spans) longest = std::max(longest, s.to_s - s.from_s + period_s);
  const double share = static_cast<double>(lost.size()) / static_cast<double>(frames);
  const bool hurts = share > kPolicy.tracking.lost_share ||
                     longest > std::max(kPolicy.tracking.lost_s, kPolicy.tracking.lost_periods * period_s);
  const bool serious =
      share > kPolicy.tracking.serious_lost_share && !(track.is_base() && context.arm.base.hold_last);
  CheckFinding& finding =
      context.add(serious ? Severity::kSerious
                  : hurts ? Severity::kWarning
                          : Severity::kInformation,
                  "lost_body", track.name,
                  fmt::format("lost in {:.1f} % of the frames, for up to {:.2f} s", 100.0 * share, longest));
  finding.figure = share;
  finding.unit = "1";
  if (hurts) finding.spans = std::move(spans);
  finding.remedy = track.is_base() && context.arm.base.hold_last
                       ? "its last pose is held; make sure that the cameras see the mount"
                       : "make sure that the cameras see its markers in every posture: more cameras, larger "
                         "or more markers; an estimate needs enough bodies in each frame";
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
    if (frames.empty() || t - frames.back() > kPolicy.tracking.one_instant * period_s) frames.push_back(t);
  }
  for (const Track& track : context.tracks) {
    if (track.poses.empty()) continue;
    std::vector<double> lost;
    std::size_t at = 0;
    for (const double t : frames) {
      while (at < track.poses.size() && track.poses[at].t_s < t - 0.5 * period_s) ++at;
      if (at == track.poses.size() || track.poses[at].t_s > t + 0.5 * period_s) lost.push_back(t);
    }
    if (!lost.empty()) say_lost(context, track, lost, frames.size(), period_s);
  }
}

}  // namespace

Check make_losses() {
  return {check_losses, {{"lost_body", {}}}};
}

}  // namespace softarm::check
