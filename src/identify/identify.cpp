#include "softarm/identify/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <random>
#include <stdexcept>

#include "advice.h"
#include "choose_constants.h"
#include "choose_frames.h"
#include "compare_frames.h"
#include "effect_lines.h"
#include "input_report.h"
#include "joint_fit.h"
#include "law_errors.h"
#include "limits.h"
#include "motion.h"

namespace softarm::identify {
namespace {

// A fit that is worse than its start by this factor has gone astray; less is which frames were chosen.
constexpr double kWorse = 1.05;

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<bool> choose_held_out(const std::vector<trial::Trial>& trials, const Options& options) {
  std::vector<bool> held(trials.size(), false);
  if (!options.held_out.empty()) {
    for (const std::string& name : options.held_out) {
      bool any = false;
      for (std::size_t t = 0; t < trials.size(); ++t) {
        if (trials[t].name != name) continue;
        held[t] = any = true;
      }
      if (any) continue;
      std::string names;
      for (const trial::Trial& trial : trials) names += (names.empty() ? "" : ", ") + trial.name;
      throw std::invalid_argument(
          fmt::format("'{}' is no trial that could stay unseen; there are {}", name, names));
    }
    if (std::count(held.begin(), held.end(), false) == 0)
      throw std::invalid_argument("all trials are to stay unseen: nothing is left to fit");
    return held;
  }
  if (trials.size() < 3 || !(options.held_out_share > 0.0) || options.leave_one_out) return held;
  const double share = std::min(options.held_out_share, 0.9);
  const auto wanted = static_cast<double>(trials.size()) * share;
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(wanted + 1e-9), 1, trials.size() - 1);
  if (options.seed == 0) {  // evenly over the order in which they were given, the last of each group
    for (std::size_t k = 1; k <= count; ++k) held[k * trials.size() / count - 1] = true;
    return held;
  }
  std::vector<std::size_t> order(trials.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937_64 random(options.seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(order[i], order[i + random() % (order.size() - i)]);
    held[order[i]] = true;
  }
  return held;
}

std::string reasons(const std::map<std::string, std::uint64_t>& left_out) {
  std::string text;
  for (const auto& [reason, count] : left_out)
    text += fmt::format("{}{} frames: {}", text.empty() ? "" : ", ", count, reason);
  return text.empty() ? "there are no frames" : text;
}

/// A law that has been zero so far needs its input as well once it may be otherwise.
arm::Arm with_all_inputs_needed(arm::Arm arm, const std::vector<ConstantRef>& free) {
  for (const ConstantRef& constant : free) {
    if (constant.kind == ConstantKind::kPerJammingPressure && value_of(arm, constant) == 0.0)
      set_value(arm, constant, 1e-30);
  }
  return arm;
}

/// Frames of one trial among all.
std::vector<FrameComparison> of_trial(const std::vector<FrameComparison>& all, std::size_t trial) {
  std::vector<FrameComparison> some;
  std::copy_if(all.begin(), all.end(), std::back_inserter(some),
               [&](const FrameComparison& f) { return f.trial == trial; });
  return some;
}

/// Errors of chosen frames before and after, over all and trial by trial.
/// @param starts of the walls, of the trials that were fitted
void compare_all(const arm::Arm& before, const std::vector<trial::StaticFrame>& frames, bool held_out,
                 const std::map<std::size_t, VectorXd>& starts, Result& result) {
  const auto old_shapes = compare_frames(before, frames);
  const auto new_shapes = compare_frames(result.arm, frames, starts);
  const double length = before.total_length_m(), new_length = result.arm.total_length_m();
  (held_out ? result.held_out_before : result.fitted_before) = summarise(old_shapes, length);
  (held_out ? result.held_out : result.fitted) = summarise(new_shapes, new_length);
  for (std::size_t t = 0; t < result.trials.size(); ++t) {
    TrialSummary& trial = result.trials[t];
    if (trial.held_out != held_out) continue;
    trial.before = summarise(of_trial(old_shapes, t), length);
    trial.after = summarise(of_trial(new_shapes, t), new_length);
  }
}

Result fit_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials, EffectLines* lines,
              const Options& options, const ProgressCallback& progress, bool better_of_both);

/// Each trial by the fit to all others.
void leave_one_out(const arm::Arm& arm, const std::vector<trial::Trial>& trials, EffectLines* lines,
                   Options options, Result& result, const ProgressCallback& progress) {
  options.leave_one_out = false;
  std::vector<FrameComparison> before, after;
  const std::vector<FrameComparison> old_shapes = compare(arm, trials, options.frames);
  for (std::size_t t = 0; t < trials.size(); ++t) {
    options.held_out = {trials[t].name};
    const Result fold = fit_of(
        arm, trials, lines, options,
        [&](double share) {
          progress((static_cast<double>(t) + share) / static_cast<double>(trials.size()));
        },
        false);
    result.left_out_one.push_back(fold.trials[t]);
    for (const FrameComparison& f : of_trial(old_shapes, t)) before.push_back(f);
    for (const FrameComparison& f : of_trial(compare(fold.arm, trials, options.frames), t))
      after.push_back(f);
  }
  result.left_out_one_before = summarise(before, arm.total_length_m());
  result.left_out_one_after = summarise(after, result.arm.total_length_m());
}

/// The frames that can be used, those of unseen trials apart.
struct Frames {
  std::vector<trial::StaticFrame> fitted, others;
};

/// @param free loses what the frames show nothing of
Frames frames_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const Options& options,
                 std::vector<ConstantRef>& free, Result& result) {
  const std::vector<bool> held_out = choose_held_out(trials, options);
  FrameSet all = choose_frames(arm, trials, options.frames);
  const Conditions conditions(arm, all.frames);
  free.erase(std::remove_if(free.begin(), free.end(),
                            [&](const ConstantRef& c) {
                              return c.kind == ConstantKind::kPerJammingPressure &&
                                     !conditions.vacuum_seen(c.segment);
                            }),
             free.end());
  const arm::Arm needing = with_all_inputs_needed(arm, free);
  all.frames.erase(std::remove_if(all.frames.begin(), all.frames.end(),
                                  [&](const trial::StaticFrame& f) {
                                    if (predict(needing, f.inputs)) return false;
                                    ++all.left_out["inputs missing or beyond the laws"];
                                    return true;
                                  }),
                   all.frames.end());
  result.left_out = all.left_out;
  for (std::size_t t = 0; t < trials.size(); ++t)
    result.trials.push_back({trials[t].name, held_out[t], 0, {}, {}});
  Frames frames;
  for (trial::StaticFrame& frame : all.frames) {
    ++result.trials[frame.trial].frames;
    (held_out[frame.trial] ? frames.others : frames.fitted).push_back(std::move(frame));
  }
  // Its own weight alone stretches an arm always alike: EA and length would be one number.
  const bool loads_differ =
      std::any_of(frames.fitted.begin(), frames.fitted.end(), [&](const trial::StaticFrame& frame) {
        return std::abs(frame.payload_kg - frames.fitted.front().payload_kg) > 1e-6;
      });
  free.erase(std::remove_if(free.begin(), free.end(),
                            [&](const ConstantRef& c) {
                              return c.kind == ConstantKind::kAxialStiffness && !loads_differ &&
                                     !strained_by_inputs(arm.segments[static_cast<std::size_t>(c.segment)]);
                            }),
             free.end());
  if (free.empty()) throw IdentifyError("nothing is left to fit: EA needs trials with different payloads");
  if (frames.fitted.empty())
    throw IdentifyError("no frame of the trials can be used: " + reasons(result.left_out));
  return frames;
}

