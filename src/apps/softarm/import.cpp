// softarm import: a laboratory's CSV recordings to trial bags.
#include <fmt/format.h>
#include <rosbag/exceptions.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/ros/bag_writer.h"
#include "softarm/shipped.h"
#include "softarm/trial/csv_recording.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string layout;
  std::vector<std::string> files;
  std::string out;
  std::vector<std::string> payload, leave_out;  ///< as typed
};

struct Span {
  double from_s = 0.0, to_s = 0.0;
};

constexpr const char* kExamples = R"(Examples:
  softarm import pouch_arm_one_segment trial.txt --out trial.bag
  softarm import my_layout.yaml day1/*.csv --out bags/
  softarm import my_layout.yaml loaded.csv --payload 0 --payload 10.5:0.4 --leave-out 7:10.5 --out loaded.bag
config/layouts/template.yaml shows every key of a layout. With several files, --out is a folder.)";

/// One bag per file. A name that two files share gets its folder's name in front.
std::vector<fs::path> bag_paths(const Options& options) {
  std::error_code error;
  const bool is_folder =
      options.files.size() > 1 || options.out.back() == '/' || fs::is_directory(options.out, error);
  if (!is_folder) return {options.out};
  if (!fs::is_directory(options.out, error) && !fs::create_directory(options.out, error)) {
    throw Failure(fmt::format("--out {}: must be a folder, and cannot be made: {}", options.out,
                              error ? error.message() : "a file of that name exists"));
  }
  std::map<std::string, int> uses;
  for (const std::string& file : options.files) ++uses[fs::path(file).stem().string()];
  std::vector<fs::path> paths;
  std::set<fs::path> taken;
  for (const std::string& file : options.files) {
    std::string name = fs::path(file).stem().string();
    if (uses[name] > 1) name = fs::absolute(file).parent_path().filename().string() + "_" + name;
    paths.push_back(fs::path(options.out) / (name + ".bag"));
    if (!taken.insert(paths.back()).second) {
      throw Failure(
          fmt::format("{}: would be written to {}, as another file already is; import it separately", file,
                      paths.back().string()));
    }
  }
  return paths;
}

std::optional<double> number(const std::string& text) {
  double value = 0.0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (end != last || error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The numbers on both sides of a colon.
std::optional<std::pair<double, double>> pair_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::optional<double> first = number(text.substr(0, colon)), second = number(text.substr(colon + 1));
  if (!first || !second) return std::nullopt;
  return std::pair(*first, *second);
}

std::vector<CsvPayloadStep> payload_of(const std::vector<std::string>& texts) {
  std::vector<CsvPayloadStep> steps;
  for (const std::string& text : texts) {
    const std::optional<double> from_start = number(text);
    const auto later = pair_of(text);
    if ((!from_start && !later) || !((from_start ? *from_start : later->second) >= 0.0) ||
        !((from_start ? *from_start : later->second) <= 100.0))
      throw Failure(fmt::format(
          "--payload {}: must be KG from the start, or S:KG from the recording's time S on; 0 to 100 kg",
          text));
    const CsvPayloadStep step = from_start
                                    ? CsvPayloadStep{std::numeric_limits<double>::lowest(), *from_start}
                                    : CsvPayloadStep{later->first, later->second};
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

/// Publishes the schedule's steps up to `time_s`; a step before the first row counts from the first row on.
class PayloadSchedule {
 public:
  explicit PayloadSchedule(const CsvLayout& layout) : layout_(layout) {}

  void advance(const CsvRow& row, bool first, TrialBagWriter& bag) {
    std::size_t last = next_;
    while (last < layout_.payload.size() && layout_.payload[last].from_s <= row.time_s) ++last;
    if (last == next_) return;
    const CsvPayloadStep& step = layout_.payload[last - 1];
    bag.payload(first ? row.stamp_s : step.from_s + layout_.start_stamp_s, step.kg);
    next_ = last;
  }

 private:
  const CsvLayout& layout_;
  std::size_t next_ = 0;
};

/// @param left_out times of the recording whose rows are not written
/// @param left_out_rows counts those
CsvReport import_file(const CsvLayout& layout, const std::string& file, const fs::path& bag_path,
                      const std::vector<Span>& left_out, std::uint64_t& left_out_rows,
                      std::uint64_t& messages) {
  TrialBagWriter bag(bag_path.string());
  PayloadSchedule schedule(layout);
  bool first = true;
  const CsvReport report = read_csv_recording(layout, file, [&](const CsvRow& row) {
    if (std::any_of(left_out.begin(), left_out.end(),
                    [&](const Span& span) { return row.time_s >= span.from_s && row.time_s < span.to_s; })) {
      ++left_out_rows;
      return;
    }
    schedule.advance(row, first, bag);
    first = false;
    for (std::size_t i = 0; i < row.pressures_pa.size(); ++i) {
      if (row.pressures_pa[i]) bag.pressure(layout.pressures[i].topic, row.stamp_s, *row.pressures_pa[i]);
    }
    for (std::size_t i = 0; i < row.bodies.size(); ++i) {
      const std::optional<CsvPose>& pose = row.bodies[i];
      if (pose) bag.pose(layout.bodies[i].name, row.stamp_s, pose->p_mocap, pose->q_mocap);
    }
  });
  bag.close();
  messages = bag.messages();
  return report;
}

void print_report(const std::string& file, const fs::path& bag, const CsvReport& report,
                  std::uint64_t left_out_rows, std::uint64_t messages) {
  fmt::print("{} -> {}: {} of {} rows, {} messages\n", file, bag.string(), report.used - left_out_rows,
             report.rows, messages);
  if (left_out_rows) fmt::print("  rows left out, as told: {}\n", left_out_rows);
  for (const auto& [reason, count] : report.bad_rows) fmt::print("  rows skipped, {}: {}\n", reason, count);
  if (report.repeated) fmt::print("  rows whose poses only repeat the row before: {}\n", report.repeated);
  for (const auto& [reason, count] : report.lost) fmt::print("  absent, {}: {}\n", reason, count);
  for (const std::string& example : report.examples) fmt::print(stderr, "softarm: {}\n", example);
}

void run(const Options& options) {
  const fs::path layout_path = find_config("layouts", options.layout);
  CsvLayout layout = parse_csv_layout(read_text(layout_path), layout_path.string());
  if (!options.payload.empty()) layout.payload = payload_of(options.payload);
  const std::vector<Span> left_out = spans_of(options.leave_out);
  for (const std::string& file : options.files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) throw Failure(fmt::format("{}: no such file", file));
  }
  const std::vector<fs::path> paths = bag_paths(options);
  std::vector<std::unique_ptr<OutputFile>> outputs;
  std::vector<CsvReport> reports;
  std::vector<std::uint64_t> messages(options.files.size()), left_out_rows(options.files.size());
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    outputs.push_back(std::make_unique<OutputFile>(paths[i]));
    reports.push_back(import_file(layout, options.files[i], outputs[i]->temporary(), left_out,
                                  left_out_rows[i], messages[i]));
    if (messages[i] == 0)
      throw Failure(fmt::format("{}: --leave-out leaves nothing of it", options.files[i]));
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    outputs[i]->commit();
    print_report(options.files[i], paths[i], reports[i], left_out_rows[i], messages[i]);
  }
}

}  // namespace

void add_import(CLI::App& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("import", "Turn CSV recordings into trial bags by a column layout.");
  command->add_option("LAYOUT", options->layout, "layout file, or the name of one in config/layouts")
      ->required();
  command->add_option("FILE", options->files, "recordings")->required();
  command->add_option("--out", options->out, "the bag, or a folder for one bag per recording")->required();
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
  command->footer(kExamples);
  command->callback([options] { run(*options); });
}

}  // namespace softarm::app
