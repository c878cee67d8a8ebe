#include "softarm/record_trial.h"

#include <fmt/format.h>

#include <fstream>

#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/rig/simulator.h"
#include "softarm/rig/truth_csv.h"
#include "softarm/rig/truth_yaml.h"
#include "softarm/ros/bag_writer.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

void record(const rig::Sample& sample, const std::vector<std::string>& bodies, TrialBagWriter& bag) {
  if (sample.payload) bag.payload(sample.payload->stamp_s + kTrialEpochS, sample.payload->kg);
  for (const rig::InputSample& input : sample.inputs) {
    const std::string topic = rig::topic_of(input.kind, input.number);
    const double stamp_s = input.stamp_s + kTrialEpochS;
    if (input.kind == rig::InputKind::kChamber || input.kind == rig::InputKind::kVacuum) {
      bag.pressure(topic, stamp_s, input.value);
    } else {
      bag.scalar(topic, stamp_s, input.value);
    }
  }
  for (std::size_t i = 0; i < sample.bodies.size(); ++i) {
    const std::optional<rig::Pose>& pose = sample.bodies[i];
    if (pose) bag.pose(bodies[i], sample.stamp_s + kTrialEpochS, pose->p, pose->q);
  }
}

void close(std::ofstream& file, const fs::path& path) {
  file.close();
  if (!file) throw Failure(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

RecordedTrial record_trial(const rig::Scenario& scenario, const fs::path& bag_path,
                           const fs::path& truth_path, const std::function<void()>& on_frame) {
  OutputFile bag_file(bag_path);
  OutputFile series_file(truth_path);
  OutputFile description_file(fs::path(truth_path).replace_extension(".yaml"));
  OutputFile seal_file(fs::path(truth_path).replace_extension(".sha256"));

  rig::Simulator simulator(scenario);
  TrialBagWriter bag(bag_file.temporary().string());
  std::ofstream series(series_file.temporary());
  rig::write_truth_header(series, scenario);
  RecordedTrial recorded;
  while (const std::optional<rig::Sample> sample = simulator.next()) {
    record(*sample, simulator.body_names(), bag);
    rig::write_truth_row(series, sample->truth, kTrialEpochS);
    recorded.duration_s = sample->stamp_s;
    ++recorded.frames;
    on_frame();
  }
  bag.close();
  close(series, series_file.path());
  std::ofstream description(description_file.temporary());
  description << rig::truth_yaml(scenario);
  close(description, description_file.path());

  recorded.messages = bag.messages();
  recorded.bodies_lost = simulator.dropouts();
  recorded.truth_series = series_file.path();
  recorded.truth_description = description_file.path();
  recorded.seal = seal_file.path();
  recorded.series_sha256 = sha256_of_file(series_file.temporary());
  recorded.description_sha256 = sha256_of_file(description_file.temporary());
  std::ofstream seal(seal_file.temporary());
  seal << fmt::format("{}  {}\n{}  {}\n", recorded.series_sha256, series_file.path().filename().string(),
                      recorded.description_sha256, description_file.path().filename().string());
  close(seal, seal_file.path());
  series_file.commit();
  description_file.commit();
  seal_file.commit();
  bag_file.commit();
  return recorded;
}

}  // namespace softarm::app
