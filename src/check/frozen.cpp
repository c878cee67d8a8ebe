// Bodies that stand still to the last bit while others move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

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

/// Poses that only repeat the one before.
struct Repeats {
  std::vector<double> frozen;  // times of those that last while others move, or where there is noise else
  std::size_t all = 0;
  double longest_s = 0.0;  // of the frozen
  bool others_move = true;
};

/// Marks the frozen poses.
Repeats repeats_of(Track& track, const std::vector<double>& others) {
  auto& poses = track.poses;
  Repeats repeats;
  for (std::size_t i = 1; i < poses.size(); ++i) repeats.all += same_pose(poses[i - 1], poses[i]);
  for (std::size_t i = 0; i < poses.size();) {
    std::size_t j = i + 1;
    while (j < poses.size() && same_pose(poses[i], poses[j])) ++j;
    const double from = poses[i].t_s, to = poses[j - 1].t_s;
    const auto changed =
        std::upper_bound(others.begin(), others.end(), from + 0.5 * kPolicy.tracking.frozen_s);
    const bool others_move = changed != others.end() && *changed < to;
    // A body that is noisy and else hardly ever repeats itself does not do so by standing still.
    const bool silenced =
        track.white_sd_m > kPolicy.tracking.white_m &&
        static_cast<double>(repeats.all - (j - i - 1)) < kPolicy.tracking.hardly * poses.size();
    if (j - i >= kPolicy.tracking.frozen_samples && to - from >= kPolicy.tracking.frozen_s &&
        (others_move || silenced)) {
      repeats.others_move = repeats.others_move && others_move;
      for (std::size_t k = i + 1; k < j; ++k) {
        poses[k].good = false;
        repeats.frozen.push_back(poses[k].t_s);
      }
      repeats.longest_s = std::max(repeats.longest_s, to - from);
    }
    i = j;
  }
  return repeats;
}

void say_frozen(Context& context, const Track& track, const Repeats& repeats, double share) {
  const bool serious =
      share > kPolicy.tracking.serious_frozen_share || repeats.longest_s > kPolicy.tracking.serious_frozen_s;
  CheckFinding& finding = context.add(
      serious ? Severity::kSerious : Severity::kWarning, "frozen_body", track.name,
      fmt::format("the same pose to the last bit for up to {:.2f} s {} ({:.1f} % of the samples)",
                  repeats.longest_s,
                  repeats.others_move ? "while others move" : "where it otherwise has noise", 100.0 * share));
  finding.figure = repeats.longest_s;
  finding.unit = "s";
  finding.spans = spans_of(repeats.frozen, kPolicy.tracking.frozen_periods * track.period_s);
  finding.remedy =
      "the driver repeats its last value: let it drop lost bodies. Repetitions beyond 0.25 s are "
      "not used";
}

void say_repeated(Context& context, const Track& track, double share) {
  CheckFinding& finding = context.add(
      "repeated_poses", track.name,
      fmt::format("{:.0f} % of the samples only repeat the previous one under a new stamp", 100.0 * share));
  finding.figure = share;
  finding.unit = "1";
  finding.remedy = "the logger is faster than the cameras: log on arrival; a CSV layout can drop them";
  if (context.layout) finding.setting = "mocap.drop_repeated: true (of the layout)";
}

void check_track(Context& context, Track& track) {
  if (track.poses.empty()) return;
  const Repeats repeats = repeats_of(track, changes_of_others(context, track));
  const double all = static_cast<double>(track.poses.size());
  const double repeated = static_cast<double>(repeats.all),
               frozen = static_cast<double>(repeats.frozen.size());
  // A mount without noise (a filtered or a fixed pose) may well repeat itself throughout.
  if (track.is_base() && repeated > kPolicy.tracking.still_mount * all) {
    for (TrackPose& pose : track.poses) pose.good = true;
  } else if (frozen > 0.0) {
    say_frozen(context, track, repeats, frozen / all);
  } else if (repeated > kPolicy.tracking.repeated_share * all) {
    say_repeated(context, track, repeated / all);
  }
}

void check_frozen(Context& context) {
  for (Track& track : context.tracks) check_track(context, track);
}

}  // namespace

Check make_frozen() {
  return {check_frozen,
          {{"frozen_body", {}, Alike::kOnePerEvent},
           {"repeated_poses", Severity::kWarning, Alike::kOnePerDriver}}};
}

}  // namespace softarm::check
