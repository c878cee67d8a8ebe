// A trial of the virtual rig as a bag, the truth sealed beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "output_file.h"
#include "rig/scenario.h"
#include "rig/simulator.h"
#include "softarm/arm/arm.h"

namespace softarm::app {

/// The beginning of the session as a stamp: a constant, so that the same scenario gives the same bag.
constexpr double kTrialEpochS = 1600000000.0;

struct RecordedBag {
  std::uint64_t frames = 0, messages = 0, bodies_lost = 0;
  double duration_s = 0.0;
};

/// Simulates a scenario with a duration and writes what the sensors saw, and nothing else, to a bag.
/// @param on_sample called after each frame, with what was seen and the truth
/// @param arm whose topics, types and units the bag has; absent: those of doc/rig.md
/// @param called as which people know the bag, where it is renamed when it is complete
/// @throws Failure, rig::SimulationError
RecordedBag record_bag(const rig::Scenario& scenario, const std::filesystem::path& bag,
                       const std::function<void(const rig::Sample&)>& on_sample,
                       const std::optional<arm::Arm>& arm = {}, const std::filesystem::path& called = {});

struct RecordedTrial : RecordedBag {
  std::filesystem::path truth_series, truth_description, seal;
  std::string series_sha256, description_sha256;
};

/// record_bag() and the truth:
/// its time series (truth, CSV: rig::write_truth_row) and what was hidden (the same name with .yaml); the
/// digests of both are in a third file (.sha256, as sha256sum writes and checks them). All files appear or
/// none.
/// @param on_frame called after each frame
/// @param replacing which files of other runs may be replaced
/// @throws Failure, rig::SimulationError
RecordedTrial record_trial(const rig::Scenario& scenario, const std::filesystem::path& bag,
                           const std::filesystem::path& truth, const std::function<void()>& on_frame,
                           const std::optional<arm::Arm>& arm = {}, const Replacing& replacing = {});

}  // namespace softarm::app
