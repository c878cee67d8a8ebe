// The clock of the inputs against that of the bodies: what is said of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clock_search.h"
#include "clock_shift.h"
#include "context.h"
#include "math/statistics.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

/// What receipt has shown already of the clocks: how far stamps are ahead of it.
struct Shown {
  double bodies_s = 0.0, inputs_s = 0.0;

  bool any() const { return bodies_s != 0.0 || inputs_s != 0.0; }
  double between_s() const { return bodies_s - inputs_s; }
};

Shown shown_by_receipt(const Context& context) {
  Shown shown;
  std::vector<double> inputs_s(context.signals.size(), 0.0);
  for (const CheckFinding& f : context.findings) {
    if (f.id != "stamps_ahead" || !f.figure) continue;
    if (f.where == "mocap") shown.bodies_s = *f.figure;
    for (std::size_t i = 0; i < context.signals.size(); ++i) {
      if (f.where == context.signals[i].input->name) inputs_s[i] = *f.figure;
    }
  }
  shown.inputs_s = math::median(inputs_s);
  return shown;
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
  const Shown shown = shown_by_receipt(context);
  const double shown_s = shown.between_s(), left_s = shift.shift_s - shown_s;
  const bool leads = left_s < -(kPolicy.clocks.lead_s + kPolicy.clocks.sds * shift.sd_s);
  const bool lags = left_s > kPolicy.clocks.lag_s + kPolicy.clocks.sds * shift.sd_s;
  std::string what =
      fmt::format("clock offset or lag: the arm answers {:.0f} ms {} its inputs (95 %: {:.0f} to {:.0f} ms)",
                  1e3 * std::abs(shift.shift_s), shift.shift_s < 0.0 ? "before" : "after",
                  1e3 * (shift.shift_s - 1.96 * shift.sd_s), 1e3 * (shift.shift_s + 1.96 * shift.sd_s));
  if (shown_s != 0.0) {
    what += fmt::format("; {:.0f} ms of this because the stamps are ahead of their receipt", 1e3 * shown_s);
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
      leads ? "no arm moves before its inputs: the inputs' clock is ahead of the mocap's, or the mocap's "
              "behind. Synchronise the clocks, or shift the stamps"
            : "a lag of valves, lines and the arm itself looks the same: only a test of the clocks (a LED or "
              "a tap that both see) can tell. Either way, a model without lag needs the stamps shifted";
  // The inputs' own settings take off what they are ahead.
  if (leads || lags || !shown.any()) finding.setting = clock_setting(context, shift.shift_s + shown.inputs_s);
}

std::string percent(double explained) {
  return fmt::format("{:.0f} %", 100.0 * std::max(0.0, explained));
}

/// Whether a shift is known to be beyond those that were looked at about the stamps. One that is chance, of
/// motion that is not the inputs', is hardly pinned to an instant.
bool is_apart(const std::optional<ClockShift>& fine) {
  return fine && !fine->too_short && !fine->at_edge &&
         std::abs(fine->shift_s) - kPolicy.clocks.sds * fine->sd_s > kPolicy.clocks.most_shift_s;
}

/// Clocks that are apart by more than any lag.
void say_apart(Context& context, const ClockSearch& search, const ClockShift& fine) {
  std::string what = fmt::format(
      "bodies and inputs belong to different times: as stamped, the inputs explain {} of the motion, but {} "
      "if the bodies are shifted {:.2f} s {}",
      percent(search.as_stamped), percent(search.explained), std::abs(fine.shift_s),
      fine.shift_s > 0.0 ? "earlier" : "later");
  what += fmt::format(" (95 %: {:.2f} to {:.2f} s)", std::abs(fine.shift_s) - 1.96 * fine.sd_s,
                      std::abs(fine.shift_s) + 1.96 * fine.sd_s);
  if (search.other_s) {
    what += fmt::format("; ambiguous: {} at {:.1f} s {}, because the inputs repeat themselves",
                        percent(search.other_explained), std::abs(*search.other_s),
                        *search.other_s > 0.0 ? "earlier" : "later");
  }
  CheckFinding& finding =
      context.add(search.other_s ? Severity::kWarning : Severity::kSerious, "clocks_apart", "", what);
  finding.figure = fine.shift_s;
  finding.figure_sd = fine.sd_s;
  finding.unit = "s";
  finding.remedy =
      "two clocks, or two recordings that were started separately: synchronise them, and shift these stamps";
  if (search.other_s) {
    finding.remedy += "; a trial with one quick step that is not repeated shows which shift is right";
    return;
  }
  finding.setting = clock_setting(context, fine.shift_s);
  if (finding.setting.empty())
    finding.remedy += ". A live frame cannot wait that long for its inputs: record again, or shift the bag";
}

void check_clocks(Context& context) {
  if (context.signals.empty()) return;
  if (const std::optional<ClockSearch> search = clock_search(context)) {
    context.explained = search->as_stamped;
    const auto fine = search->shift_s ? clock_shift(context, *search->shift_s) : std::nullopt;
    if (is_apart(fine)) {
      context.explained = search->explained;
      return say_apart(context, *search, *fine);
    }
  }
  const std::optional<ClockShift> found = clock_shift(context);
  const auto cannot = [&](const std::string& why) {
    context.add("clock_cannot_tell", "", "clock offset between inputs and mocap: cannot tell, " + why)
        .remedy = "a trial with quick steps of each input shows it";
  };
  if (!found) return cannot("no input changes while a body is seen");
  if (found->too_short) return cannot("the trial is too short");
  const ClockShift& shift = *found;
  if (shift.at_edge || shift.sd_s > kPolicy.clocks.least_sd_s ||
      shift.explained < kPolicy.clocks.least_explained) {
    return cannot(
        shift.explained < kPolicy.clocks.least_explained
            ? fmt::format("the inputs explain only {:.0f} % of the motion", 100.0 * shift.explained)
        : shift.at_edge
            ? std::string("no shift within a second fits better than its neighbours")
            : fmt::format("the motion is too slow, or not caused by the inputs alone (+- {:.0f} ms)",
                          2e3 * shift.sd_s));
  }
  say(context, shift);
}

}  // namespace

Check make_clocks() {
  return {check_clocks,
          {{"clocks_apart", {}}, {"clock_offset_or_lag", {}}, {"clock_cannot_tell", Severity::kInformation}}};
}

}  // namespace softarm::check
