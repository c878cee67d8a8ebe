// softarm new-arm: an annotated arm file and a layout from a few answers, or flags.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "command.h"
#include "new_arm_answers.h"
#include "new_arm_text.h"
#include "output_file.h"
#include "say.h"
#include "softarm/arm/arm_file.h"
#include "trial/csv_layout.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNewArmExamples = R"(Examples:
  softarm new-arm                                                             asks on a terminal
  softarm new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators 3
    --bodies 4 --out my_arm.yaml
  softarm new-arm --kind chambers,tendons+central --segments 2 --length 0.12,0.1 --mass 0.12,0.08 --diameter 0.04,0.03
    --actuators 3,2 --angles 0,120,240/0,90 --bodies ring_1:0.12,tip:0.22 --base hanging --out my_arm.yaml
Give one value for all segments, or one for each, separated by commas; '/' separates the lists of angles.)";

Replacing replacing_of(const Told& told, bool force) {
  Replacing replacing = Replacing::of_this_run(force);
  for (const auto& [flag, answer] : told) replacing.command += fmt::format(" {}={}", flag, answer);
  return replacing;
}

fs::path layout_of(const Told& told) {
  const fs::path out = told.at("out");
  const fs::path layout = told.count("layout") ? fs::path(told.at("layout"))
                                               : out.parent_path() / (out.stem().string() + "_layout.yaml");
  if (out == layout) throw Failure(fmt::format("--layout {}: is already the arm file", layout.string()));
  return layout;
}

/// Whether a file can be written, before all else is asked.
void refuse_file(const std::string& flag, const fs::path& path, const Replacing& replacing) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder))
    throw Failure(fmt::format("--{} {}: the folder {} does not exist", flag, path.string(), folder.string()));
  if (fs::is_directory(path)) throw Failure(fmt::format("--{} {}: is a folder", flag, path.string()));
  refuse_to_replace(path, replacing);
}

/// Something to be told, by a flag or by an answer.
struct Question {
  const char* flag;
  const char* asks;
  const char* fallback;  ///< null: must be told
  const char* only_for;  ///< null: always; else where a segment has some of it
  /// Throws where the answer cannot be, with all that was told before it.
  void (*check)(const Told& told, bool force);
};

const Question kQuestions[] = {
    {"kind", "what drives each segment: chambers, tendons, cables, central, or several joined by +", nullptr,
     nullptr,
     [](const Told& told, bool) {
       for (const std::string& kind : parts(told.at("kind"), ',')) drive_of(kind);
     }},
    {"segments", "how many segments", nullptr, nullptr, [](const Told& told, bool) { drives_of(told); }},
    {"length", "length of each segment at zero input, m", nullptr, nullptr,
     [](const Told& told, bool) { lengths_of(told); }},
    {"mass", "mass of each segment, kg", nullptr, nullptr, [](const Told& told, bool) { masses_of(told); }},
    {"diameter", "outer diameter of each segment, m", nullptr, nullptr,
     [](const Told& told, bool) { diameters_of(told); }},
    {"actuators", "how many chambers, tendons or cables (of each kind) a segment has", nullptr, "bending",
     [](const Told& told, bool) {
       for (const std::string& count : per_segment(told, "actuators", count_of(told)))
         whole("actuators", count, 32.0);
     }},
    {"bodies",
     "measured bodies besides the base: how many, evenly spaced, or name:arclength (m), from base to tip",
     nullptr, nullptr, [](const Told& told, bool) { bodies_of(told); }},
    {"angles", "directions in which the actuators bend the arm, deg", "evenly spaced", "bending",
     [](const Told& told, bool) { all_angles_of(told); }},
    {"base", "body that carries the base; or, if no body does: hanging, standing or horizontal", "base",
     nullptr, [](const Told& told, bool) { base_of(told); }},
    {"stiffness", "bending stiffness EI of each segment, N m^2", "a guess from the diameter", nullptr,
     [](const Told& told, bool) { stiffnesses_of(told); }},
    {"out", "the arm file to write", nullptr, nullptr,
     [](const Told& told, bool force) { refuse_file("out", told.at("out"), replacing_of(told, force)); }},
    {"layout", "the layout to write", "NAME_layout.yaml beside the arm file", nullptr,
     [](const Told& told, bool force) {
       refuse_file("layout", layout_of(told), replacing_of(told, force));
     }}};

