#include "record_trial.h"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <variant>

#include "command.h"
#include "output_file.h"
#include "rig/receipt_queue.h"
#include "rig/simulator.h"
#include "rig/truth_csv.h"
#include "rig/truth_yaml.h"
#include "ros/bag_writer.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

/// Writes the messages that are received by a time, in their order.
void record(rig::ReceiptQueue& queue, double until_s, const std::vector<std::string>& bodies,
            TrialBagWriter& bag) {
  while (const std::optional<rig::Received> received = queue.take(until_s)) {
    const double receipt_s = received->receipt_s + kTrialEpochS;
    if (const auto* payload = std::get_if<rig::PayloadSample>(&received->message)) {
      bag.payload(receipt_s, payload->kg);
    } else if (const auto* input = std::get_if<rig::InputSample>(&received->message)) {
      const std::string topic = rig::topic_of(input->kind, input->number);
      if (input->kind == rig::InputKind::kChamber || input->kind == rig::InputKind::kVacuum) {
        bag.pressure(topic, input->stamp_s + kTrialEpochS, input->value, receipt_s);
      } else {
        bag.scalar(topic, receipt_s, input->value);
      }
    } else {
      const auto& pose = std::get<rig::PoseSample>(received->message);
      bag.pose(bodies[pose.body], pose.stamp_s + kTrialEpochS, pose.pose.p, pose.pose.q, receipt_s);
    }
  }
}

}  // namespace

RecordedTrial record_trial(const rig::Scenario& scenario, const fs::path& bag_path,
                           const fs::path& truth_path, const std::function<void()>& on_frame,
                           const Replacing& replacing) {
  OutputFile bag_file(bag_path, replacing);
  OutputFile series_file(truth_path, replacing);
  OutputFile description_file(fs::path(truth_path).replace_extension(".yaml"), replacing);
  OutputFile seal_file(fs::path(truth_path).replace_extension(".sha256"), replacing);

  rig::Simulator simulator(scenario);
  TrialBagWriter bag(bag_file.temporary().string());
  rig::ReceiptQueue queue;
  std::ofstream series(series_file.temporary());
  rig::write_truth_header(series, scenario);
  RecordedTrial recorded;
  while (const std::optional<rig::Sample> sample = simulator.next()) {
    queue.add(*sample);
    record(queue, sample->stamp_s, simulator.body_names(), bag);
    rig::write_truth_row(series, sample->truth, kTrialEpochS);
    recorded.duration_s = sample->stamp_s;
    ++recorded.frames;
    on_frame();
  }
  record(queue, std::numeric_limits<double>::infinity(), simulator.body_names(), bag);
  bag.close();
  finish(series, series_file.path());
  description_file.write(rig::truth_yaml(scenario));

  recorded.messages = bag.messages();
  recorded.bodies_lost = simulator.dropouts();
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
