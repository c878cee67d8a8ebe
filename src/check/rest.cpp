// Noise of the tracks, and the stretches in which the arm is at rest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "context.h"
#include "math/statistics.h"
#include "math_of_poses.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// White noise of one number from second differences of evenly spaced samples, taken where the arm moves
/// least: of the estimates of short windows a low one holds.
double white_sd(const std::vector<TrackPose>& poses, double period_s,
                const std::function<std::optional<Eigen::Vector3d>(std::size_t)>& second_difference) {
  constexpr double kWindowS = kPolicy.rest.noise_window_s;
  std::vector<double> windows, current;
  double window_end_s = poses.empty() ? 0.0 : poses.front().t_s + kWindowS;
  const auto close = [&] {
    if (current.size() >= kPolicy.rest.least_steps)
      windows.push_back(math::kSdPerMad * math::median(current) / std::sqrt(6.0));
    current.clear();
  };
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    if (poses[i].t_s > window_end_s && current.size() >= kPolicy.rest.window_steps) {
      close();
      window_end_s = poses[i].t_s + kWindowS;
    }
    const TrackPose &a = poses[i - 1], &b = poses[i], &c = poses[i + 1];
    if (!a.good || !b.good || !c.good) continue;
    const double first = b.t_s - a.t_s, second = c.t_s - b.t_s;
    if (std::abs(first - second) > kPolicy.rest.uneven_steps * period_s ||
        first > kPolicy.rest.longest_step * period_s)
      continue;
    if (const auto d = second_difference(i)) {
      for (int k = 0; k < 3; ++k) current.push_back(std::abs((*d)(k)));
    }
  }
  close();
  return math::quantile(windows, kPolicy.rest.quiet_windows);
}

/// Grows a stretch of stillness from one end. @param still_m by which a mean may wander
/// @param sign +1 from the beginning, -1 from the end
double still_for(const Track& track, double still_m, double from_s, int sign, double duration_s) {
  std::optional<Eigen::Vector3d> reference;
  const double block_s = std::max(kPolicy.rest.block_s, kPolicy.rest.block_periods * track.period_s);
  double still_s = 0.0;
  for (double t = 0.0; t + block_s <= duration_s; t += block_s) {
    const double a = from_s + sign * t, b = from_s + sign * (t + block_s);
    const auto mean = track.mean_position(std::min(a, b), std::max(a, b));
    if (mean) {
      if (!reference) reference = mean;
      const double n = std::max(3.0, block_s / std::max(track.period_s, 1e-4));
      if ((*mean - *reference).norm() > still_m + kPolicy.rest.still_noises * track.white_sd_m / std::sqrt(n))
        break;
    }
    still_s = t + block_s;
  }
  return still_s;
}

double still_for(const Signal& signal, double from_s, int sign, double duration_s) {
  const auto& points = signal.points;
  if (points.empty()) return duration_s;
  const double tolerance = kPolicy.rest.rest_share * signal.range() +
                           kPolicy.rest.rest_noises * signal.noise_sd +
                           (signal.is_measured ? kPolicy.rest.rest_steps * signal.quantum : 0.0);
  std::vector<double> first;
  for (std::size_t i = 0; i < std::min(points.size(), kPolicy.rest.first_values); ++i) {
    first.push_back((sign > 0 ? points[i] : points[points.size() - 1 - i]).value);
  }
  const double reference = signal.is_measured ? math::median(first) : first.front();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ValuePoint& p = sign > 0 ? points[i] : points[points.size() - 1 - i];
    if (std::abs(p.value - reference) > tolerance) return std::max(0.0, sign * (p.t_s - from_s));
  }
  return duration_s;
}

/// What a straight line through numbers over time changes from the first to the last, in each coordinate.
Eigen::Vector3d change_over(const std::vector<double>& t_s, const std::vector<Eigen::Vector3d>& values) {
  if (t_s.size() < 3) return Eigen::Vector3d::Zero();
  double middle = 0.0;
  for (const double t : t_s) middle += t / static_cast<double>(t_s.size());
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  double spread = 0.0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    slope += (t_s[i] - middle) * values[i];
    spread += (t_s[i] - middle) * (t_s[i] - middle);
  }
  return spread > 0.0 ? Eigen::Vector3d(slope / spread * (t_s.back() - t_s.front())) : slope;
}

