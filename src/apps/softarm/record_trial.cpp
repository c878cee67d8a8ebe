#include "record_trial.h"

#include <fmt/format.h>

#include <fstream>
#include <limits>

#include "command.h"
#include "output_file.h"
#include "rig/receipt_queue.h"
#include "rig/simulator.h"
#include "rig/truth_csv.h"
#include "rig/truth_yaml.h"
#include "rig_messages.h"
#include "ros/bag_writer.h"
#include "ros/conversions.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

/// Writes the messages that are received by a time, in their order.
void record(rig::ReceiptQueue& queue, double until_s, double epoch_s, RigMessages& messages,
            TrialBagWriter& bag) {
  const auto stamp_of = [epoch_s](double t_s) { return to_time(trial::Stamp(t_s + epoch_s).ns); };
  while (const std::optional<rig::Received> received = queue.take(until_s))
    for (const LabMessage& message : messages.of(*received, stamp_of))
      bag.message(message, received->receipt_s + epoch_s);
}

}  // namespace

RecordedBag record_bag(const rig::Scenario& scenario, const fs::path& bag_path,
                       const std::function<void(const rig::Sample&)>& on_sample,
                       const std::optional<arm::Arm>& arm, const fs::path& called) {
  rig::Simulator simulator(scenario);
  RigMessages messages(simulator, arm);
  TrialBagWriter bag(bag_path.string(), called.string());
  rig::ReceiptQueue queue;
  const double epoch_s = kTrialEpochS + scenario.session_s;
  RecordedBag recorded;
  while (const std::optional<rig::Sample> sample = simulator.next()) {
    queue.add(*sample);
    record(queue, sample->stamp_s, epoch_s, messages, bag);
    recorded.duration_s = sample->stamp_s;
    ++recorded.frames;
    on_sample(*sample);
  }
  record(queue, std::numeric_limits<double>::infinity(), epoch_s, messages, bag);
  bag.close();
  recorded.messages = bag.messages();
  recorded.bodies_lost = simulator.dropouts();
  return recorded;
}

RecordedTrial record_trial(const rig::Scenario& scenario, const fs::path& bag_path,
                           const fs::path& truth_path, const std::function<void()>& on_frame,
                           const std::optional<arm::Arm>& arm, const Replacing& replacing) {
  OutputFile bag_file(bag_path, replacing);
  OutputFile series_file(truth_path, replacing);
  OutputFile description_file(fs::path(truth_path).replace_extension(".yaml"), replacing);
  OutputFile seal_file(fs::path(truth_path).replace_extension(".sha256"), replacing);

  std::ofstream series(series_file.temporary());
  rig::write_truth_header(series, scenario);
  RecordedTrial recorded;
  static_cast<RecordedBag&>(recorded) = record_bag(
      scenario, bag_file.temporary(),
      [&](const rig::Sample& sample) {
        rig::write_truth_row(series, sample.truth, kTrialEpochS + scenario.session_s);
        on_frame();
      },
      arm, bag_file.path());
  finish(series, series_file.path());
  description_file.write(rig::truth_yaml(scenario));

  recorded.truth_series = series_file.path();
  recorded.truth_description = description_file.path();
  recorded.seal = seal_file.path();
  recorded.series_sha256 = sha256_of_file(series_file.temporary());
  recorded.description_sha256 = sha256_of_file(description_file.temporary());
  seal_file.write(fmt::format("{}  {}\n{}  {}\n", recorded.series_sha256,
                              series_file.path().filename().string(), recorded.description_sha256,
                              description_file.path().filename().string()));
  series_file.commit();
  description_file.commit();
  seal_file.commit();
  bag_file.commit();
  return recorded;
}

}  // namespace softarm::app
