#include "read_trials.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <utility>

#include "command.h"
#include "math/parallel.h"
#include "progress.h"
#include "ros/bag_frames.h"
#include "trial/trial_recorder.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct Reading {
  trial::Trial trial;
  std::vector<std::string> warnings;
};

void read_bag(const std::string& path, const arm::Arm& arm, bool use_payload, Reading& reading,
              Progress& progress) {
  BagFrames bag(path, arm, use_payload);
  reading.warnings = bag.warnings();
  progress.add_total(static_cast<double>(bag.messages()));
  std::uint64_t frames = 0;
  BagFrames::Callbacks callbacks;
  trial::TrialRecorder recorder(arm, reading.trial.name);
  callbacks.on_frame = [&](const trial::Frame& frame) {
    recorder.add(frame);
    ++frames;
  };
  callbacks.on_time_jump = [] {};
  callbacks.on_messages = [&](std::uint64_t messages) {
    progress.advance(static_cast<double>(messages), std::exchange(frames, 0));
  };
  bag.read(callbacks);
  recorder.add(bag.take_samples());
  reading.trial = recorder.take();
  if (reading.trial.frames.empty())
    throw Failure(
        fmt::format("{}: no frame could be put together out of {} samples", path, bag.assembler().samples()));
}

}  // namespace

std::vector<trial::Trial> read_trials(const std::vector<std::string>& bags, const arm::Arm& arm,
                                      bool use_payload, unsigned jobs) {
  std::vector<Reading> readings;
  std::set<std::string> names;
  for (const std::string& bag : bags) {
    std::error_code error;
    if (!fs::is_regular_file(bag, error)) throw Failure(fmt::format("{}: no such bag", bag));
    Reading reading;
    reading.trial.name = fs::path(bag).stem().string();
    if (!names.insert(reading.trial.name).second)
      throw Failure(
          fmt::format("{}: another trial is called {} too; rename one of the bags", bag, reading.trial.name));
    readings.push_back(std::move(reading));
  }
  Progress progress("frames");
  // One bad bag would silently change what is identified: the first ends it.
  math::in_parallel(readings.size(), jobs,
                    [&](std::size_t i) { read_bag(bags[i], arm, use_payload, readings[i], progress); });
  std::vector<trial::Trial> trials;
  for (Reading& reading : readings) {
    for (const std::string& warning : reading.warnings) progress.line("softarm: warning: " + warning);
    trials.push_back(std::move(reading.trial));
  }
  return trials;
}

}  // namespace softarm::app
