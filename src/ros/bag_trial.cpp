#include "bag_trial.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "bag_frames.h"
#include "trial/trial_recorder.h"

namespace softarm {

std::string trial_name(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

void check_bag_names(const std::vector<std::string>& paths) {
  std::set<std::string> names;
  for (const std::string& path : paths) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) throw BagError(fmt::format("{}: no such bag", path));
    if (!names.insert(trial_name(path)).second)
      throw BagError(
          fmt::format("{}: another trial is called {} too; rename one of the bags", path, trial_name(path)));
  }
}

BagTrial read_bag_trial(const std::string& path, const arm::Arm& arm, bool use_payload,
                        const BagTrialHooks& hooks) {
  BagTrial read;
  BagFrames bag(path, arm, use_payload);
  hooks.on_total(bag.messages());
  std::uint64_t frames = 0;
  std::size_t all_frames = 0;
  BagFrames::Callbacks callbacks;
  trial::TrialRecorder recorder(arm, trial_name(path));
  callbacks.on_frame = [&](const trial::Frame& frame) {
    recorder.add(frame);
    ++frames;
    ++all_frames;
  };
  callbacks.on_time_jump = [&] { read.after_jumps.push_back(all_frames); };
  callbacks.on_messages = [&](std::uint64_t messages) {
    hooks.on_progress(messages, std::exchange(frames, 0));
  };
  bag.read(callbacks);
  read.warnings = bag.warnings();
  recorder.add(bag.take_samples());
  read.trial = recorder.take();
  read.rejected = bag.assembler().rejected();
  read.samples = bag.assembler().samples();
  if (read.trial.frames.empty())
    throw BagError(fmt::format("{}: no frame could be put together out of {} samples", path, read.samples));
  return read;
}

}  // namespace softarm
