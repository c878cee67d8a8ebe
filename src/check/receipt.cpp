// Receipt against stamp: transport, and clocks that disagree.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

struct Transport {
  double delay_s = 0.0;   // median of receipt - stamp
  double least_s = 0.0;   // 2 % of all are faster
  double jitter_s = 0.0;  // 5 % ... 95 %
  double drift = 0.0;     // of the least delay, s per s
};

/// Slope of the lower edge of the delays: queues only ever add to them.
double drift_of(const std::vector<double>& t_s, const std::vector<double>& delay_s) {
  constexpr std::size_t kBlocks = 8;
  if (t_s.size() < 20 * kBlocks) return 0.0;
  std::vector<double> x, y;
  const std::size_t n = t_s.size() / kBlocks;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto at = static_cast<std::ptrdiff_t>(b * n), end = static_cast<std::ptrdiff_t>((b + 1) * n);
    x.push_back(math::mean({t_s.begin() + at, t_s.begin() + end}));
    y.push_back(math::quantile({delay_s.begin() + at, delay_s.begin() + end}, 0.1));
  }
  std::vector<double> slopes;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    for (std::size_t j = i + 1; j < kBlocks; ++j)
      slopes.push_back((y[j] - y[i]) / std::max(x[j] - x[i], 1e-3));
  }
  // What most pairs do not agree on is chance.
  const bool agreed = math::quantile(slopes, 0.2) * math::quantile(slopes, 0.8) > 0.0;
  return agreed ? math::median(slopes) : 0.0;
}

template <typename Samples>
std::optional<Transport> transport_of(const Samples& all, double begin_s) {
  std::vector<double> t, delay;
  for (const auto& samples : all) {
    for (const auto& s : samples) {
      if (!(s.stamp_s > 0.0)) continue;
      t.push_back(s.receipt_s - begin_s);
      delay.push_back(s.receipt_s - s.stamp_s);
    }
  }
  if (delay.size() < 20) return std::nullopt;
  std::vector<std::size_t> order(t.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return t[a] < t[b]; });
  std::vector<double> ts, ds;
  for (const std::size_t i : order) {
    ts.push_back(t[i]);
    ds.push_back(delay[i]);
  }
  return Transport{math::median(delay), math::quantile(delay, 0.02),
                   math::quantile(delay, 0.95) - math::quantile(delay, 0.05), drift_of(ts, ds)};
}

void say(Context& context, const std::string& name, const Transport& transport, const std::string& key,
         double known_s) {
  const double least_s = transport.least_s + known_s;  // stamps are ahead by what the arm file says
  if (std::abs(transport.delay_s) > 2.0) {
    CheckFinding& finding = context.add(
        Severity::kSerious, "other_epoch", name,
        fmt::format("stamps are {:+.6g} s from receipt: they are of another clock", -transport.delay_s));
    finding.figure = -transport.delay_s;
    finding.unit = "s";
    finding.remedy =
        "let the driver translate its clock to ROS time (mocap drivers have a switch for it), or "
        "subtract the difference";
    // latency_s of the arm file goes up to an hour; a stamp of receipt costs the jitter of transport.
    finding.setting = std::abs(transport.delay_s) < 3600.0
                          ? fmt::format("{}: {:.4g}", key, -transport.delay_s)
                          : key.substr(0, key.rfind('.')) + ".stamp: receipt";
    return;
  }
  const bool drifts = std::abs(transport.drift) > kPolicy.receipt.drift &&
                      std::abs(transport.drift) * context.duration_s > kPolicy.receipt.drifted_s;
  // A clock that runs away gets ahead by so much; that is said once.
  const double run_away_s = drifts ? 1.2 * std::abs(transport.drift) * context.duration_s : 0.0;
  const bool ahead = -least_s > kPolicy.receipt.ahead_s + run_away_s;
  const bool late = transport.least_s > kPolicy.receipt.long_s;
  if (ahead) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "stamps_ahead", name,
        fmt::format("stamped {:.3g} ms after it was received: the stamping clock is ahead at least by that",
                    -1e3 * least_s));
    finding.figure = -least_s;
    finding.unit = "s";
    finding.remedy =
        "synchronise the machines (chrony), or subtract it; the transport's own delay comes on top";
    finding.setting = fmt::format("{}: {:.4g}", key, -transport.least_s);
  } else if (late) {
    CheckFinding& finding = context.add(
        Severity::kWarning, "late_receipt", name,
        fmt::format("received {:.3g} ms after its stamp, at best: a slow path, or a stamping clock that is "
                    "behind",
                    1e3 * transport.least_s));
    finding.figure = transport.least_s;
    finding.unit = "s";
    finding.remedy =
        "the stamps hold, not receipt, so a slow path alone does no harm to headed messages; what "
        "has no header (std_msgs) is held to be as new as its receipt. Synchronise the machines";
  }
  if ((ahead || late) && transport.jitter_s > kPolicy.receipt.jitter_s) {
    context.findings.back().what +=
        fmt::format("; nine of ten within {:.2g} ms of each other", 1e3 * transport.jitter_s);
  }
  if (drifts) {
    CheckFinding& finding =
        context.add(Severity::kWarning, "clock_drift", name,
                    fmt::format("the stamping clock gains {:+.0f} microseconds per second on the recorder's",
                                -1e6 * transport.drift));
    finding.figure = -transport.drift;
    finding.unit = "1";
    finding.remedy = "synchronise the machines (chrony); a constant latency_s cannot repair a drift";
  }
  const bool shaky = transport.jitter_s > kPolicy.receipt.very_shaky_s;
  if (!ahead && !late && (transport.delay_s != 0.0 || transport.jitter_s > 0.0)) {
    CheckFinding& finding = context.add(
        shaky ? Severity::kWarning : Severity::kInformation, "receipt", name,
        fmt::format("received {:.3g} ms after its stamp (median); nine of ten within {:.2g} ms of each other",
                    1e3 * transport.delay_s, 1e3 * transport.jitter_s));
    finding.figure = transport.delay_s;
    finding.unit = "s";
    if (transport.jitter_s > kPolicy.receipt.jitter_s) {
      finding.remedy = "a wired network; messages without a header take on this jitter as an error of time";
    }
  }
}

}  // namespace

void check_receipt(Context& context) {
  if (const auto mocap = transport_of(context.recording.bodies, context.begin_s)) {
    say(context, "mocap", *mocap, "inputs.bodies.latency_s", context.arm.inputs.body_latency_s);
  }
  for (std::size_t i = 0; i < context.signals.size(); ++i) {
    const std::vector<std::vector<trial::RecordedValue>> one{context.recording.inputs[i]};
    const auto transport = transport_of(one, context.begin_s);
    if (!transport) continue;
    const arm::ScalarInput& input = *context.signals[i].input;
    const char* list = input.kind == arm::InputKind::kTension ? "tensions"
                       : input.kind == arm::InputKind::kAngle ? "angles"
                                                              : "pressures";
    say(context, input.name, *transport, fmt::format("inputs.{}[{}].latency_s", list, input.name),
        input.latency_s);
  }
}

}  // namespace softarm::check