double scale_of(const Conditions& conditions, const ConstantRef& ref, double value) {
  const double size = ref.kind == ConstantKind::kLength ? 0.0 : std::abs(value);
  return std::max(size, conditions.reference_scale(ref));
}

std::vector<FreeConstant> scaled(const arm::Arm& arm, const Conditions& conditions,
                                 const std::vector<ConstantRef>& free) {
  std::vector<FreeConstant> constants;
  for (const ConstantRef& ref : free) {
    FreeConstant constant{ref, value_of(arm, ref), 1.0, allowed_range(arm, ref)};
    constant.scale = scale_of(conditions, ref, constant.initial);
    constants.push_back(constant);
  }
  return constants;
}

/// What the fit used and set aside.
void count_used(const arm::Arm& arm, const JointFit& fit, const std::vector<trial::StaticFrame>& fitted,
                Result& result) {
  result.converged = fit.converged;
  result.iterations = fit.iterations;
  for (const bool solved : fit.solved) ++(solved ? result.frames : result.left_out["no equilibrium"]);
  for (const trial::StaticFrame& frame : fitted) {
    for (const trial::SeenBody& seen : frame.bodies) {
      if (seen.used) {
        ++result.bodies;
      } else {
        ++result.bodies_set_aside[arm.bodies[static_cast<std::size_t>(seen.body)].name];
      }
    }
  }
  for (const auto& [body, number] : fit.beyond_the_model)
    result.beyond_the_model[arm.bodies[static_cast<std::size_t>(body)].name] = number;
}

