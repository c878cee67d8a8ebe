// softarm identify: trials to the constants of an arm's laws.
#include "softarm/identify/identify.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "arm/arm_writer.h"
#include "command.h"
#include "identify/arm_file_header.h"
#include "identify/identify_extended.h"
#include "identify/releases.h"
#include "identify_tables.h"
#include "model/effect.h"
#include "output_file.h"
#include "progress.h"
#include "published/pull.h"
#include "read_trials.h"
#include "say.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct IdentifyOptions {
  std::string arm;
  std::vector<std::string> bags;
  std::string out, json, plot;
  std::string procedure = "fit";
  identify::Options fit;
  bool moving = false, not_robust = false, plot_all = false, force = false;
  std::optional<double> payload_kg;
  unsigned jobs = 0;
};

constexpr const char* kIdentifyExamples = R"(Examples:
  softarm identify --arm my_arm.yaml trials/*.bag --out my_arm_identified.yaml
  softarm identify --arm my_arm.yaml *.bag --out new.yaml --hold-out trial_7 --also-free length
  softarm identify --arm my_arm.yaml *.bag --out new.yaml --free '*.moment_gain,*.bending_stiffness.*'
  softarm identify --arm my_arm.yaml few/*.bag --out new.yaml --leave-one-out
  softarm identify --arm my_arm.yaml *.bag --out new.yaml --hold '*.bending_stiffness.*' --also-free saturation
  softarm identify --arm my_arm.yaml *.bag --procedure pull
  softarm identify --arm my_arm.yaml released/*.bag --procedure release
Constants are named <segment>.<what>: segment_1.chamber_2.moment_gain, segment_1.bending_stiffness.base,
segment_1.tendon_1.offset, segment_1.length ...; patterns may have * and ?; the last part alone will do.
What the arm file has no value for (saturation, growth of EI, joint_compliance) is 0, and freed by its name alone.)";

/// Says what was found, which may have taken minutes, when its files are written: a reader of the text that
/// went away takes no file away. Where they cannot be written it is said all the same.
template <typename Write>
void write_and_say(const std::string& found, const Write& write) {
  try {
    write();
  } catch (...) {
    say_text(found);
    std::fflush(stdout);
    throw;
  }
  say_text(found);
}

void fit(const IdentifyOptions& options, const arm::Arm& arm) {
  if (options.out.empty()) throw Failure("--out is needed: the arm file to be written");
  // Before any work: whether the results have a place.
  const Replacing replacing = Replacing::of_this_run(options.force);
  OutputFile out(options.out, replacing);
  std::optional<ResultsFolder> folder;
  std::optional<OutputFile> json, shapes, constants;
  if (!options.json.empty()) json.emplace(options.json, replacing);
  if (!options.plot.empty()) {
    folder.emplace(options.plot);
    shapes.emplace(fs::path(options.plot) / "shapes.csv", replacing);
    constants.emplace(fs::path(options.plot) / "constants.csv", replacing);
  }
  const fs::path source = find_config("arms", options.arm);
  const std::string text = read_text(source);
  const std::vector<model::Present> effects =
      effects::effects_of(arm, arm::parse_effect_entries(text, source.string()));
  for (const model::Present& present : effects)
    fmt::print(stderr, "softarm: effects: {} is in the model, held at the arm file's values\n",
               present.effect->info().id);

  const std::vector<trial::Trial> trials = read_trials(options.bags, arm, !options.payload_kg, options.jobs);
  identify::Result result;
  {
    Progress progress("steps");
    progress.add_total(1.0);
    double done = 0.0;
    result = identify::identify_extended(
        arm, effects, trials, options.fit,
        [&](double share) { progress.advance(share - std::exchange(done, share), 1); }, options.jobs);
  }
  write_and_say(
      fmt::format("{}\narm: {}\n{}", identify::verdict(result), arm.name, identify::describe(result)), [&] {
        out.write(arm::update_arm_text(text, source.string(), result.arm, identify::arm_file_header(result)));
        if (json) json->write(identify::to_json(result));
        if (shapes) {
          shapes->write(shapes_csv(arm, result, trials,
                                   options.plot_all ? identify::FrameChoice{0, false} : options.fit.frames));
          constants->write(constants_csv(result));
        }
        out.commit();
        if (json) json->commit();
        if (shapes) shapes->commit();
        if (constants) constants->commit();
      });
  say("written: {}\n", options.out);
  if (shapes) say("written: {0}; scripts/plot_identify.py {0} --out picture.png draws it\n", options.plot);
}

void pull(const IdentifyOptions& options, const arm::Arm& arm) {
  if (!effects::load_effects(arm, options.arm, config_folders("arms")).empty())
    throw Failure(fmt::format("{}: key 'effects': the pull procedure knows no effects; leave --procedure out",
                              options.arm));
  std::optional<OutputFile> out;
  if (!options.out.empty()) out.emplace(options.out, Replacing::of_this_run(options.force));
  const std::vector<trial::Trial> trials = read_trials(options.bags, arm, !options.payload_kg, options.jobs);
  const std::vector<published::Pull> pulls = published::find_pulls(arm, trials);
  if (pulls.empty())
    throw Failure(
        "no pull in these trials: the payload must change while the inputs are held, with the arm at rest "
        "before and after");
  say_text(published::describe(arm, trials, pulls));
  if (!out) return;
  const published::ThreeTruths truths =
      published::fit_three_truths(arm, pulls, published::LoadLaw::kStatics, true);
  const fs::path source = find_config("arms", options.arm);
  const std::string text = read_text(source);
  write_and_say(
      fmt::format(
          "laws fitted to {} pulls: they leave {:.2f} mm of length, {:.5f} N m^2 of stiffness, {:.4f} N m "
          "of moment (rms)\n",
          truths.pulls, 1e3 * truths.length_rms_m, truths.stiffness_rms_nm2, truths.moment_rms_nm),
      [&] {
        out->write(arm::update_arm_text(
            text, source.string(), truths.arm,
            {fmt::format("constants by the pull procedure from {} pulls", truths.pulls)}));
        out->commit();
      });
  say("written: {}\n", options.out);
}

void releases(const IdentifyOptions& options, const arm::Arm& arm) {
  if (!options.out.empty()) throw Failure("--out: the release procedure writes no arm file");
  const std::vector<trial::Trial> trials = read_trials(options.bags, arm, !options.payload_kg, options.jobs);
  say_text(identify::describe(identify::fit_releases(arm, trials)));
}

void run_identify(IdentifyOptions options) {
  arm::Arm arm = arm::load_arm_file(options.arm, config_folders("arms"));
  if (options.payload_kg) assume_payload(arm, *options.payload_kg);
  options.fit.frames.prefer_static = !options.moving;
  options.fit.robust = !options.not_robust;
  try {
    if (options.procedure == "pull") {
      pull(options, arm);
    } else if (options.procedure == "release") {
      releases(options, arm);
    } else {
      fit(options, arm);
    }
  } catch (const std::invalid_argument& error) {
    throw Failure(error.what());
  }
}

}  // namespace

void add_identify(CLI::App& program) {
  const auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command =
      program.add_subcommand("identify", "Fit the constants of an arm's laws to trials, with uncertainties.");
  command->add_option("--arm", options->arm, "arm file, or the name of one in config/arms: the start")
      ->required();
  command->add_option("BAG", options->bags, "trial bags, each one trial")->required();
  command->add_option("--out", options->out, "the arm file to be written: --arm's with the new values");
  command->add_option("--json", options->json, "also writes the result for programs");
  command->add_option("--plot", options->plot,
                      "folder for shapes.csv and constants.csv (scripts/plot_identify.py)");
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_flag("--plot-all", options->plot_all,
                    "shapes.csv holds all frames, in motion too, not only those chosen");
  command
      ->add_option(
          "--procedure", options->procedure,
          "fit: all frames together; pull: stiffness from each step of the payload at held inputs; release: "
          "frequency, damping and friction from an arm that a hand lets go, at inputs of 0")
      ->check(CLI::IsMember({"fit", "pull", "release"}))
      ->capture_default_str();
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* meaning) {
    // One value, or several with commas, so that a bag may follow.
    command->add_option(name, values, meaning)->delimiter(',')->allow_extra_args(false);
  };
  list("--free", options->fit.free, "constants to fit (default: all but length, rest_curvature)");
  list("--also-free", options->fit.also_free, "constants to fit beside those");
  list("--hold", options->fit.held, "constants to keep");
  list("--tie", options->fit.tied,
       "constants that have one value in all segments: '*.bending_stiffness.base' of segments of one make");
  list("--hold-out", options->fit.held_out,
       "unseen trials, by name: not fitted, but compared (default: every third)");
  command->add_option("--hold-out-share", options->fit.held_out_share, "share of the trials that stay unseen")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  command->add_flag("--leave-one-out", options->fit.leave_one_out,
                    "fit all trials, and predict each from a fit to the others");
  command->add_option("--seed", options->fit.seed, "draws the unseen trials at random; 0: evenly")
      ->capture_default_str();
  command->add_option("--frames", options->fit.frames.frames_per_trial, "frames per trial at most; 0: all")
      ->capture_default_str();
  command->add_flag("--moving", options->moving,
                    "use frames in motion as well where a trial has some at rest");
  command->add_flag("--not-robust", options->not_robust, "plain least squares: no body is set aside");
  command->add_flag("--exact-inputs", options->fit.exact_inputs,
                    "take inputs as recorded, without noise and zeros of their sensors");
  command->add_option("--payload", options->payload_kg,
                      "the known payload, kg; the bags' payload topic is not read");
  command->add_option("--jobs", options->jobs, "bags read at a time (default: one per processor)")
      ->check(CLI::Range(1u, 256u));
  command->footer(kIdentifyExamples);
  command->callback([options] { run_identify(*options); });
}

}  // namespace softarm::app