/// Standard deviation of that change, by white noise.
double error_of_change(double noise, std::size_t values) {
  return noise * std::sqrt(12.0 / std::max(3.0, static_cast<double>(values)));
}

bool drifts(const Context& context, const Track& track, const CheckSpan& span) {
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> places;
  for (const TrackPose& pose : track.poses) {
    if (!pose.good || pose.t_s < span.from_s || pose.t_s > span.to_s) continue;
    t_s.push_back(pose.t_s);
    places.push_back(pose.p);
  }
  return change_over(t_s, places).norm() >
         context.of_length(kPolicy.rest.drift) +
             kPolicy.rest.drift_errors * error_of_change(track.white_sd_m, t_s.size());
}

bool drifts(const Signal& signal, const CheckSpan& span) {
  if (signal.range() == 0.0) return false;
  std::vector<double> t_s;
  std::vector<Eigen::Vector3d> values;
  for (const ValuePoint& p : signal.points) {
    if (p.t_s < span.from_s || p.t_s > span.to_s) continue;
    t_s.push_back(p.t_s);
    values.emplace_back(p.value, 0.0, 0.0);
  }
  const double grain = signal.is_measured ? kPolicy.rest.rest_steps * signal.quantum : 0.0;
  return change_over(t_s, values).norm() >
         std::max(kPolicy.rest.rest_share * signal.range(), grain) +
             kPolicy.rest.drift_errors * error_of_change(signal.noise_sd, t_s.size());
}

/// A slow ramp stays within the noise for a while, and is no rest: what is left of a stretch from one end in
/// which neither the arm nor an input goes on in one direction.
std::optional<CheckSpan> without_drift(const Context& context, CheckSpan span, bool from_begin) {
  while (span.to_s - span.from_s >= kPolicy.rest.least_s) {
    const bool moves =
        std::any_of(context.tracks.begin(), context.tracks.end(),
                    [&](const Track& t) { return !t.is_base() && drifts(context, t, span); }) ||
        std::any_of(context.signals.begin(), context.signals.end(),
                    [&](const Signal& s) { return drifts(s, span); });
    if (!moves) return span;
    const double less_s = kPolicy.rest.shortened * (span.to_s - span.from_s);
    (from_begin ? span.to_s : span.from_s) += from_begin ? -less_s : less_s;
  }
  return std::nullopt;
}

/// The first input that is far above its least value in a stretch. Servos have no value at which nothing
/// drives.
std::string held_in(const Context& context, const std::optional<CheckSpan>& span) {
  if (!span) return "";
  for (const Signal& signal : context.signals) {
    if (signal.input->kind == arm::InputKind::kAngle ||
        signal.range() <= kPolicy.rest.driven_noises * signal.noise_sd)
      continue;
    const auto level = signal.mean(span->from_s, span->to_s);
    const double least = signal.is_pressure() ? kPolicy.inputs.offset_pa : kPolicy.inputs.least_tension_n;
    if (level && *level - signal.least > std::max(kPolicy.rest.held_share * signal.range(), least))
      return signal.input->name;
  }
  return "";
}

