// Stamps: rates, gaps, irregularity, repetitions, steps of the clock.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

struct Stream {
  std::string name;
  bool is_body = false, is_base = false;
  double max_age_s = 0.0;       // a longer gap leaves frames without it
  std::vector<double> stamp_s;  // in order of receipt, zero stamps left out
  std::vector<double> receipt_s;
  std::size_t zero_stamps = 0, samples = 0;
};

template <typename Samples>
Stream stream_of(const std::string& name, const Samples& samples) {
  Stream stream;
  stream.name = name;
  stream.samples = samples.size();
  for (const auto& s : samples) {
    if (!(s.stamp_s > 0.0) || !std::isfinite(s.stamp_s)) {
      ++stream.zero_stamps;
      continue;
    }
    stream.stamp_s.push_back(s.stamp_s);
    stream.receipt_s.push_back(s.receipt_s);
  }
  return stream;
}

void say_zero_stamps(Context& context, const Stream& stream) {
  if (stream.zero_stamps == 0) return;
  CheckFinding& finding = context.add(
      stream.is_body ? Severity::kSerious : Severity::kWarning, "zero_stamps", stream.name,
      fmt::format("{} of {} samples have no stamp: they cannot be used", stream.zero_stamps, stream.samples));
  finding.figure = static_cast<double>(stream.zero_stamps) / static_cast<double>(stream.samples);
  finding.unit = "1";
  finding.remedy =
      "let the driver stamp its messages (ros::Time::now() where it has no clock of its own; "
      "use_sim_time needs a /clock)";
}

void say_backward(Context& context, const Stream& stream) {
  std::vector<double> duplicates, late, jumps;
  double newest = stream.stamp_s.empty() ? 0.0 : stream.stamp_s.front(), worst = 0.0;
  for (std::size_t i = 1; i < stream.stamp_s.size(); ++i) {
    const double step = stream.stamp_s[i] - newest, t = stream.receipt_s[i] - context.begin_s;
    if (step == 0.0) duplicates.push_back(t);
    if (step < 0.0 && step >= -kPolicy.timing.jump_s) late.push_back(t);
    const bool leaps =
        std::abs(step) > kPolicy.timing.jump_s &&
        std::abs(step - (stream.receipt_s[i] - stream.receipt_s[i - 1])) > kPolicy.timing.jump_s;
    if (leaps) {
      jumps.push_back(t);
      if (std::abs(step) > std::abs(worst)) worst = step;
    }
    newest = leaps ? stream.stamp_s[i] : std::max(newest, stream.stamp_s[i]);
  }
  const double all = static_cast<double>(std::max<std::size_t>(1, stream.samples));
  if (static_cast<double>(duplicates.size()) >
      std::max(kPolicy.timing.few_duplicates, kPolicy.timing.duplicate_share * all)) {
    CheckFinding& finding =
        context.add("duplicates", stream.name,
                    fmt::format("{} of {} samples have the stamp of the one before ({:.1f} %)",
                                duplicates.size(), stream.samples, 100.0 * duplicates.size() / all));
    finding.figure = duplicates.size() / all;
    finding.unit = "1";
    finding.spans = spans_of(duplicates, kPolicy.timing.one_stretch_s);
    finding.remedy = "only the first is used; look for two drivers or a relay on one topic";
  }
  if (late.size() > kPolicy.timing.few_late) {
    CheckFinding& finding = context.add(
        "out_of_order", stream.name,
        fmt::format("{} of {} samples are older than one that came before", late.size(), stream.samples));
    finding.figure = late.size() / all;
    finding.unit = "1";
    finding.spans = spans_of(late, kPolicy.timing.one_stretch_s);
    finding.remedy = "one publisher per topic, over TCP; two machines that stamp need one clock (chrony)";
  }
  if (!jumps.empty()) {
    CheckFinding& finding =
        context.add(stream.is_body ? Severity::kSerious : Severity::kWarning, "time_jump", stream.name,
                    fmt::format("the stamps jump {} time{}, by up to {:+.3g} s, while messages keep arriving",
                                jumps.size(), jumps.size() == 1 ? "" : "s", worst));
    finding.figure = worst;
    finding.unit = "s";
    finding.spans = spans_of(jumps, kPolicy.timing.one_stretch_s);
    finding.remedy =
        "cut the recording there (rosbag filter), and keep the clock from being set during a "
        "trial (chrony makestep off; no restart of the mocap software)";
  }
}

