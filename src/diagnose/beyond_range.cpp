#include "beyond_range.h"

#include <fmt/format.h>

#include <algorithm>

#include "ending.h"
#include "first_fits.h"
#include "ranges.h"
#include "refits.h"
#include "sentences.h"
#include "softarm/identify/identify.h"
#include "unseen.h"

namespace softarm::diagnose {
namespace {

// Times by which the ends of the file's ranges are moved for one fit that only shows where it would go: they
// say what is sane, not what is possible. Wide enough to be no ends again; no verdict goes by them.
constexpr double kWider = 100.0, kLonger = 2.0;

/// Lets a constant be what it may be physically. @return whether the file's own range was in the way
bool widen(arm::Arm& arm, const identify::ConstantRef& constant) {
  const arm::Range before = identify::allowed_range(arm, constant);
  for (const int i : arm::segments_of(constant)) {
    arm::Segment& segment = arm.segments[static_cast<std::size_t>(i)];
    if (constant.kind == arm::ConstantKind::kLength)
      segment.length_range_m = {segment.length_range_m.low / kLonger, segment.length_range_m.high * kLonger};
    else if (arm::role_of(constant.kind) == arm::ConstantRole::kBendingStiffness)
      segment.bending_stiffness_range_nm2 = {segment.bending_stiffness_range_nm2.low / kWider,
                                             segment.bending_stiffness_range_nm2.high * kWider};
  }
  const arm::Range now = identify::allowed_range(arm, constant);
  return now.low < before.low || now.high > before.high;
}

/// "segment_1.length is 0.2 m", with another verb.
std::string with_value(const JointModel& model, const Linearised& fit, std::size_t column, const char* verb) {
  const identify::ConstantRef& constant =
      model.constants()[static_cast<std::size_t>(fit.columns[column].index)];
  return fmt::format("{} {} {:.4g} {}", identify::name_of(model.arm(), constant), verb,
                     value_of(fit.at, fit.columns[column]), identify::unit_of(constant.kind));
}

}  // namespace

BeyondRange beyond_range(const JointModel& model, const Selection& selection, const Options& options) {
  const Linearised& baseline = selection.baseline;
  const std::vector<bool> held = drawn_beyond(baseline);
  arm::Arm wide = model.arm();
  std::vector<std::string> at_end;
  std::vector<std::size_t> widened;
  for (std::size_t j = 0; j < held.size(); ++j) {
    const JointUnknown& column = baseline.columns[j];
    if (!held[j] || column.kind != JointUnknown::Kind::kConstant) continue;
    at_end.push_back(with_value(model, baseline, j, "rests at"));
    if (widen(wide, model.constants()[static_cast<std::size_t>(column.index)])) widened.push_back(j);
  }
  if (at_end.empty()) return {};
  const bool one = at_end.size() == 1;
  const std::string text = fmt::format(
      "In the fit of the arm's constants alone, {}, {} in the arm file, and the trials would take {} "
      "further.",
      one_of(at_end, "and"), one ? "an end of its range" : "ends of their ranges", one ? "it" : "them");
  if (widened.empty()) return {text, false, {}};
  JointModel other(wide, model.trials(), options.jobs, options.held, options.tied, options.known);
  const Linearised fit = first_fits(other, [] {}).baseline;
  const Unseen &narrow_unseen = selection.baseline_unseen, wide_unseen = unseen(other, fit);
  if (!(wide_unseen.mean_m < narrow_unseen.mean_m) || moved_m(narrow_unseen, wide_unseen) < trivial_m(model))
    return {text, false, {}};
  std::vector<std::string> beyond;
  for (const std::size_t j : widened) beyond.push_back(with_value(other, fit, j, "at"));
  BeyondRange said{fmt::format("{} With {} the mean error{} is {} instead of {}, without any effect: check "
                               "that range before trusting any effect.",
                               text, one_of(beyond, "and"), on_unseen(model.trials().size()),
                               millimetres(wide_unseen.mean_m), millimetres(narrow_unseen.mean_m)),
                   true,
                   {}};
  if (!selection.extended.at.effects.empty())
    said.still_there = doubt_in_another(other, fit, selection, options).still_there;
  return said;
}

}  // namespace softarm::diagnose
