#include "trial_recorder.h"

#include <utility>

namespace softarm::trial {

TrialRecorder::TrialRecorder(const arm::Arm& arm, std::string name) {
  for (const arm::ScalarInput& input : arm.inputs.scalars) stated_.push_back(input.between);
  trial_.name = std::move(name);
  trial_.inputs.resize(stated_.size());
}

void TrialRecorder::add(Frame frame) {
  went_back_ = went_back_ || (!trial_.frames.empty() && frame.stamp_ns < trial_.frames.back().stamp_ns);
  add(frame.samples);
  frame.samples = {};
  trial_.frames.push_back(std::move(frame));
}

void TrialRecorder::add(const std::vector<InputSample>& samples) {
  for (const InputSample& sample : samples)
    trial_.inputs.at(static_cast<std::size_t>(sample.input)).add(sample.stamp_ns, sample.value);
}

Trial TrialRecorder::take() {
  Trial trial = std::exchange(trial_, {});
  trial_.inputs.resize(stated_.size());
  if (std::exchange(went_back_, false)) trial.inputs.clear();
  for (std::size_t i = 0; i < trial.inputs.size(); ++i) trial.inputs[i].decide(stated_[i]);
  return trial;
}

}  // namespace softarm::trial
