// Receipt against stamp: transport, and clocks that disagree.
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

struct Transport {
  double delay_s = 0.0;   // median of receipt - stamp
  double least_s = 0.0;   // hardly any are faster
  double jitter_s = 0.0;  // 5 % ... 95 %
  double drift = 0.0;     // of the least delay, s per s
};

/// Slope of the lower edge of the delays: queues only ever add to them.
double drift_of(const std::vector<double>& t_s, const std::vector<double>& delay_s) {
  constexpr std::size_t kBlocks = kPolicy.receipt.drift_blocks;
  if (t_s.size() < kPolicy.receipt.block_samples * kBlocks) return 0.0;
  std::vector<double> x, y;
  const std::size_t n = t_s.size() / kBlocks;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto at = static_cast<std::ptrdiff_t>(b * n), end = static_cast<std::ptrdiff_t>((b + 1) * n);
    x.push_back(math::mean({t_s.begin() + at, t_s.begin() + end}));
    y.push_back(math::quantile({delay_s.begin() + at, delay_s.begin() + end}, kPolicy.receipt.block_least));
  }
  std::vector<double> slopes;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    for (std::size_t j = i + 1; j < kBlocks; ++j)
      slopes.push_back((y[j] - y[i]) / std::max(x[j] - x[i], 1e-3));
  }
  // What most pairs do not agree on is chance.
  constexpr double kFew = kPolicy.receipt.few_slopes;
  const bool agreed = math::quantile(slopes, kFew) * math::quantile(slopes, 1.0 - kFew) > 0.0;
  return agreed ? math::median(slopes) : 0.0;
}

template <typename Sample>
std::optional<Transport> transport_of(const std::vector<Sample>& samples, double begin_s) {
  std::vector<double> t, delay;
  for (const Sample& s : samples) {
    if (!(s.stamp_s > 0.0)) continue;
    t.push_back(s.receipt_s - begin_s);
    delay.push_back(s.receipt_s - s.stamp_s);
  }
  if (delay.size() < kPolicy.receipt.least_samples) return std::nullopt;
  std::vector<std::size_t> order(t.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return t[a] < t[b]; });
  std::vector<double> ts, ds;
  for (const std::size_t i : order) {
    ts.push_back(t[i]);
    ds.push_back(delay[i]);
  }
  return Transport{math::median(delay), math::quantile(delay, kPolicy.receipt.least_delay),
                   math::quantile(delay, 0.95) - math::quantile(delay, 0.05), drift_of(ts, ds)};
}

/// What is said of one stream: the bodies' or an input's.
struct Stamped {
  std::string name;
  Transport transport;
  std::string path;      // in the arm file
  double known_s = 0.0;  // that latency_s
};

/// Played back, or all on one clock that is not the recorder's: the stamps agree, and they decide.
void say_one_epoch(Context& context, const Stamped& stamped) {
  const auto& scalars = context.arm.inputs.scalars;
  const bool by_receipt = std::any_of(scalars.begin(), scalars.end(), [](const arm::ScalarInput& input) {
    return input.stamp == arm::StampSource::kReceipt || boost::starts_with(input.type, "std_msgs/");
  });
  CheckFinding& finding = context.add(
      by_receipt ? Severity::kWarning : Severity::kInformation, "other_epoch", stamped.name,
      fmt::format("stamps are {:+.6g} s from receipt, all alike: one clock, which is not the recorder's",
                  -stamped.transport.delay_s));
  finding.figure = -stamped.transport.delay_s;
  finding.unit = "s";
  finding.remedy = by_receipt
                       ? "estimates use the stamps; a message without a header (std_msgs) is taken to be as "
                         "recent as the last body received before it, so record with the clock that stamps"
                       : "none is needed if the bag was played back: estimates use the stamps";
}

void say_other_epoch(Context& context, const Stamped& stamped) {
  const double delay_s = stamped.transport.delay_s;
  CheckFinding& finding =
      context.add(Severity::kSerious, "other_epoch", stamped.name,
                  fmt::format("stamps are {:+.6g} s from receipt: they are of another clock", -delay_s));
  finding.figure = -delay_s;
  finding.unit = "s";
  finding.remedy =
      "let the driver translate its clock to ROS time (mocap drivers have a switch for it), or "
      "subtract the difference";
  // latency_s of the arm file has an end; a stamp of receipt costs the jitter of transport.
  const double latency_s = -delay_s;
  finding.setting = std::abs(latency_s) < kPolicy.receipt.most_latency_s
                        ? fmt::format("{}.latency_s: {:.4g}", stamped.path, latency_s)
                        : stamped.path + ".stamp: receipt";
}

void say_ahead(Context& context, const Stamped& stamped, double least_s) {
  CheckFinding& finding = context.add(
      "stamps_ahead", stamped.name,
      fmt::format("stamped {:.3g} ms after it was received: the stamping clock is ahead by at least that",
                  -1e3 * least_s));
  finding.figure = -least_s;
  finding.unit = "s";
  finding.remedy =
      "synchronise the machines (chrony), or subtract it; the transport's own delay comes on top";
  finding.setting = fmt::format("{}.latency_s: {:.4g}", stamped.path, -stamped.transport.least_s);
}

