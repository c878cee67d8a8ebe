// Inputs that are constant while the arm moves as if they were not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "block_fit.h"
#include "clock_problem.h"
#include "context.h"
#include "input_directions.h"
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

/// The motion of the outermost body across the arm, and what the inputs that change leave of it, in the rod's
/// frame at the base: samples x 2, m.
struct Motion {
  Eigen::MatrixXd all, left;
};

std::optional<Motion> motion_of(const Context& context) {
  const auto base = context.rod_base();
  // A dead input may well have been driven slowly. And so many functions of a short trial would explain
  // anything.
  auto problem = clock_problem(
      context, 0.0, std::max(kPolicy.clocks.sample_s, context.duration_s / kPolicy.clocks.most_samples),
      false);
  if (!base || !problem) return std::nullopt;
  problem->with_plays = problem->with_cubes = false;
  const BlockFit fit = fit_in_blocks(regressors(*problem, 0.0), problem->y, problem->block);
  const Eigen::MatrixXd across = base->linear().leftCols<2>();
  return Motion{problem->y * across, fit.left * across};
}

/// Share of a motion along a line.
double along(const Eigen::MatrixXd& motion, const Eigen::Vector2d& line) {
  return (motion * line).squaredNorm() / std::max(motion.squaredNorm(), 1e-300);
}

/// Of inputs that never change those along whose line the arm moves as the others do not explain.
struct Accused {
  const Signal* signal = nullptr;
  double moves_m = 0.0, share = 0.0;
};

std::vector<Accused> accused_of(const Context& context, const std::vector<const Signal*>& constant) {
  std::vector<Accused> accused;
  const auto motion = motion_of(context);
  if (!motion) return accused;
  const double left = motion->left.squaredNorm() / std::max(motion->all.squaredNorm(), 1e-300);
  if (left < kPolicy.dead.unexplained) return accused;
  for (const Signal* signal : constant) {
    const auto line = bending_direction(context.arm, signal->input->name, context.arm.segments.size());
    if (!line || along(motion->left, *line) < kPolicy.dead.along ||
        along(motion->all - motion->left, *line) > kPolicy.dead.driven_along)
      continue;
    const Eigen::VectorXd places = motion->left * *line;
    const std::vector<double> course(places.data(), places.data() + places.size());
    const double moves_m = math::quantile(course, kPolicy.dead.most_places) -
                           math::quantile(course, 1.0 - kPolicy.dead.most_places);
    if (moves_m > context.of_length(kPolicy.dead.moves)) accused.push_back({signal, moves_m, left});
  }
  return accused;
}

/// That a trial says nothing of an input is then the lesser word.
void take_back_never_driven(Context& context, const std::string& input) {
  auto& all = context.findings;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const CheckFinding& f) { return f.id == "never_driven" && f.where == input; }),
            all.end());
}

void say_dead(Context& context, const std::string& names, const std::string& what, double moves_m) {
  CheckFinding& finding = context.add("dead_input", names, what);
  finding.figure = moves_m;
  finding.unit = "m";
  finding.remedy =
      "a sensor that is not connected, or the topic or column of another one: leave the trial out of "
      "identify. Nothing is wrong if the arm was moved by hand";
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
  if (dead.empty()) {
    if (!any_drives) return;
    for (const Accused& one : accused_of(context, constant)) {
      take_back_never_driven(context, one.signal->input->name);
      say_dead(context, one.signal->input->name,
               fmt::format("constant throughout, while the arm moves by {:.0f} mm along the line on which "
                           "this input bends it: {:.0f} % of all motion, which no other input explains",
                           1e3 * one.moves_m, 100.0 * one.share),
               one.moves_m);
    }
    return;
  }
  std::string names;
  for (const Signal* signal : dead) {
    names += (names.empty() ? "" : ", ") + signal->input->name;
    take_back_never_driven(context, signal->input->name);
  }
  std::string what = fmt::format("constant throughout, while the arm moves by {:.0f} mm", 1e3 * moves_m);
  if (!any_drives) {
    what += " and no input drives it";
  } else if (unexplained) {
    what += fmt::format(", of which the other inputs explain {:.0f} %",
                        100.0 * std::max(0.0, *context.explained));
  } else {
    what += ", and constant to the last bit, although the other sensors have noise";
  }
  say_dead(context, names, what, moves_m);
}

}  // namespace

Check make_dead_inputs() {
  return {check_dead_inputs, {{"dead_input", Severity::kWarning}}};
}

}  // namespace softarm::check
