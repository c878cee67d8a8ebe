// softarm new-arm: an annotated arm file and a layout from a few answers, or flags.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "command.h"
#include "math/parse_number.h"
#include "new_arm_text.h"
#include "output_file.h"
#include "softarm/arm/arm_file.h"
#include "trial/csv_layout.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

/// Something to be told, by a flag or by an answer.
struct Question {
  const char* flag;
  const char* asks;
  const char* fallback;  ///< null: must be told
  const char* only_for;  ///< null: always; else where a segment has some of it
};

constexpr Question kQuestions[] = {
    {"kind", "what drives each segment: chambers, tendons, cables, central, or several joined by +", nullptr,
     nullptr},
    {"segments", "how many segments", nullptr, nullptr},
    {"length", "length of each segment at zero input, m", nullptr, nullptr},
    {"mass", "mass of each segment, kg", nullptr, nullptr},
    {"diameter", "outer diameter of each segment, m", nullptr, nullptr},
    {"actuators", "how many chambers, tendons or cables (of each kind) a segment has", nullptr, "bending"},
    {"bodies",
     "measured bodies besides the base: how many, evenly spaced, or name:arclength (m), from base to tip",
     nullptr, nullptr},
    {"angles", "their directions of bending, deg", "evenly spaced", "bending"},
    {"base", "body that carries the base, or hanging, standing, horizontal where none does", "base", nullptr},
    {"stiffness", "bending stiffness EI of each segment, N m^2", "a guess by the diameter", nullptr},
    {"out", "the arm file to write", nullptr, nullptr},
    {"layout", "the layout to write", "beside it, NAME_layout.yaml", nullptr}};

constexpr const char* kNewArmExamples = R"(Examples:
  softarm new-arm                                                             asks on a terminal
  softarm new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators 3
    --bodies 4 --out my_arm.yaml
  softarm new-arm --kind chambers,tendons+central --segments 2 --length 0.12,0.1 --mass 0.12,0.08 --diameter 0.04,0.03
    --actuators 3,2 --angles 0,120,240/0,90 --bodies ring_1:0.12,tip:0.22 --base hanging --out my_arm.yaml
One value counts for all segments, or a comma parts one for each; '/' parts the lists of angles.)";

using Told = std::map<std::string, std::string>;

std::vector<std::string> parts(const std::string& text, char at) {
  std::vector<std::string> all;
  boost::split(all, text, [at](char c) { return c == at; });
  for (std::string& part : all) boost::trim(part);
  return all;
}

/// One for each segment.
std::vector<std::string> per_segment(const Told& told, const std::string& flag, std::size_t segments,
                                     char at = ',') {
  std::vector<std::string> all = parts(told.at(flag), at);
  if (all.size() == 1) all.resize(segments, all.front());
  if (all.size() != segments)
    throw Failure(fmt::format("--{} {}: must be one value, or {}, one for each segment", flag, told.at(flag),
                              segments));
  return all;
}

double number_of(const std::string& flag, const std::string& text, double low, double high) {
  const std::optional<double> value = math::parse_number(text);
  if (!value || !(*value >= low && *value <= high))
    throw Failure(fmt::format("--{} {}: must be a number from {:g} to {:g}", flag, text, low, high));
  return *value;
}

std::size_t whole(const std::string& flag, const std::string& text, double most) {
  const double value = number_of(flag, text, 1.0, most);
  if (value != std::floor(value)) throw Failure(fmt::format("--{} {}: must be a whole number", flag, text));
  return static_cast<std::size_t>(value);
}

NewDrive drive_of(const std::string& text) {
  NewDrive drive;
  for (const std::string& kind : parts(text, '+')) {
    bool* has = kind == "chambers"  ? &drive.chambers
                : kind == "tendons" ? &drive.tendons
                : kind == "cables"  ? &drive.cables
                : kind == "central" ? &drive.central
                                    : nullptr;
    if (!has)
      throw Failure(
          fmt::format("--kind {}: must be chambers, tendons, cables or central, joined by +", text));
    *has = true;
  }
  return drive;
}

bool any_bends(const Told& told) {
  const auto kind = told.find("kind");
  if (kind == told.end()) return true;
  const std::vector<std::string> all = parts(kind->second, ',');
  return std::any_of(all.begin(), all.end(), [](const std::string& k) { return drive_of(k).bends(); });
}

/// Takes the flags, and asks for the rest where somebody is there to answer.
void complete(Told& told, bool terminal) {
  const auto applies = [&](const Question& q) { return !q.only_for || any_bends(told); };
  const auto missing = [&](const Question& q) { return applies(q) && told.count(q.flag) == 0; };
  const bool asks = terminal && std::any_of(std::begin(kQuestions), std::end(kQuestions),
                                            [&](const Question& q) { return !q.fallback && missing(q); });
  for (const Question& q : kQuestions) {
    if (!missing(q)) continue;
    if (!asks) {
      if (!q.fallback) throw Failure(fmt::format("--{} is missing: {}", q.flag, q.asks), 2);
      continue;
    }
    std::string answer;
    do {
      fmt::print("{}{}: ", q.asks, q.fallback ? fmt::format(" [{}]", q.fallback) : "");
      std::cout.flush();
      std::fflush(stdout);
      if (!std::getline(std::cin, answer))
        throw Failure(fmt::format("--{} is missing: {}", q.flag, q.asks), 2);
      boost::trim(answer);
    } while (answer.empty() && !q.fallback);
    if (!answer.empty()) told[q.flag] = answer;
  }
}

