#include "arm_file_header.h"

#include <fmt/format.h>

namespace softarm::identify {
namespace {

std::string names_of(const Result& result, bool held_out) {
  std::string names;
  for (const TrialSummary& trial : result.trials) {
    if (trial.held_out == held_out) names += (names.empty() ? "" : ", ") + trial.name;
  }
  return names;
}

}  // namespace

std::vector<std::string> arm_file_header(const Result& result) {
  std::vector<std::string> lines{"constants and prior identified from the trials " + names_of(result, false)};
  lines.push_back(verdict(result));
  if (!result.left_out_one.empty()) {
    const ShapeError &before = result.left_out_one_before, &after = result.left_out_one_after;
    lines.push_back(fmt::format(
        "mean shape error, each trial by a fit to the others: {:.2f} mm, {:.2f} % of the length; before: "
        "{:.2f} mm",
        1e3 * after.mean_m, after.percent(after.mean_m), 1e3 * before.mean_m));
  } else if (result.held_out.frames > 0) {
    const ShapeError &before = result.held_out_before, &after = result.held_out;
    lines.push_back(fmt::format(
        "mean shape error on unseen trials ({}): {:.2f} mm, {:.2f} % of the length; before: "
        "{:.2f} mm",
        names_of(result, true), 1e3 * after.mean_m, after.percent(after.mean_m), 1e3 * before.mean_m));
  } else {
    lines.push_back(fmt::format("no trial is unseen; mean shape error on those fitted: {:.2f} mm",
                                1e3 * result.fitted.mean_m));
  }
  for (const Constant& constant : result.constants) {
    if (!constant.determined)
      lines.push_back(fmt::format("NOT determined by these trials: {}{}", constant.name,
                                  constant.kept           ? " (ran into its limit; as it was)"
                                  : !constant.at_bound    ? ""
                                  : constant.value == 0.0 ? " (none was found)"
                                                          : " (at its limit)"));
  }
  for (const std::string& warning : result.warnings) lines.push_back(warning);
  for (const std::string& note : result.prior_notes) lines.push_back("prior: " + note);
  return lines;
}

}  // namespace softarm::identify
