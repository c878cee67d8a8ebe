// softarm estimate: the live node's estimator over recorded bags.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "command.h"
#include "estimate/estimate_summary.h"
#include "estimate/estimates_csv.h"
#include "math/parallel.h"
#include "monitor/alarm_list.h"
#include "output_file.h"
#include "progress.h"
#include "ros/bag_frames.h"
#include "say.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct EstimateOptions {
  std::string arm;
  std::vector<std::string> bags;
  std::optional<std::string> method, unknown, objective, dynamics, prior;
  std::optional<double> payload_kg, window_s;
  std::string out = "estimates";
  bool force = false;
  unsigned jobs = 0;
};

constexpr const char* kEstimateExamples = R"(Examples:
  softarm estimate --arm online_200mm trial.bag
  softarm estimate --arm my_arm.yaml *.bag --unknown payload --out results
  softarm estimate --arm my_arm.yaml trial.bag --method end_orientation --payload 0.2
  softarm estimate --arm my_arm.yaml trial.bag --unknown both --prior on --window 0.5
  softarm estimate --arm report/arm_extended.yaml trial.bag    with what `softarm diagnose` found in the model
Writes OUT/<bag name>/estimates.csv (one row per frame and segment, SI units) and summary.txt.)";

// Base and tip are all that is written; the alarms look at the shape in between.
constexpr int kBackbonePoints = 21;

/// One bag's way through the estimator.
struct Job {
  std::string bag;
  fs::path folder;
  Replacing replacing;
  std::string summary;  ///< what is printed once it is done
  std::vector<std::string> warnings;
  std::string failure;  ///< empty: done
};

template <typename Parse>
auto word(const char* option, const std::string& text, Parse parse) {
  try {
    return parse(text);
  } catch (const std::invalid_argument& e) {
    throw Failure(fmt::format("{}: {}", option, e.what()));
  }
}

arm::Arm load_arm(const EstimateOptions& options) {
  arm::Arm arm = arm::load_arm_file(options.arm, config_folders("arms"));
  if (options.method) arm.estimator.method = word("--method", *options.method, arm::parse_method);
  if (options.unknown) arm.estimator.unknown = word("--unknown", *options.unknown, arm::parse_unknown);
  if (options.objective)
    arm.estimator.objective = word("--objective", *options.objective, arm::parse_objective);
  if (options.dynamics) arm.estimator.dynamics = word("--dynamics", *options.dynamics, arm::parse_dynamics);
  if (options.prior) arm.estimator.prior.enabled = *options.prior == "on";
  if (options.window_s) arm.estimator.window_s = *options.window_s;
  if (options.payload_kg) assume_payload(arm, *options.payload_kg);
  return arm;
}

std::vector<Job> make_jobs(const EstimateOptions& options) {
  const Replacing replacing = Replacing::of_this_run(options.force);
  std::vector<Job> jobs;
  std::set<fs::path> folders;
  for (const std::string& bag : options.bags) {
    std::error_code error;
    if (!fs::is_regular_file(bag, error)) throw Failure(fmt::format("{}: no such bag", bag));
    jobs.push_back({bag, fs::path(options.out) / fs::path(bag).stem(), replacing, "", {}, ""});
    if (!folders.insert(jobs.back().folder).second) {
      throw Failure(fmt::format("{}: another bag has the same name and would have the same output {}", bag,
                                jobs.back().folder.string()));
    }
    for (const char* file : {"estimates.csv", "summary.txt"})
      refuse_to_replace(jobs.back().folder / file, replacing);
  }
  return jobs;
}

std::string effect_lines(const estimate::Estimator& estimator) {
  std::string text;
  for (const std::string& note : estimator.effect_notes())
    text += fmt::format("{:<28}{}\n", "effects:", note);
  return text;
}