std::vector<double> angles_of(const Told& told, std::size_t segment, std::size_t segments,
                              std::size_t count) {
  std::vector<double> angles;
  if (told.count("angles") == 0) {
    for (std::size_t i = 0; i < count; ++i)
      angles.push_back(360.0 * static_cast<double>(i) / static_cast<double>(count));
    return angles;
  }
  const std::string text = per_segment(told, "angles", segments, '/')[segment];
  for (const std::string& angle : parts(text, ','))
    angles.push_back(number_of("angles", angle, -360.0, 360.0));
  if (angles.size() != count)
    throw Failure(fmt::format("--angles {}: must be {}, one for each of --actuators", text, count));
  return angles;
}

std::vector<NewSegment> segments_of(const Told& told) {
  const std::size_t count = whole("segments", told.at("segments"), 20.0);
  const auto kinds = per_segment(told, "kind", count), lengths = per_segment(told, "length", count),
             masses = per_segment(told, "mass", count), diameters = per_segment(told, "diameter", count);
  std::vector<NewSegment> segments(count);
  for (std::size_t i = 0; i < count; ++i) {
    NewSegment& s = segments[i];
    s.drive = drive_of(kinds[i]);
    s.length_m = number_of("length", lengths[i], 0.005, 10.0);
    s.mass_kg = number_of("mass", masses[i], 0.0, 50.0 * s.length_m);
    s.diameter_m = number_of("diameter", diameters[i], 5e-4, 1.0);
    s.stiffness_nm2 = told.count("stiffness")
                          ? number_of("stiffness", per_segment(told, "stiffness", count)[i], 1e-6, 500.0)
                          : std::max(1e-6, guessed_stiffness_nm2(s.diameter_m));
    if (s.drive.bends())
      s.angles_deg =
          angles_of(told, i, count, whole("actuators", per_segment(told, "actuators", count)[i], 32.0));
  }
  return segments;
}

std::vector<NewBody> bodies_of(const std::string& text, double length_m) {
  std::vector<NewBody> bodies;
  if (text.find(':') == std::string::npos) {
    const std::size_t count = whole("bodies", text, 50.0);
    for (std::size_t i = 1; i <= count; ++i) {
      const double at = static_cast<double>(i) / static_cast<double>(count);
      bodies.push_back(
          {i == count ? "tip" : fmt::format("ring_{}", i), i == count ? length_m : at * length_m});
    }
    return bodies;
  }
  for (const std::string& body : parts(text, ',')) {
    const std::vector<std::string> pair = parts(body, ':');
    if (pair.size() != 2 || pair[0].empty())
      throw Failure(fmt::format("--bodies {}: must be name:arclength in m, or name:tip", body));
    bodies.push_back({pair[0], pair[1] == "tip" ? length_m : number_of("bodies", pair[1], 1e-4, length_m)});
  }
  return bodies;
}

NewArm arm_of(const Told& told) {
  NewArm arm;
  arm.name = fs::path(told.at("out")).stem().string();
  std::replace_if(
      arm.name.begin(), arm.name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
      '_');
  arm.segments = segments_of(told);
  arm.bodies = bodies_of(told.at("bodies"), arm.length_m());
  const auto base = told.find("base");
  arm.base_body = base == told.end() ? "base" : base->second;
  for (const char* attitude : {"hanging", "standing", "horizontal"}) {
    if (arm.base_body != attitude) continue;
    arm.attitude = attitude;
    arm.base_body.clear();
    break;
  }
  return arm;
}

void run_new_arm(Told told, bool force) {
  complete(told, isatty(STDIN_FILENO) != 0);
  const NewArm arm = arm_of(told);
  const fs::path out = told.at("out");
  const fs::path layout = told.count("layout") ? fs::path(told.at("layout"))
                                               : out.parent_path() / (out.stem().string() + "_layout.yaml");
  if (out == layout) throw Failure(fmt::format("--layout {}: is the arm file already", layout.string()));
  const std::string text = arm_text(arm), columns = layout_text(arm);
  // Nothing is written that the loaders refuse.
  arm::parse_arm(text, out.string());
  trial::parse_csv_layout(columns, layout.string());
  Replacing replacing = Replacing::of_this_run(force);
  for (const auto& [flag, answer] : told) replacing.command += fmt::format(" {}={}", flag, answer);
  OutputFile arm_file(out, replacing), layout_file(layout, replacing);
  arm_file.write(text);
  layout_file.write(columns);
  arm_file.commit();
  layout_file.commit();
  fmt::print("{}: {} segment{}, {:g} m, {} bod{}; look for GUESS\n{}: the columns of its recordings\n",
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