/// Values, how sure they are, and the arm with them.
void set_constants(const arm::Arm& arm, const std::vector<FreeConstant>& constants,
                   const Conditions& conditions, const Solution& solution, const VectorXd& scale,
                   Result& result) {
  const Uncertainty& sure = solution.sure;
  result.misfit = sure.misfit;
  result.position_rms_m = sure.position_rms_m;
  result.autocorrelation = sure.autocorrelation;
  result.uncertainty_factor = sure.factor;
  result.arm = arm;
  const int count = static_cast<int>(constants.size());
  for (int j = 0; j < count; ++j) {
    const FreeConstant& c = constants[static_cast<std::size_t>(j)];
    Constant made;
    made.ref = c.ref;
    made.name = name_of(arm, c.ref);
    made.unit = unit_of(c.ref.kind);
    made.initial = c.initial;
    made.value = solution.fit.theta[j];
    made.scale = scale_of(conditions, c.ref, made.value);
    const std::optional<double>& limit = solution.ran_to[static_cast<std::size_t>(j)];
    made.at_bound = limit.has_value();
    made.ran_to = limit.value_or(0.0);
    made.kept = solution.kept[static_cast<std::size_t>(j)];
    if (made.at_bound && is_none(made)) made.value = 0.0;
    result.constants.push_back(made);
    set_value(result.arm, c.ref, made.value);
  }
  result.covariance = scale.asDiagonal() * sure.covariance * scale.asDiagonal();
  result.correlation = MatrixXd::Identity(count, count);
  for (int j = 0; j < count; ++j) {
    result.constants[static_cast<std::size_t>(j)].sd = std::sqrt(result.covariance(j, j));
    for (int k = 0; k < j; ++k) {
      const double c = result.covariance(j, k) / std::sqrt(result.covariance(j, j) * result.covariance(k, k));
      result.correlation(j, k) = result.correlation(k, j) = std::clamp(c, -1.0, 1.0);
    }
  }
}

/// How the trials found walls and effects, and how sure that is.
void set_starts(const LawModel& model, const EffectLines* lines, const Solution& solution, Result& result) {
  const Eigen::Index walls = model.start_sd().size();
  for (const auto& [trial, start] : solution.fit.starts) {
    const std::string& name = result.trials[trial].name;
    const VectorXd& effects = solution.fit.effect_starts.at(trial);
    const auto known = solution.sure.start_sd.find(trial);
    const VectorXd sd = known == solution.sure.start_sd.end()
                            ? VectorXd(VectorXd::Ones(walls + effects.size()))
                            : known->second;
    for (Eigen::Index e = 0; e < effects.size(); ++e) {
      EffectStart of = lines->start(e);
      const double scale = of.sd;
      of.trial = name;
      of.value = scale * effects[e];
      if (of.unit == "1") of.value = std::clamp(of.value, -1.0, 1.0);  // a share: as the effect takes it
      of.sd = scale * sd[walls + e];
      result.effect_starts.push_back(of);
    }
    if (walls == 0) continue;
    Eigen::Index k = 0;
    // C++17 captures a structured binding only so.
    const auto add = [&, &start = start](const arm::Segment& segment, const std::string& element,
                                         const char* unit) {
      result.starts.push_back({name, segment.name, element, unit, start[k], model.start_sd()[k] * sd[k]});
      ++k;
    };
    for (const arm::Segment& segment : result.arm.segments) {
      for (std::size_t e = 1; e <= segment.wall.bending.size(); ++e) {
        for (const char* axis : {"x", "y"}) add(segment, fmt::format("bending_{}.{}", e, axis), "1/m");
      }
      for (std::size_t e = 1; e <= segment.wall.axial.size(); ++e)
        add(segment, fmt::format("axial_{}", e), "m");
    }
  }
}

/// Whether half of the frames or more are of an arm near its buckling load.
bool near_buckling(LawModel& model, const std::vector<trial::StaticFrame>& frames) {
  std::size_t near = 0, all = 0;
  for (const trial::StaticFrame& frame : frames) {
    std::optional<model::Equilibrium> equilibrium;
    Prediction predicted;
    if (!model.predict(frame, equilibrium, predicted)) continue;
    ++all;
    if (predicted.near_buckling) ++near;
  }
  return all > 0 && 2 * near >= all;
}

VectorXd initial_of(const std::vector<FreeConstant>& constants) {
  VectorXd initial(static_cast<Eigen::Index>(constants.size()));
  for (Eigen::Index j = 0; j < initial.size(); ++j)
    initial[j] = constants[static_cast<std::size_t>(j)].initial;
  return initial;
}

