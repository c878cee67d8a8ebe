#include "read_trials.h"

#include <utility>

#include "math/parallel.h"
#include "progress.h"
#include "ros/bag_trial.h"

namespace softarm::app {

std::vector<trial::Trial> read_trials(const std::vector<std::string>& bags, const arm::Arm& arm,
                                      bool use_payload, unsigned jobs) {
  check_bag_names(bags);
  std::vector<BagTrial> readings(bags.size());
  Progress progress("frames");
  BagTrialHooks hooks;
  hooks.on_total = [&](std::uint64_t messages) { progress.add_total(static_cast<double>(messages)); };
  hooks.on_progress = [&](std::uint64_t messages, std::uint64_t frames) {
    progress.advance(static_cast<double>(messages), frames);
  };
  // One bad bag would silently change what is identified: the first ends it.
  math::in_parallel(readings.size(), jobs,
                    [&](std::size_t i) { readings[i] = read_bag_trial(bags[i], arm, use_payload, hooks); });
  std::vector<trial::Trial> trials;
  for (BagTrial& reading : readings) {
    for (const std::string& warning : reading.warnings) progress.line("softarm: warning: " + warning);
    trials.push_back(std::move(reading.trial));
  }
  return trials;
}

}  // namespace softarm::app
