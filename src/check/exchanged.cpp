// Bodies whose labels are exchanged for a while: continuity says when, the arm's spacing says which way is
// right.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/body_order.h"
#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

struct Pair {
  std::size_t first_at, second_at;  // indices into the tracks' poses of one instant
};

std::vector<Pair> together(const Track& first, const Track& second) {
  std::vector<Pair> pairs;
  const double tolerance_s = kPolicy.tracking.one_instant * std::max(first.period_s, second.period_s);
  std::size_t j = 0;
  for (std::size_t i = 0; i < first.poses.size(); ++i) {
    while (j < second.poses.size() && second.poses[j].t_s < first.poses[i].t_s - tolerance_s) ++j;
    if (j == second.poses.size()) break;
    if (second.poses[j].t_s <= first.poses[i].t_s + tolerance_s) pairs.push_back({i, j});
  }
  return pairs;
}

/// Deviation of the distance between neighbours along the arm from their spacing, at one instant; chords of a
/// bent arm are a little shorter.
double misfit(const Context& context, const std::vector<std::optional<Eigen::Vector3d>>& places) {
  double sum = 0.0;
  const Eigen::Vector3d* last = nullptr;
  double last_s = 0.0;
  for (std::size_t b = 0; b < places.size(); ++b) {
    if (!places[b]) continue;
    if (last) {
      const double spacing = context.tracks[b].arclength_m - last_s;
      const double chord = (*places[b] - *last).norm();
      const double off = chord > spacing ? chord - spacing : arm::kShortChord * (spacing - chord);
      sum += off * off;
    }
    last = &*places[b];
    last_s = context.tracks[b].arclength_m;
  }
  return sum;
}

void exchange(Track& first, Track& second, const std::vector<Pair>& pairs, const std::vector<bool>& which) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!which[k]) continue;
    TrackPose &a = first.poses[pairs[k].first_at], &b = second.poses[pairs[k].second_at];
    std::swap(a.p, b.p);
    std::swap(a.q, b.q);
  }
}

/// For each instant: have the labels changed places, once more or once less than at the beginning?
/// @param least_m two that are nearer cannot be told apart
std::vector<bool> crossings(const Track& first, const Track& second, const std::vector<Pair>& pairs,
                            double least_m, bool* any) {
  std::vector<bool> crossed(pairs.size(), false);
  *any = false;
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    const TrackPose &a = first.poses[pairs[k].first_at], &b = second.poses[pairs[k].second_at];
    const TrackPose &c = first.poses[pairs[k - 1].first_at], &d = second.poses[pairs[k - 1].second_at];
    crossed[k] = crossed[k - 1];
    if (a.t_s - c.t_s > kPolicy.tracking.memory_s) continue;
    const double apart = (c.p - d.p).norm();
    const double stayed = std::min((a.p - c.p).norm(), (b.p - d.p).norm());
    const double changed = std::max((a.p - d.p).norm(), (b.p - c.p).norm());
    if (apart > least_m && changed < kPolicy.tracking.near_share * apart &&
        stayed > kPolicy.tracking.far_share * apart) {
      crossed[k] = !crossed[k];
      *any = true;
    }
  }
  return crossed;
}

/// Whether the labels fit the arm better where they are crossed than where they are not.
bool crossed_is_right(const Context& context, std::size_t i, std::size_t j, const std::vector<Pair>& pairs,
                      const std::vector<bool>& crossed) {
  double when_crossed = 0.0, when_not = 0.0;
  std::size_t n_crossed = 0, n_not = 0;
  for (std::size_t k = 0; k < pairs.size();
       k += std::max<std::size_t>(1, pairs.size() / kPolicy.tracking.most_compared)) {
    std::vector<std::optional<Eigen::Vector3d>> places(context.tracks.size());
    const double t = context.tracks[i].poses[pairs[k].first_at].t_s;
    for (std::size_t b = 0; b < places.size(); ++b) {
      const auto& poses = context.tracks[b].poses;
      const auto at = std::lower_bound(poses.begin(), poses.end(), t - 0.5 * context.tracks[b].period_s,
                                       [](const TrackPose& p, double time) { return p.t_s < time; });
      if (at != poses.end() && at->t_s < t + context.tracks[b].period_s) places[b] = at->p;
    }
    places[i] = context.tracks[i].poses[pairs[k].first_at].p;
    places[j] = context.tracks[j].poses[pairs[k].second_at].p;
    (crossed[k] ? when_crossed : when_not) += misfit(context, places);
    ++(crossed[k] ? n_crossed : n_not);
  }
  if (n_crossed == 0 || n_not == 0) return false;
  return when_crossed / static_cast<double>(n_crossed) < when_not / static_cast<double>(n_not);
}

void check_pair(Context& context, std::size_t i, std::size_t j) {
  Track &first = context.tracks[i], &second = context.tracks[j];
  const std::vector<Pair> pairs = together(first, second);
  bool any = false;
  std::vector<bool> crossed =
      crossings(first, second, pairs, context.of_length(kPolicy.tracking.apart), &any);
  if (!any) return;
  if (crossed_is_right(context, i, j, pairs, crossed)) crossed.flip();
  std::vector<double> times;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (crossed[k]) times.push_back(first.poses[pairs[k].first_at].t_s);
  }
  if (times.empty()) return;
  exchange(first, second, pairs, crossed);
  // Where only one of the two was seen nobody knows which.
  const std::vector<CheckSpan> spans = spans_of(times, kPolicy.tracking.exchanged_periods * first.period_s);
  for (auto [track, is_first] : {std::pair{&first, true}, std::pair{&second, false}}) {
    std::vector<bool> paired(track->poses.size(), false);
    for (const Pair& pair : pairs) paired[is_first ? pair.first_at : pair.second_at] = true;
    for (std::size_t k = 0; k < track->poses.size(); ++k) {
      for (const CheckSpan& span : spans) {
        TrackPose& pose = track->poses[k];
        if (!paired[k] && pose.t_s >= span.from_s && pose.t_s <= span.to_s) pose.good = false;
      }
    }
  }
  const double share = static_cast<double>(times.size()) / static_cast<double>(pairs.size());
  CheckFinding& finding =
      context.add("exchanged_bodies", first.name + ", " + second.name,
                  fmt::format("their labels are exchanged in {:.1f} % of the frames", 100.0 * share));
  finding.figure = share;
  finding.unit = "1";
  finding.spans = spans;
  finding.remedy =
      "give the two marker sets different, asymmetric arrangements; leave these stretches out, or rename the "
      "bodies there. Further checks use the corrected labels";
}

void check_exchanged(Context& context) {
  for (std::size_t i = 0; i < context.tracks.size(); ++i) {
    for (std::size_t j = i + 1; j < context.tracks.size(); ++j) check_pair(context, i, j);
  }
}

}  // namespace

Check make_exchanged() {
  return {check_exchanged, {{"exchanged_bodies", Severity::kSerious}}};
}

}  // namespace softarm::check