/// Puts the arm file's constants back where they predict better, trials that were not fitted if there are
/// such. @return whether it did
bool keep_the_better(const std::vector<FreeConstant>& constants, Result& result) {
  const bool by_others = !result.left_out_one.empty(), unseen = by_others || result.held_out.frames > 0;
  const ShapeError& before = by_others ? result.left_out_one_before
                             : unseen  ? result.held_out_before
                                       : result.fitted_before;
  const ShapeError& after = by_others ? result.left_out_one_after : unseen ? result.held_out : result.fitted;
  if (after.frames == 0 || !(after.mean_m > kWorse * before.mean_m)) return false;
  result.warnings.push_back(fmt::format(
      "THE FIT IS NO BETTER THAN THE ARM FILE: {} are off by {:.2f} mm with the fitted constants, by {:.2f} "
      "mm with those of the arm file, which are kept and written; below are those of the fit",
      unseen ? "unseen trials" : "the trials", 1e3 * after.mean_m, 1e3 * before.mean_m));
  for (const FreeConstant& constant : constants) set_value(result.arm, constant.ref, constant.initial);
  return true;
}

/// @param lines whose trials these are, or nullptr
/// @param better_of_both the arm file's constants stay where they predict better
Result fit_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials, EffectLines* lines,
              const Options& options, const ProgressCallback& progress, bool better_of_both) {
  if (options.leave_one_out && (trials.size() < 2 || !options.held_out.empty()))
    throw std::invalid_argument(
        options.held_out.empty()
            ? "each trial by the fit to the others: there is only one trial"
            : "unseen trials are given by name, or each is one in its turn (leave one out), not both");
  const double own_share = options.leave_one_out ? 1.0 / (1.0 + static_cast<double>(trials.size())) : 1.0;
  const auto report = [&](double share) {
    if (progress) progress(own_share * share);
  };
  std::vector<ConstantRef> free = choose_free(arm, options);
  Result result;
  Frames frames = frames_of(arm, trials, options, free, result);
  result.warnings = not_fitted(arm, options, free);
  report(0.05);

  const Conditions conditions(arm, frames.fitted);
  const std::vector<FreeConstant> constants = scaled(arm, conditions, free);
  VectorXd scale(static_cast<Eigen::Index>(constants.size()));
  for (Eigen::Index j = 0; j < scale.size(); ++j) scale[j] = constants[static_cast<std::size_t>(j)].scale;
  JointProblem problem(arm, constants, frames.fitted, options);
  if (lines != nullptr) problem.add(lines->line(constants, frames.fitted));
  const bool exact = lines != nullptr || options.exact_inputs;
  const SensorErrors errors = exact ? SensorErrors() : sensor_errors(arm, trials);
  problem.add(errors);
  problem.add(motion_of(arm, trials, frames.fitted));
  const Solution solution =
      solve(problem, constants, frames.fitted, options.determined_sd,
            [&](int iteration) { report(0.05 + 0.75 * iteration / (iteration + 10.0)); });
  count_used(arm, solution.fit, frames.fitted, result);
  set_constants(arm, constants, conditions, solution, scale, result);
  report_input_errors(arm, trials, errors, problem, scale, result);
  problem.model().set(solution.fit.theta);
  judge(arm, frames.fitted, solution.sure, scale, options.determined_sd,
        near_buckling(problem.model(), frames.fitted), result);
  report(0.85);

  // Errors, and what they leave to a prior.
  compare_all(arm, frames.fitted, false, solution.fit.starts, result);
  compare_all(arm, frames.others, true, {}, result);
  set_starts(problem.model(), lines, solution, result);
  report(0.95);
  if (options.leave_one_out)
    leave_one_out(arm, trials, lines, options, result, [&](double share) {
      if (progress) progress(own_share * 0.95 + (1.0 - own_share) * share);
    });
  std::vector<trial::StaticFrame> all = frames.fitted;
  all.insert(all.end(), frames.others.begin(), frames.others.end());
  const bool kept = better_of_both && keep_the_better(constants, result);
  problem.model().set(kept ? initial_of(constants) : solution.fit.theta);
  result.prior = law_errors(arm, problem.model(), all, result.covariance, covariance_given_moduli(result));
  prior_of_moduli(arm, result);
  result.arm.estimator.prior = result.prior;
  if (progress) progress(1.0);
  return result;
}

}  // namespace

Result identify(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const Options& options,
                const ProgressCallback& progress) {
  return fit_of(arm, trials, nullptr, options, progress, true);
}

Result identify_with(const arm::Arm& arm, EffectLines& lines, const Options& options,
                     const ProgressCallback& progress) {
  return fit_of(arm, lines.without_effects(), &lines, options, progress, false);
}

}  // namespace softarm::identify
