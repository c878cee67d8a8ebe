// Inputs that are constant while the arm moves as if they were not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clock_problem.h"
#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

/// How far the outermost body gets about under one payload, m.
double motion_m(const Context& context) {
  const Track* tip = outermost(context);
  if (!tip) return 0.0;
  std::vector<double> changes_s{0.0};
  for (std::size_t i = 1; i < context.payload.size(); ++i) {
    if (context.payload[i].value != context.payload[i - 1].value) changes_s.push_back(context.payload[i].t_s);
  }
  double most_m = 0.0;
  for (std::size_t i = 0; i < changes_s.size(); ++i) {
    const double from_s = i == 0 ? 0.0 : changes_s[i] + kPolicy.dead.swings_s,
                 to_s = i + 1 < changes_s.size() ? changes_s[i + 1] - kPolicy.dead.hung_on_s
                                                 : context.duration_s;
    for (int k = 0; k < 3; ++k) {
      std::vector<double> places;
      for (const TrackPose& pose : tip->poses) {
        if (pose.good && pose.t_s >= from_s && pose.t_s <= to_s) places.push_back(pose.p(k));
      }
      if (places.size() < kPolicy.clocks.least_poses) continue;
      most_m = std::max(most_m, math::quantile(places, kPolicy.dead.most_places) -
                                    math::quantile(places, 1.0 - kPolicy.dead.most_places));
    }
  }
  return most_m;
}

/// A sensor of that kind would show its noise.
bool others_have_noise(const Context& context, const Signal& dead) {
  std::size_t noisy = 0, others = 0;
  for (const Signal& signal : context.signals) {
    if (&signal == &dead || signal.input->kind != dead.input->kind || signal.points.empty()) continue;
    ++others;
    noisy += signal.is_measured && signal.quantum == 0.0 && signal.noise_sd > 0.0;
  }
  return noisy > 0 && 2 * noisy > others;
}

void check_dead_inputs(Context& context) {
  const double moves_m = motion_m(context);
  if (moves_m < context.of_length(kPolicy.dead.moves)) return;
  std::vector<const Signal*> constant, silent;
  bool any_drives = false;
  for (const Signal& signal : context.signals) {
    if (signal.points.size() < kPolicy.signals.least_values) continue;
    if (drives(signal)) {
      any_drives = true;
      continue;
    }
    constant.push_back(&signal);
    if (signal.range() == 0.0 && others_have_noise(context, signal)) silent.push_back(&signal);
  }
  const bool unexplained =
      any_drives && context.explained && *context.explained < kPolicy.dead.least_explained;
  const std::vector<const Signal*>& dead = !any_drives || unexplained ? constant : silent;
  if (dead.empty()) return;
  std::string names;
  for (const Signal* signal : dead) names += (names.empty() ? "" : ", ") + signal->input->name;
  std::string what = fmt::format("constant throughout, while the arm moves by {:.0f} mm", 1e3 * moves_m);
  if (!any_drives) {
    what += " and no input drives it";
  } else if (unexplained) {
    what += fmt::format(", of which the other inputs explain {:.0f} %",
                        100.0 * std::max(0.0, *context.explained));
  } else {
    what += ", and to the last bit, where the other sensors have noise";
  }
  // That it says nothing of this input is then the lesser word.
  auto& all = context.findings;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const CheckFinding& f) {
                             return f.id == "never_driven" &&
                                    std::any_of(dead.begin(), dead.end(), [&](const Signal* signal) {
                                      return signal->input->name == f.where;
                                    });
                           }),
            all.end());
  CheckFinding& finding = context.add("dead_input", names, what);
  finding.figure = moves_m;
  finding.unit = "m";
  finding.remedy =
      "a sensor that is not connected, or another's topic or column: leave the trial out of identify. "
      "Nothing is "
      "wrong where the arm was moved by hand";
}

}  // namespace

Check make_dead_inputs() {
  return {check_dead_inputs, {{"dead_input", Severity::kWarning}}};
}

}  // namespace softarm::check