void say_regularity(Context& context, const Stream& stream, double period_s) {
  std::vector<double> sorted = stream.stamp_s, steps;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double step = sorted[i] - sorted[i - 1];
    if (step > 0.0) steps.push_back(step);
  }
  if (steps.size() < kPolicy.timing.least_steps) return;
  // Only single steps show irregularity; lost frames make multiples.
  std::vector<double> single;
  for (const double step : steps) {
    if (step < kPolicy.timing.single_step * period_s) single.push_back(step);
  }
  const double spread_s = std::max(math::robust_sd(single),
                                   0.25 * (math::quantile(single, 0.975) - math::quantile(single, 0.025)));
  const double long_share = 1.0 - static_cast<double>(single.size()) / static_cast<double>(steps.size());
  const bool very = spread_s > kPolicy.timing.very_irregular_share * period_s;
  const double share = stream.is_body ? kPolicy.timing.irregular_share : kPolicy.timing.irregular_input_share;
  if (spread_s > std::max(share * period_s, kPolicy.timing.irregular_s)) {
    CheckFinding& finding = context.add(
        stream.is_body ? Severity::kWarning : Severity::kInformation, "irregular_stamps", stream.name,
        fmt::format("steps between stamps scatter by {:.2g} ms about {:.3g} ms ({:.0f} % are over one and a "
                    "half times that, the longest {:.2g} s)",
                    1e3 * spread_s, 1e3 * period_s, 100.0 * long_share,
                    *std::max_element(steps.begin(), steps.end())));
    finding.figure = spread_s;
    finding.unit = "s";
    finding.remedy =
        !stream.is_body ? "publish on a timer, and stamp when the value is read"
        : very ? "let the driver stamp by the cameras' frame number or exposure, not by receipt or by the "
                 "logger's loop; slow motions (quasi-static trials) suffer little"
               : "stamps by exposure instead of receipt";
  }
  if (1.0 / period_s < kPolicy.timing.slow_hz && stream.is_body) {
    CheckFinding& finding = context.add(
        "low_rate", stream.name,
        fmt::format("{:.3g} Hz: motions faster than a tenth of that are not followed", 1.0 / period_s));
    finding.figure = 1.0 / period_s;
    finding.unit = "Hz";
    finding.remedy = "stream the mocap at 50 Hz or more";
  }
}

/// @param epoch_s what the stream's clock is ahead of receipt altogether
void say_gaps(Context& context, const Stream& stream, double period_s, double epoch_s) {
  // A gap of one body alone is a lost body (check_losses); this one is of the stamps of its whole stream.
  std::vector<double> sorted = stream.stamp_s;
  if (sorted.empty()) return;
  for (double& stamp_s : sorted) stamp_s -= epoch_s;
  std::sort(sorted.begin(), sorted.end());
  const double last_s = sorted.back(), end_s = context.begin_s + context.duration_s;
  sorted.insert(sorted.begin(), std::min(context.begin_s, sorted.front()));
  sorted.push_back(std::max(end_s, sorted.back()));
  std::vector<CheckSpan> gaps;
  double longest = 0.0, total = 0.0;
  const double limit_s = std::max(stream.max_age_s, kPolicy.timing.gap_periods * period_s);
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double step = sorted[i] - sorted[i - 1];
    if (!(step > limit_s)) continue;
    if (context.is_left_out(sorted[i - 1] - context.begin_s, sorted[i] - context.begin_s)) continue;
    gaps.push_back({sorted[i - 1] - context.begin_s, sorted[i] - context.begin_s});
    longest = std::max(longest, step);
    total += step;
  }
  if (gaps.empty()) return;
  CheckFinding& finding = context.add(
      stream.is_body && total > kPolicy.timing.serious_gap_share * context.duration_s ? Severity::kSerious
                                                                                      : Severity::kWarning,
      "gap", stream.name,
      fmt::format("nothing for up to {:.2f} s ({} gap{}, {:.1f} s in all){}", longest, gaps.size(),
                  gaps.size() == 1 ? "" : "s", total,
                  end_s - last_s > limit_s ? "; it ends before the others" : ""));
  finding.figure = longest;
  finding.unit = "s";
  if (gaps.size() > kMostSpans) gaps.resize(kMostSpans);
  finding.spans = gaps;
  if (stream.is_body) {
    finding.remedy = "frames are missing there; look at the driver's log, the network, the disk";
  } else if (longest > kPolicy.timing.never_held_s) {
    finding.remedy = "no estimate there; sensor, wiring, the driver's log; publish at a steady rate";
  } else {
    finding.remedy =
        "publish commands at a steady rate, not on change only; or let the last value hold longer";
    finding.setting = fmt::format("inputs.input_max_age_s: {:.2g}", kPolicy.timing.holds * longest);
  }
}

