// However the inputs of clean trials are logged, what is fitted to them is the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {
namespace {

constexpr int kPoses_hz = 30, kFinest_hz = 10 * kPoses_hz;

struct Logging {
  const char* name;
  int every, first;  ///< of the finest samples
};

constexpr Logging kLoggings[] = {{"at the stamps of the poses", 10, 0},
                                 {"half a sample after the poses", 10, 5},
                                 {"at a tenth of the rate of the poses", 100, 0},
                                 {"at ten times the rate of the poses", 1, 0}};

/// Drives that are slow against a tenth of the poses' rate: what straight lines cut off the curves lies below
/// the noise.
std::vector<rig::Scenario> slowly(std::vector<rig::Scenario> scenarios) {
  for (rig::Scenario& scenario : scenarios) {
    scenario.mocap.rate_hz = kPoses_hz;
    scenario.pressures.rate_hz = kFinest_hz;
    scenario.pressures.ramp_s = 12.0;
    scenario.pressures.random->lowest_hz = 0.02;
    scenario.pressures.random->highest_hz = 0.033;
    scenario.mocap.ring_noise = {0.002, 0.02};
  }
  return scenarios;
}

const Candidate& clock_offset_of(const Diagnosis& said) {
  const auto clock = std::find_if(said.ranking.begin(), said.ranking.end(),
                                  [](const Candidate& c) { return c.id == "clock_offset"; });
  if (clock == said.ranking.end()) throw std::runtime_error("no clock_offset in the ranking");
  return *clock;
}

trial::Trial recorded(const arm::Arm& arm, const rig::Scenario& scenario, const Logging& logging,
                      std::size_t number) {
  return testing::record(
      arm, scenario, "trial_" + std::to_string(number), [&](const rig::InputSample& sample) {
        return (std::lround(sample.stamp_s * scenario.pressures.rate_hz) - logging.first) % logging.every ==
               0;
      });
}

TEST(InputStamps, ConstantsAreTheSameHoweverInputsAreLogged) {
  const testing::RecordedCase drawn =
      testing::drawn_case("{count_weights: [1]}", 11, 2, 26.0,
                          "attitudes: [hanging, horizontal], speeds: [1], payload_kg: [0, 0.1]");
  std::optional<Diagnosis> first;
  for (const Logging& logging : kLoggings) {
    SCOPED_TRACE(logging.name);
    std::vector<trial::Trial> trials;
    for (const rig::Scenario& scenario : slowly(drawn.truth))
      trials.push_back(recorded(drawn.arm, scenario, logging, trials.size() + 1));
    const Diagnosis said = diagnose(drawn.arm, trials);
    for (const NamedEffect& named : said.effects) ADD_FAILURE() << named.sentence;
    if (!first) first = said;
    EXPECT_LT(clock_offset_of(said).z, 3.0);
    EXPECT_LT(std::abs(clock_offset_of(said).estimate), 0.5 / kPoses_hz) << "half a sample";
    ASSERT_EQ(said.shifts.size(), first->shifts.size());
    for (std::size_t i = 0; i < said.shifts.size(); ++i)
      EXPECT_LE(std::abs(said.shifts[i].before - first->shifts[i].before), first->shifts[i].sd_before)
          << said.shifts[i].name;
  }
}

/// Rate of the poses, and how inputs are logged, of usual trials with usual noise. At a tenth of the rate
/// such inputs would not be known.
class UsualTrials : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(UsualTrials, AreConsistent) {
  const double rate_hz = GetParam().first;
  const Logging& logging = kLoggings[GetParam().second];
  SCOPED_TRACE(logging.name);
  testing::RecordedCase drawn =
      testing::drawn_case("{count_weights: [1]}", 23, 4, 15.0,
                          "attitudes: [hanging, horizontal], speeds: [0.5, 1], payload_kg: [0, 0.1]");
  for (rig::Scenario& scenario : drawn.truth) {
    scenario.mocap.rate_hz = rate_hz;
    scenario.pressures.rate_hz = 10.0 * rate_hz;
    drawn.trials.push_back(recorded(drawn.arm, scenario, logging, drawn.trials.size() + 1));
  }
  const double logged_hz = 10.0 * rate_hz / logging.every;
  for (const trial::InputSeries& series : drawn.trials.front().inputs)
    ASSERT_NEAR(static_cast<double>(series.stamp_ns.size()), 15.0 * logged_hz, 0.2 * logged_hz);
  const Diagnosis said = diagnose(drawn.arm, drawn.trials);
  for (const NamedEffect& named : said.effects) ADD_FAILURE() << named.sentence;
  EXPECT_EQ(said.verdict, Verdict::kConsistent) << said.summary;
  EXPECT_LT(std::abs(clock_offset_of(said).estimate), 0.25 / rate_hz) << "a quarter of a sample";
}

INSTANTIATE_TEST_SUITE_P(InputStamps, UsualTrials,
                         ::testing::Values(std::make_pair(25, 0), std::make_pair(30, 0),
                                           std::make_pair(30, 1), std::make_pair(30, 3)));

}  // namespace
}  // namespace softarm::diagnose
