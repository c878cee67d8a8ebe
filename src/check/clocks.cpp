// The clock of the inputs against that of the bodies: what is said of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clock_shift.h"
#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// What receipt has shown already of the clocks: how far bodies' stamps are ahead of those of the inputs.
double shown_by_receipt_s(const Context& context) {
  double bodies_s = 0.0;
  std::vector<double> inputs_s(context.signals.size(), 0.0);
  for (const CheckFinding& f : context.findings) {
    if (f.id != "stamps_ahead" || !f.figure) continue;
    if (f.where == "mocap") bodies_s = *f.figure;
    for (std::size_t i = 0; i < context.signals.size(); ++i) {
      if (f.where == context.signals[i].input->name) inputs_s[i] = *f.figure;
    }
  }
  return bodies_s - math::median(inputs_s);
}

/// One cause, one finding with the setting: a mocap clock that is behind is received late as well. Takes that
/// finding away and returns its words.
std::string taken_from_late_receipt(Context& context, const ClockShift& shift) {
  auto& all = context.findings;
  const auto late = std::find_if(all.begin(), all.end(), [&](const CheckFinding& f) {
    return f.id == "late_receipt" && f.where == "mocap" &&
           std::abs(*f.figure + shift.shift_s) <
               kPolicy.clocks.lead_s + kPolicy.clocks.lag_s + kPolicy.clocks.sds * shift.sd_s;
  });
  if (late == all.end()) return "";
  const std::string words =
      fmt::format("; and mocap is received {:.0f} ms after its stamps, at best", 1e3 * *late->figure);
  all.erase(late);
  return words;
}

void say(Context& context, const ClockShift& shift) {
  const double shown_s = shown_by_receipt_s(context), left_s = shift.shift_s - shown_s;
  const bool leads = left_s < -(kPolicy.clocks.lead_s + kPolicy.clocks.sds * shift.sd_s);
  const bool lags = left_s > kPolicy.clocks.lag_s + kPolicy.clocks.sds * shift.sd_s;
  std::string what =
      fmt::format("clock offset or lag: the arm answers {:.0f} ms {} its inputs (95 %: {:.0f} to {:.0f} ms)",
                  1e3 * std::abs(shift.shift_s), shift.shift_s < 0.0 ? "before" : "after",
                  1e3 * (shift.shift_s - 1.96 * shift.sd_s), 1e3 * (shift.shift_s + 1.96 * shift.sd_s));
  if (shown_s != 0.0) {
    what += fmt::format("; {:.0f} ms of it are the stamps that are ahead of their receipt", 1e3 * shown_s);
  }
  if (leads) what += taken_from_late_receipt(context, shift);
  if (leads || lags) {
    for (CheckFinding& f : context.findings) {
      if (f.id == "stamps_ahead" && f.where == "mocap") f.setting.clear();
    }
  }
  CheckFinding& finding = context.add(leads || lags ? Severity::kWarning : Severity::kInformation,
                                      "clock_offset_or_lag", "", what);
  finding.figure = shift.shift_s;
  finding.figure_sd = shift.sd_s;
  finding.unit = "s";
  finding.remedy =
      leads ? "no arm comes before its inputs: the inputs' clock is ahead of the mocap's, or the mocap's "
              "behind. Synchronise the clocks, or shift the stamps"
            : "a lag of valves, lines and the arm itself looks the same: only a test of the clocks (a LED "
              "or a tap that both see) can tell. Either way a model without lag wants the stamps shifted";
  const double known_s = context.arm.inputs.body_latency_s;
  if (leads || lags || shown_s == 0.0) {
    finding.setting = fmt::format("inputs.bodies.latency_s: {:.3f}", known_s + shift.shift_s);
  }
}

void check_clocks(Context& context) {
  if (context.signals.empty()) return;
  const std::optional<ClockShift> found = clock_shift(context);
  const auto cannot = [&](const std::string& why) {
    context.add("clock_cannot_tell", "", "clocks of inputs and mocap against each other: cannot tell, " + why)
        .remedy = "a trial with quick steps of each input shows it";
  };
  if (!found) return cannot("no input changes while a body is seen");
  if (found->too_short) return cannot("the trial is too short");
  const ClockShift& shift = *found;
  if (shift.at_edge || shift.sd_s > kPolicy.clocks.least_sd_s ||
      shift.explained < kPolicy.clocks.least_explained) {
    return cannot(shift.explained < kPolicy.clocks.least_explained
                      ? fmt::format("the inputs explain {:.0f} % of the motion only", 100.0 * shift.explained)
                  : shift.at_edge
                      ? std::string("no shift within a second fits better than its neighbours")
                      : fmt::format("the motion is too slow, or not the inputs' alone (+- {:.0f} ms)",
                                    2e3 * shift.sd_s));
  }
  say(context, shift);
}

}  // namespace

Check make_clocks() {
  return {check_clocks, {{"clock_offset_or_lag", {}}, {"clock_cannot_tell", Severity::kInformation}}};
}

}  // namespace softarm::check
