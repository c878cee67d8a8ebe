// Trials of one input sequence, and folds of them.
#include "diagnose/sequences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// Two inputs at 20 Hz: a programme of a seed, begun `late_s` into it, with noise of 300 Pa.
model::TrialData driven(unsigned programme, double seconds, double late_s, unsigned noise_seed,
                        double share = 1.0) {
  std::mt19937_64 random(programme), noise(noise_seed);
  std::normal_distribution<double> normal;
  double phase[2][3];
  for (auto& of_input : phase)
    for (double& one : of_input) one = 2.0 * M_PI * static_cast<double>(random() % 1000) / 1000.0;
  model::TrialData trial;
  const auto frames = static_cast<Eigen::Index>(20.0 * seconds);
  trial.series.t_s.resize(frames);
  trial.series.inputs.resize(2, frames);
  for (Eigen::Index i = 0; i < frames; ++i) {
    const double t_s = static_cast<double>(i) / 20.0;
    trial.series.t_s[i] = t_s;
    for (Eigen::Index r = 0; r < 2; ++r) {
      double value = 25e3;
      for (int w = 0; w < 3; ++w)
        value += share * 7e3 * std::sin(2.0 * M_PI * 0.13 * (w + 1) * (t_s + late_s) + phase[r][w]);
      trial.series.inputs(r, i) = value + 300.0 * normal(noise);
    }
  }
  return trial;
}

TEST(Sequences, TheSameCommandsAreOneWhateverTheNoiseAndTheStart) {
  const std::vector<model::TrialData> trials{driven(1, 20.0, 0.0, 11), driven(2, 20.0, 0.0, 12),
                                             driven(1, 20.0, 1.7, 13), driven(1, 12.0, 5.0, 14),
                                             driven(2, 25.0, 0.0, 15), driven(3, 20.0, 0.0, 16)};
  EXPECT_THAT(sequences_of(trials), ElementsAre(0, 1, 0, 0, 1, 2));
}

TEST(Sequences, OtherAmplitudesAreOthers) {
  EXPECT_THAT(sequences_of({driven(1, 20.0, 0.0, 11), driven(1, 20.0, 0.0, 12, 0.5)}), ElementsAre(0, 1));
}

TEST(Sequences, InputsThatRestAreOne) {
  model::TrialData first = driven(1, 5.0, 0.0, 11), second = first, third = first;
  for (model::TrialData* trial : {&first, &second, &third}) trial->series.inputs.setConstant(20e3);
  third.series.inputs.setConstant(30e3);
  EXPECT_THAT(sequences_of({first, second, third}), ElementsAre(0, 0, 1));
}

TEST(Sequences, OfTheRigsTrialsThoseOfOneProgrammeAreOne) {
  testing::RecordedCase recorded = testing::drawn_case("{count_weights: [1]}", 3, 2, 8.0);
  std::vector<trial::Trial> trials;
  for (std::size_t i : {0, 1, 0}) {
    rig::Scenario scenario = recorded.truth[i];
    if (trials.size() == 2) scenario.payload.schedule = {rig::Setpoint{0.0, {0.05}, {}}};
    trials.push_back(testing::record(recorded.arm, scenario, "trial"));
  }
  EXPECT_THAT(sequences_of(model::prepare(recorded.arm, trials).trials), ElementsAre(0, 1, 0));
}

TEST(Folds, HoldWholeSequences) {
  const std::vector<std::size_t> sequences{0, 1, 0, 2, 3, 1, 4};
  const auto folds = folds_of(sequences, {0, 1, 2, 3, 4, 5, 6}, 3);
  EXPECT_THAT(folds, UnorderedElementsAre(ElementsAre(0, 2, 6), ElementsAre(1, 5), ElementsAre(3, 4)));
  EXPECT_THAT(folds_of(sequences, {0, 2, 3}, 3), UnorderedElementsAre(ElementsAre(0, 2), ElementsAre(3)));
  EXPECT_THAT(folds_of(sequences, {1, 5}, 3), UnorderedElementsAre(ElementsAre(1), ElementsAre(5)));
}

}  // namespace
}  // namespace softarm::diagnose