/// Stamps of the bodies of one frame lie apart by less than the tolerance, or frames fall to pieces.
void say_split_frames(Context& context) {
  std::vector<std::pair<double, std::size_t>> stamps;
  double period_s = 0.0;
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    if (context.own_ahead_s[b] != 0.0) continue;  // of another clock: said by check_receipt
    for (const TrackPose& pose : context.tracks[b].poses) stamps.emplace_back(pose.t_s, b);
    if (context.tracks[b].poses.size() > 1) period_s = std::max(period_s, context.tracks[b].period_s);
  }
  if (period_s <= 0.0) return;
  std::sort(stamps.begin(), stamps.end());
  std::vector<double> spreads;
  for (std::size_t i = 0; i < stamps.size();) {
    // One frame: all that come at once, no body twice.
    std::vector<bool> seen(context.tracks.size(), false);
    std::size_t j = i;
    while (j < stamps.size() && stamps[j].first - stamps[i].first < kPolicy.timing.one_frame * period_s &&
           !seen[stamps[j].second])
      seen[stamps[j++].second] = true;
    if (j - i > 1) spreads.push_back(stamps[j - 1].first - stamps[i].first);
    i = std::max(j, i + 1);
  }
  const double tolerance_s = context.arm.inputs.body_sync_tolerance_s;
  const double wide_s = math::quantile(spreads, kPolicy.timing.most_frames);
  if (spreads.size() < kPolicy.timing.least_frames || wide_s <= tolerance_s) return;
  CheckFinding& finding = context.add("split_frames", "",
                                      fmt::format("the bodies of one frame are stamped up to {:.2g} ms "
                                                  "apart, the arm file allows {:.2g} ms: frames are split",
                                                  1e3 * wide_s, 1e3 * tolerance_s));
  finding.figure = wide_s;
  finding.unit = "s";
  finding.remedy =
      "widen the tolerance, to no more than half the frame interval; better, one stamp per frame";
  finding.setting = fmt::format(
      "inputs.bodies.sync_tolerance_s: {:.2g}",
      std::min(kPolicy.timing.most_tolerance * period_s,
               std::max(kPolicy.timing.tolerance * wide_s, kPolicy.timing.least_tolerance * period_s)));
}

void say_left_out(Context& context) {
  if (context.left_out.empty()) return;
  double total_s = 0.0;
  for (const CheckSpan& span : context.left_out) total_s += span.to_s - span.from_s;
  CheckFinding& finding =
      context.add("left_out", "", fmt::format("the import left out {:.1f} s, as requested", total_s));
  finding.figure = total_s;
  finding.unit = "s";
  finding.spans = context.left_out;
  if (finding.spans.size() > kMostSpans) finding.spans.resize(kMostSpans);
}

void check_timing(Context& context) {
  say_left_out(context);
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    Stream stream = stream_of(context.tracks[b].name, context.recording.bodies[b]);
    if (stream.samples == 0) continue;
    stream.is_body = true;
    stream.is_base = b == 0;
    stream.max_age_s = kPolicy.timing.body_gap_s;
    say_zero_stamps(context, stream);
    say_backward(context, stream);
    say_regularity(context, stream, context.tracks[b].period_s);
  }
  // Gaps of all bodies together: a frame of any body ends one.
  Stream mocap;
  mocap.name = "mocap";
  mocap.is_body = true;
  mocap.max_age_s = kPolicy.timing.body_gap_s;
  // Between receipts: what a clock is known to be ahead makes no gap at the ends.
  const double latency_s = context.arm.inputs.body_latency_s - context.body_epoch.known_s;
  double period_s = 0.0;
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    for (const TrackPose& pose : context.tracks[b].poses)
      mocap.stamp_s.push_back(pose.t_s + context.begin_s + latency_s);
    if (context.tracks[b].poses.size() > 1) period_s = std::max(period_s, context.tracks[b].period_s);
  }
  say_gaps(context, mocap, period_s, 0.0);
  say_split_frames(context);
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    Stream stream = stream_of(context.signals[i].input->name, context.recording.inputs[i]);
    if (stream.samples == 0) continue;
    stream.max_age_s = context.arm.inputs.input_max_age_s;
    say_zero_stamps(context, stream);
    say_backward(context, stream);
    say_regularity(context, stream, context.signals[i].period_s);
    say_gaps(context, stream, context.signals[i].period_s, context.input_epochs[i].all_s());
  }
}

}  // namespace

Check make_timing() {
  return {check_timing,
          {{"zero_stamps", {}, Alike::kOnePerDriver},
           {"duplicates", Severity::kWarning, Alike::kOnePerDriver},
           {"out_of_order", Severity::kWarning, Alike::kOnePerDriver},
           {"time_jump", {}, Alike::kOnePerEvent},
           {"irregular_stamps", {}, Alike::kOnePerDriver},
           {"low_rate", Severity::kInformation, Alike::kOnePerDriver},
           {"gap", {}, Alike::kOnePerEvent},
           {"left_out", Severity::kInformation},
           {"split_frames", Severity::kSerious}}};
}

}  // namespace softarm::check