/// Notes the stretches of stillness at both ends.
void find_rest(Context& context) {
  context.still_begin.reset();
  context.still_end.reset();
  double begin_s = context.duration_s, end_s = begin_s;
  double first_s = context.duration_s, last_s = 0.0;
  bool has_body = false;
  for (const Track& track : context.tracks) {
    if (track.is_base() || track.poses.size() < kPolicy.rest.least_poses) continue;
    has_body = true;
    first_s = std::min(first_s, track.poses.front().t_s);
    last_s = std::max(last_s, track.poses.back().t_s);
  }
  if (!has_body || last_s - first_s < 2.0 * kPolicy.rest.least_s) return;
  const double length_s = last_s - first_s, still_m = context.of_length(kPolicy.rest.still);
  for (const Track& track : context.tracks) {
    if (track.is_base() || track.poses.size() < kPolicy.rest.least_poses) continue;
    begin_s = std::min(begin_s, still_for(track, still_m, first_s, +1, length_s));
    end_s = std::min(end_s, still_for(track, still_m, last_s, -1, length_s));
  }
  for (const Signal& signal : context.signals) {
    begin_s = std::min(begin_s, still_for(signal, first_s, +1, length_s));
    end_s = std::min(end_s, still_for(signal, last_s, -1, length_s));
  }
  // Where stillness was seen to end, it ended a little before.
  const auto trimmed = [&](double still_s) {
    return still_s < length_s ? still_s - kPolicy.rest.trimmed * still_s : still_s;
  };
  if (begin_s >= kPolicy.rest.least_s)
    context.still_begin = without_drift(context, {first_s, first_s + trimmed(begin_s)}, true);
  if (end_s >= kPolicy.rest.least_s)
    context.still_end = without_drift(context, {last_s - trimmed(end_s), last_s}, false);
  context.held_at_begin = held_in(context, context.still_begin);
  context.held_at_end = held_in(context, context.still_end);
}

void check_rest(Context& context) {
  std::size_t longest = 0;
  for (const Track& track : context.tracks) longest = std::max(longest, track.poses.size());
  if (longest < kPolicy.rest.least_poses) return;
  const auto say = [&](const char* id, const char* verb, const std::string& held, const char* loses) {
    CheckFinding& finding = context.add(
        id, "",
        held.empty()
            ? fmt::format("the trial does not {} at rest: the arm or an input moves within {:g} s", verb,
                          kPolicy.rest.least_s)
            : fmt::format("the trial does not {} at rest: the arm is still, but {} is driven", verb, held));
    finding.remedy = fmt::format("record two seconds of stillness, undriven, there; without it {}", loses);
  };
  const bool rest_begin = context.still_begin && context.held_at_begin.empty(),
             rest_end = context.still_end && context.held_at_end.empty();
  if (!rest_begin) {
    say("no_rest_at_start", "begin", context.held_at_begin,
        "zeros of the inputs, noise and spacing of the rings cannot be seen");
  }
  if (!context.still_end) {
    say("no_rest_at_end", "end", "",
        "drift of zeros and rings that slipped cannot be distinguished from creep");
  }
  const auto total = [](const std::optional<CheckSpan>& s) { return s ? s->to_s - s->from_s : 0.0; };
  if (rest_begin && rest_end) {
    context.add("rest", "",
                fmt::format("at rest for {:.1f} s at the beginning and {:.1f} s at the end",
                            total(context.still_begin), total(context.still_end)));
  }
}

}  // namespace

Check make_track_noise() {
  return {update_noise, {}};
}

Check make_still_spans() {
  return {find_rest, {}};
}

Check make_rest() {
  return {check_rest,
          {{"no_rest_at_start", Severity::kWarning},
           {"no_rest_at_end", Severity::kWarning},
           {"rest", Severity::kInformation}}};
}

void update_noise(Context& context) {
  for (Track& track : context.tracks) {
    const auto& poses = track.poses;
    track.white_sd_m = white_sd(poses, track.period_s, [&](std::size_t i) {
      return std::optional<Eigen::Vector3d>(poses[i + 1].p - 2.0 * poses[i].p + poses[i - 1].p);
    });
    track.white_sd_rad =
        white_sd(poses, track.period_s, [&](std::size_t i) -> std::optional<Eigen::Vector3d> {
          const TrackPose &a = poses[i - 1], &b = poses[i], &c = poses[i + 1];
          if (!a.q || !b.q || !c.q) return std::nullopt;
          return rotation_between(*b.q, *c.q) + rotation_between(*b.q, *a.q);
        });
  }
}

}  // namespace softarm::check