void say_late(Context& context, const Stamped& stamped) {
  CheckFinding& finding = context.add(
      "late_receipt", stamped.name,
      fmt::format("received {:.3g} ms after its stamp, at best: a slow path, or a stamping clock that is "
                  "behind",
                  1e3 * stamped.transport.least_s));
  finding.figure = stamped.transport.least_s;
  finding.unit = "s";
  finding.remedy =
      "stamps count, not receipt, so a slow path alone does no harm to messages with a header; a message "
      "without one (std_msgs) is taken to be as recent as its receipt. Synchronise the machines";
}

void say_drift(Context& context, const Stamped& stamped) {
  CheckFinding& finding =
      context.add("clock_drift", stamped.name,
                  fmt::format("the stamping clock gains {:+.0f} microseconds per second on the recorder's",
                              -1e6 * stamped.transport.drift));
  finding.figure = -stamped.transport.drift;
  finding.unit = "1";
  finding.remedy = "synchronise the machines (chrony); a constant latency_s cannot repair a drift";
}

void say_receipt(Context& context, const Stamped& stamped) {
  const Transport& transport = stamped.transport;
  const bool shaky = transport.jitter_s > kPolicy.receipt.very_shaky_s;
  CheckFinding& finding = context.add(
      shaky ? Severity::kWarning : Severity::kInformation, "receipt", stamped.name,
      fmt::format("received {:.3g} ms after its stamp (median); nine of ten within {:.2g} ms of each other",
                  1e3 * transport.delay_s, 1e3 * transport.jitter_s));
  finding.figure = transport.delay_s;
  finding.unit = "s";
  if (transport.jitter_s > kPolicy.receipt.jitter_s) {
    finding.remedy = "a wired network; in messages without a header this jitter becomes a timing error";
  }
}

void say(Context& context, const Stamped& stamped) {
  const Transport& transport = stamped.transport;
  const double least_s = transport.least_s + stamped.known_s;  // stamps are ahead by what the arm file says
  // An import has no times of receipt but the stamps themselves.
  if (transport.delay_s == 0.0 && transport.jitter_s == 0.0) return;
  if (std::min(std::abs(transport.delay_s), std::abs(transport.delay_s + stamped.known_s)) >
      kPolicy.timing.other_epoch_s)
    return context.has_one_clock() ? say_one_epoch(context, stamped) : say_other_epoch(context, stamped);
  const bool drifts = std::abs(transport.drift) > kPolicy.receipt.drift &&
                      std::abs(transport.drift) * context.duration_s > kPolicy.receipt.drifted_s;
  // A clock that runs away gets ahead by so much; that is said once.
  const double run_away_s =
      drifts ? kPolicy.receipt.run_away * std::abs(transport.drift) * context.duration_s : 0.0;
  const bool ahead = -least_s > kPolicy.receipt.ahead_s + run_away_s;
  const bool late = transport.least_s > kPolicy.receipt.long_s;
  if (ahead) {
    say_ahead(context, stamped, least_s);
  } else if (late) {
    say_late(context, stamped);
  }
  if ((ahead || late) && transport.jitter_s > kPolicy.receipt.jitter_s) {
    context.findings.back().what +=
        fmt::format("; nine of ten within {:.2g} ms of each other", 1e3 * transport.jitter_s);
  }
  if (drifts) say_drift(context, stamped);
  if (!ahead && !late && (transport.delay_s != 0.0 || transport.jitter_s > 0.0)) {
    say_receipt(context, stamped);
  }
}

/// One body, or the base, that another machine stamps than the other bodies.
void say_own_clock(Context& context, std::size_t track) {
  CheckFinding& finding =
      context.add(Severity::kSerious, "other_epoch", context.tracks[track].name,
                  fmt::format("stamps are {:+.6g} s from those of the other bodies: no frame has both",
                              context.own_ahead_s[track]));
  finding.figure = context.own_ahead_s[track];
  finding.unit = "s";
  finding.remedy = "one clock for all bodies (chrony, or one driver)";
}

void check_receipt(Context& context) {
  std::vector<trial::RecordedPose> together;
  for (std::size_t b = 0; b < context.tracks.size(); ++b) {
    const auto& poses = context.recording.bodies[b];
    if (context.own_ahead_s[b] == 0.0)
      together.insert(together.end(), poses.begin(), poses.end());
    else
      say_own_clock(context, b);
  }
  if (const auto mocap = transport_of(together, context.begin_s)) {
    say(context, {"mocap", *mocap, "inputs.bodies", context.arm.inputs.body_latency_s});
  }
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    const auto transport = transport_of(context.recording.inputs[i], context.begin_s);
    if (!transport) continue;
    const arm::ScalarInput& input = *context.signals[i].input;
    say(context, {input.name, *transport, path_of(input), input.latency_s});
  }
}

}  // namespace

Check make_receipt() {
  return {check_receipt,
          {{"other_epoch", {}, Alike::kOnePerDriver},
           {"stamps_ahead", Severity::kWarning, Alike::kOnePerDriver},
           {"late_receipt", Severity::kWarning, Alike::kOnePerDriver},
           {"clock_drift", Severity::kWarning, Alike::kOnePerDriver},
           {"receipt", {}, Alike::kOnePerDriver}}};
}

}  // namespace softarm::check