void estimate_bag(const arm::Arm& arm, const std::vector<model::Present>& effects, bool use_payload, Job& job,
                  Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  estimate::Estimator estimator(arm, arm.estimator, effects);
  estimator.set_backbone_points(kBackbonePoints);
  BagFrames bag(job.bag, arm, use_payload);
  progress.add_total(static_cast<double>(bag.messages()));

  const ResultsFolder folder(job.folder);
  OutputFile csv(job.folder / "estimates.csv", job.replacing);
  OutputFile text(job.folder / "summary.txt", job.replacing);
  std::ofstream rows(csv.temporary());
  rows << estimate::estimates_csv_header() << '\n';
  estimate::EstimateSummary summary(arm);
  monitor::MismatchMonitor monitor(arm);
  monitor::AlarmList alarms;
  std::uint64_t frames = 0;
  BagFrames::Callbacks callbacks;
  callbacks.on_frame = [&](const trial::Frame& frame) {
    const estimate::Estimate& estimate = estimator.estimate(frame);
    estimate::write_estimate_rows(rows, estimate, arm.segments.size());
    summary.add(estimate);
    const estimate::Estimator::ByLaws plain = estimator.by_laws();
    alarms.add(monitor.add(plain.frame, plain.estimate));
    ++frames;
  };
  callbacks.on_time_jump = [&] {
    estimator.reset();
    monitor.reset();
    alarms.interrupt();
  };
  callbacks.on_messages = [&](std::uint64_t messages) {
    progress.advance(static_cast<double>(messages), std::exchange(frames, 0));
  };
  bag.read(callbacks);
  job.warnings = bag.warnings();
  if (summary.frames() == 0) {
    throw Failure(fmt::format("{}: no frame could be put together out of {} samples: {}", job.bag,
                              bag.assembler().samples(), summary.why_none(bag.assembler().rejected())));
  }
  const std::string table =
      fmt::format("{:<28}{}\n{:<28}{}\n{:<28}{}, unknown: {}, prior: {}, window: {:g} s, dynamics: {}\n",
                  "bag:", fs::path(job.bag).filename().string(), "arm:", arm.name,
                  "method:", to_string(arm.estimator.method), to_string(arm.estimator.unknown),
                  arm.estimator.prior.enabled ? "on" : "off", arm.estimator.window_s,
                  to_string(arm.estimator.dynamics)) +
      effect_lines(estimator) + summary.text(bag.assembler().rejected(), bag.assembler().samples()) +
      alarms.text();
  // How long it took is printed but not written: the same bag gives the same files. Before they are: a full
  // disk must not take the table away.
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  job.summary = table + fmt::format("frames_per_s: {:.0f}\nspeed: {:.1f} x real time\n",
                                    static_cast<double>(summary.frames()) / wall.count(),
                                    summary.duration_s() / wall.count());
  finish(rows, csv.path());
  text.write(table);
  csv.commit();
  text.commit();
  job.summary += fmt::format("written: {}\n", csv.path().string());
  if (summary.ok() == 0)
    job.failure = fmt::format("{}: not one of {} frames could be estimated: {}", job.bag, summary.frames(),
                              summary.why_none(bag.assembler().rejected()));
}

void run_estimate(const EstimateOptions& options) {
  const arm::Arm arm = load_arm(options);
  const std::vector<model::Present> effects = effects::load_effects(arm, options.arm, config_folders("arms"));
  for (const std::string& line : estimate::Estimator(arm, arm.estimator, effects).effect_notes())
    fmt::print(stderr, "softarm: effects: {}\n", line);
  const std::string doubt = effects::doubt_about_effects(options.arm, config_folders("arms"));
  if (!doubt.empty()) fmt::print(stderr, "softarm: warning: {}\n", doubt);
  const std::string note = estimate::advice(arm.estimator);
  if (!note.empty()) fmt::print(stderr, "softarm: note: {}\n", note);
  std::vector<Job> jobs = make_jobs(options);
  {
    Progress progress("frames");
    math::in_parallel(jobs.size(), options.jobs, [&](std::size_t i) {
      try {
        estimate_bag(arm, effects, !options.payload_kg, jobs[i], progress);
      } catch (const std::exception& e) {  // the other bags go on
        jobs[i].failure = e.what();
      }
    });
  }
  std::string failure;
  for (const Job& job : jobs) {
    for (const std::string& warning : job.warnings) fmt::print(stderr, "softarm: warning: {}\n", warning);
    if (!job.summary.empty()) say("{}\n", job.summary);
    std::fflush(stdout);  // before what is said of it
    if (job.failure.empty()) continue;
    if (failure.empty()) {
      failure = job.failure;
    } else {
      fmt::print(stderr, "softarm: {}\n", job.failure);
    }
  }
  if (!failure.empty()) throw Failure(failure);
}

}  // namespace

void add_estimate(CLI::App& program) {
  const auto options = std::make_shared<EstimateOptions>();
  CLI::App* command = program.add_subcommand("estimate", "Estimate every frame of recorded bags.");
  command->add_option("--arm", options->arm, "arm file, or the name of one in config/arms")->required();
  command->add_option("BAG", options->bags, "trial bags")->required();
  // Words in braces are what a shell completes; what they mean to an arm is said where they are read.
  command
      ->add_option("--method", options->method, "how the shape follows from the bodies (default: the arm's)")
      ->type_name("TEXT:{full_points,end_orientation,cc_points,cc_endpoint}");
  command
      ->add_option("--unknown", options->unknown,
                   "what is estimated beside the shape; both needs the prior (default: the arm's)")
      ->type_name("TEXT:{stiffness,payload,both}");
  command
      ->add_option("--prior", options->prior,
                   "on or off: the arm's laws, at the recorded inputs, as a prior (default: the arm's)")
      ->check(CLI::IsMember({"on", "off"}));
  command
      ->add_option("--window", options->window_s,
                   "frames within this last time share EI and payload, s; 0: each frame by itself (default: "
                   "the arm's)")
      ->check(CLI::Range(0.0, 60.0));
  command->add_option("--objective", options->objective, "what is minimised (default: the arm's)")
      ->type_name("TEXT:{least_squares,sum_of_distances}");
  command
      ->add_option("--dynamics", options->dynamics,
                   "modal: swings are followed, not fitted as if at rest (default: the arm's)")
      ->type_name("TEXT:{static,modal}");
  command->add_option("--payload", options->payload_kg,
                      "the known payload, kg; the bag's payload topic is not read");
  command->add_option("--out", options->out, "folder of the results")->capture_default_str();
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_option("--jobs", options->jobs, "bags worked on at a time (default: one per processor)")
      ->check(CLI::Range(1u, 256u));
  command->footer(kEstimateExamples);
  command->callback([options] { run_estimate(*options); });
}

}  // namespace softarm::app
