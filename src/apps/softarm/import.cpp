// softarm import: a laboratory's CSV recordings to trial bags.
#include <fmt/format.h>
#include <rosbag/exceptions.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "command.h"
#include "import_bags.h"
#include "math/parse_number.h"
#include "output_file.h"
#include "progress.h"
#include "say.h"
#include "shipped.h"
#include "trial/csv_recording.h"
#include "trial/layout_guess.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  std::string layout;
  std::vector<std::string> files;
  std::string out, inputs, guess;
  std::optional<double> split_every_s;
  std::vector<std::string> payload, leave_out;  ///< as typed
  bool force = false;
};

struct Span {
  double from_s = 0.0, to_s = 0.0;
};

constexpr const char* kImportExamples = R"(Examples:
  softarm import --guess trial.csv --out my_layout.yaml
  softarm import pouch_arm_one_segment trial.txt --out trial.bag
  softarm import my_layout.yaml day1/*.csv --out bags/
  softarm import my_layout.yaml loaded.csv --payload 0 --payload 10.5:0.4 --leave-out 7:10.5 --out loaded.bag
  softarm import tendon_trunk_controlled observations.csv --inputs control_inputs.csv --split-every 15 --out bags/
config/layouts/template.yaml shows every key of a layout. Where it becomes several bags, --out is a folder.)";

/// One bag per file. A name that two files share gets its folder's name in front.
/// @param several the files become more than one bag
std::vector<fs::path> bag_paths(const ImportOptions& options, bool several) {
  std::error_code error;
  const bool is_folder = several || options.out.back() == '/' || fs::is_directory(options.out, error);
  if (!is_folder) return {options.out};
  if (!fs::is_directory(options.out, error) && !fs::create_directory(options.out, error)) {
    throw Failure(fmt::format("--out {}: must be a folder, and cannot be made: {}", options.out,
                              error ? error.message() : "a file of that name exists"));
  }
  std::map<std::string, int> uses;
  for (const std::string& file : options.files) ++uses[fs::path(file).stem().string()];
  std::vector<fs::path> paths;
  for (const std::string& file : options.files) {
    std::string name = fs::path(file).stem().string();
    if (uses[name] > 1) name = fs::absolute(file).parent_path().filename().string() + "_" + name;
    paths.push_back(fs::path(options.out) / (name + ".bag"));
  }
  return paths;
}

std::optional<double> number(const std::string& text) {
  const std::optional<double> value = math::parse_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// The numbers on both sides of a colon.
std::optional<std::pair<double, double>> pair_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::optional<double> first = number(text.substr(0, colon)), second = number(text.substr(colon + 1));
  if (!first || !second) return std::nullopt;
  return std::pair(*first, *second);
}

std::vector<trial::CsvPayloadStep> payload_of(const std::vector<std::string>& texts) {
  std::vector<trial::CsvPayloadStep> steps;
  for (const std::string& text : texts) {
    const std::optional<double> from_start = number(text);
    const auto later = pair_of(text);
    if ((!from_start && !later) || !((from_start ? *from_start : later->second) >= 0.0) ||
        !((from_start ? *from_start : later->second) <= 100.0))
      throw Failure(fmt::format(
          "--payload {}: must be KG from the start, or S:KG from the recording's time S on; 0 to 100 kg",
          text));
    const trial::CsvPayloadStep step =
        from_start ? trial::CsvPayloadStep{std::numeric_limits<double>::lowest(), *from_start}
                   : trial::CsvPayloadStep{later->first, later->second};
    if (!steps.empty() && !(step.from_s > steps.back().from_s))
      throw Failure(fmt::format("--payload {}: must be later than the one before", text));
    steps.push_back(step);
  }
  return steps;
}

std::vector<Span> spans_of(const std::vector<std::string>& texts) {
  std::vector<Span> spans;
  for (const std::string& text : texts) {
    const auto span = pair_of(text);
    if (!span || !(span->second > span->first))
      throw Failure(fmt::format(
          "--leave-out {}: must be FROM:TO in s of the recording's time, the second the larger", text));
    spans.push_back({span->first, span->second});
  }
  return spans;
}

/// Bytes of all files, for the bar.
double bytes_of(const std::vector<std::string>& files) {
  double bytes = 0.0;
  for (const std::string& file : files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) throw Failure(fmt::format("{}: no such file", file));
    bytes += static_cast<double>(fs::file_size(file, error));
  }
  return bytes;
}

struct Imported {
  std::unique_ptr<ImportBags> bags;
  trial::CsvReport report;
  std::uint64_t left_out_rows = 0;
};

/// A layout as read, and its text.
struct Layout {
  trial::CsvLayout layout;
  std::string text;
};

Imported import_file(const Layout& by, const ImportOptions& options, const std::string& file,
                     const fs::path& path, const std::vector<Span>& left_out, Progress& progress) {
  const trial::CsvLayout& layout = by.layout;
  Imported result;
  result.bags = std::make_unique<ImportBags>(layout, by.text, path, options.split_every_s,
                                             Replacing::of_this_run(options.force));
  std::uint64_t rows = 0;
  trial::CsvSources sources;
  sources.inputs_path = options.inputs;
  sources.on_bytes = [&](std::uint64_t bytes) {
    progress.advance(static_cast<double>(bytes), std::exchange(rows, 0));
  };
  const auto on_row = [&](const trial::CsvRow& row) {
    ++rows;
    if (std::any_of(left_out.begin(), left_out.end(),
                    [&](const Span& span) { return row.time_s >= span.from_s && row.time_s < span.to_s; })) {
      // With two clocks a row comes as its inputs and as its bodies: counted once.
      const bool has_body =
          std::any_of(row.bodies.begin(), row.bodies.end(), [](const auto& b) { return b.has_value(); });
      result.left_out_rows += layout.bodies_ahead_s == 0.0 || !has_body;
      result.bags->leave_out();
      return;
    }
    result.bags->write(row);
  };
  result.report = trial::read_csv_recording(layout, file, on_row, sources);
  result.bags->close();
  if (result.bags->bags().empty()) throw Failure(fmt::format("{}: --leave-out leaves nothing of it", file));
  return result;
}

void print_join(const std::string& inputs, const trial::CsvJoinReport& join) {
  if (join.unmatched) say("  rows whose id {} lacks: {}\n", inputs, join.unmatched);
  if (join.unused_ids) say("  ids of {} that no row has: {}\n", inputs, join.unused_ids);
  for (const auto& [reason, count] : join.bad_rows)
    say("  rows of {} not used, {}: {}\n", inputs, reason, count);
  for (const std::string& example : join.examples) fmt::print(stderr, "softarm: {}\n", example);
}

void print_report(const ImportOptions& options, const std::string& file, const Imported& imported) {
  const trial::CsvReport& report = imported.report;
  const std::vector<ImportBags::Bag>& bags = imported.bags->bags();
  std::uint64_t messages = 0;
  for (const ImportBags::Bag& bag : bags) messages += bag.messages;
  const std::string first = bags.front().file->path().string();
  const std::string names = bags.size() == 1
                                ? first
                                : fmt::format("{} ... {} ({} bags)", first,
                                              bags.back().file->path().filename().string(), bags.size());
  say("{} -> {}: {} of {} rows, {} messages\n", file, names, report.used - imported.left_out_rows,
      report.rows, messages);
  if (imported.left_out_rows) say("  rows left out, as requested: {}\n", imported.left_out_rows);
  for (const auto& [reason, count] : report.bad_rows) say("  rows skipped, {}: {}\n", reason, count);
  if (report.repeated) say("  rows whose poses only repeat the row before: {}\n", report.repeated);
  for (const auto& [reason, count] : report.lost) say("  absent, {}: {}\n", reason, count);
  if (report.one_clock_only)
    say("  poses or inputs left out, the other clock has no time for them: {}\n", report.one_clock_only);
  if (report.join) print_join(options.inputs, *report.join);
  for (const std::string& example : report.examples) fmt::print(stderr, "softarm: {}\n", example);
}

/// Writes a draft of a layout, or prints it.
void run_guess(const ImportOptions& options) {
  if (!options.layout.empty()) throw Failure("--guess takes one recording, and no layout");
  bytes_of({options.guess});
  const trial::LayoutGuess guess = trial::guess_layout(options.guess);
  const std::string text = to_yaml(guess, fs::path(options.guess).filename().string());
  if (options.out.empty()) {
    say_text(text);
    return;
  }
  OutputFile file(options.out, Replacing::of_this_run(options.force));
  file.write(text);
  file.commit();
  const std::size_t open = blanks(guess);
  say("{} -> {}: {}\n", options.guess, options.out,
      open == 0 ? "nothing is left to fill in; check what was guessed"
                : fmt::format("{} value{} to fill in (FILL IN); check what was guessed", open,
                              open == 1 ? "" : "s"));
}

void run_import(const ImportOptions& options) {
  if (!options.guess.empty()) return run_guess(options);
  if (options.layout.empty()) throw Failure("LAYOUT is missing; softarm import --guess FILE drafts one");
  if (options.files.empty()) throw Failure("FILE is missing: the recordings");
  if (options.out.empty()) throw Failure("--out is missing: the bag, or a folder for one bag per recording");
  const fs::path layout_path = find_config("layouts", options.layout);
  Layout by{{}, read_text(layout_path)};
  trial::CsvLayout& layout = by.layout = trial::parse_csv_layout(by.text, layout_path.string());
  if (!options.payload.empty()) {
    layout.payload = payload_of(options.payload);
    layout.payload_column.reset();
  }
  const std::vector<Span> left_out = spans_of(options.leave_out);
  if (layout.join && options.inputs.empty())
    throw Failure(fmt::format("{}: joins a file of inputs (key 'join'); name it with --inputs FILE",
                              layout_path.string()));
  if (!layout.join && !options.inputs.empty())
    throw Failure(fmt::format("--inputs {}: {} has no key 'join' that says how it belongs to a recording",
                              options.inputs, layout_path.string()));
  Progress progress("rows");
  progress.add_total(bytes_of(options.files));
  const bool several = options.files.size() > 1 || options.split_every_s || layout.trial_column;
  const std::vector<fs::path> paths = bag_paths(options, several);
  std::vector<Imported> imported;
  std::set<fs::path> taken;
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    imported.push_back(import_file(by, options, options.files[i], paths[i], left_out, progress));
    for (const ImportBags::Bag& bag : imported.back().bags->bags()) {
      if (!taken.insert(bag.file->path()).second)
        throw Failure(
            fmt::format("{}: would be written to {}, as another file already is; import it separately",
                        options.files[i], bag.file->path().string()));
    }
  }
  for (const Imported& file : imported) file.bags->commit();
  progress.hide();
  for (std::size_t i = 0; i < imported.size(); ++i) print_report(options, options.files[i], imported[i]);
}

}  // namespace

void add_import(CLI::App& program) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      program.add_subcommand("import", "Turn CSV recordings into trial bags by a column layout.");
  command->add_option("LAYOUT", options->layout, "layout file, or the name of one in config/layouts");
  command->add_option("FILE", options->files, "recordings");
  command->add_option("--out", options->out,
                      "the bag, or a folder for one bag per recording; with --guess the layout");
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_option(
      "--guess", options->guess,
      "draft an annotated layout for this recording, in place of importing (to --out, else printed)");
  command->add_option(
      "--inputs", options->inputs,
      "file whose rows are joined to the recordings' by an id, where the layout has a key 'join'");
  command
      ->add_option(
          "--split-every", options->split_every_s,
          "a bag for every so many seconds: a fit may leave some pieces of one long recording unseen")
      ->check(CLI::Range(0.01, 1e6));
  command
      ->add_option(
          "--payload", options->payload,
          "known payload, in place of the layout's: KG from the start, or S:KG from time S on; repeat")
      ->allow_extra_args(false);
  command
      ->add_option(
          "--leave-out", options->leave_out,
          "FROM:TO, times (s) whose rows are not written, such as while a hand is at the arm; repeat")
      ->allow_extra_args(false);
  command->footer(kImportExamples);
  command->callback([options] { run_import(*options); });
}

}  // namespace softarm::app