Failure missing_answer(const Question& q) {
  return Failure(fmt::format("--{} is missing: {}", q.flag, q.asks), 2);
}

/// Asks until an answer can be, or none is given where that will do.
void ask(const Question& q, Told& told, bool force) {
  for (std::string answer;;) {
    say("{}{}: ", q.asks, q.fallback ? fmt::format(" [{}]", q.fallback) : "");
    std::fflush(stdout);
    if (!std::getline(std::cin, answer)) {
      say("\n");
      throw missing_answer(q);
    }
    boost::trim(answer);
    if (answer.empty() && q.fallback) return;
    if (answer.empty()) continue;
    told[q.flag] = answer;
    try {
      return q.check(told, force);
    } catch (const Failure& refused) {
      told.erase(q.flag);
      say("  {}\n", std::string(refused.what()).substr(std::string("--").size()));
    }
  }
}

/// Takes the flags, and asks for the rest where somebody is there to answer.
void complete(Told& told, bool terminal, bool force) {
  const auto applies = [&](const Question& q) { return !q.only_for || any_bends(told); };
  const auto missing = [&](const Question& q) { return applies(q) && told.count(q.flag) == 0; };
  const bool asks = terminal && std::any_of(std::begin(kQuestions), std::end(kQuestions),
                                            [&](const Question& q) { return !q.fallback && missing(q); });
  for (const Question& q : kQuestions) {
    if (!missing(q)) {
      if (asks && applies(q)) q.check(told, force);
    } else if (asks) {
      ask(q, told, force);
    } else if (!q.fallback) {
      throw missing_answer(q);
    }
  }
}

void run_new_arm(Told told, bool force) {
  complete(told, isatty(STDIN_FILENO) != 0, force);
  const NewArm arm = arm_of(told);
  const fs::path out = told.at("out"), layout = layout_of(told);
  const std::string text = arm_text(arm), columns = layout_text(arm);
  // Nothing is written that the loaders refuse.
  arm::parse_arm(text, out.string());
  trial::parse_csv_layout(columns, layout.string());
  const Replacing replacing = replacing_of(told, force);
  OutputFile arm_file(out, replacing), layout_file(layout, replacing);
  arm_file.write(text);
  layout_file.write(columns);
  arm_file.commit();
  layout_file.commit();
  say("{}: {} segment{}, {:g} m, {} bod{}; look for GUESS\n{}: the column layout of its recordings\n",
      out.string(), arm.segments.size(), arm.segments.size() == 1 ? "" : "s", arm.length_m(),
      arm.bodies.size(), arm.bodies.size() == 1 ? "y" : "ies", layout.string());
}

}  // namespace

void add_new_arm(CLI::App& program) {
  const auto told = std::make_shared<Told>();
  const auto force = std::make_shared<bool>(false);
  CLI::App* command =
      program.add_subcommand("new-arm", "Write an annotated arm file and a layout from a few answers.");
  for (const Question& q : kQuestions) {
    const std::string flag = q.flag;
    command->add_option_function<std::string>(
        "--" + flag, [told, flag](const std::string& value) { (*told)[flag] = value; },
        q.fallback ? fmt::format("{} (default: {})", q.asks, q.fallback) : q.asks);
  }
  command->add_flag("--force", *force, kForceMeaning);
  command->footer(kNewArmExamples);
  command->callback([told, force] { run_new_arm(*told, *force); });
}

}  // namespace softarm::app
