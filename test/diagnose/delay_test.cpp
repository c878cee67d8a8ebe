// Clocks that are apart by seconds: found before anything is fitted, and named.
#include "delay.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "joint_model.h"
#include "policy.h"
#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

/// Nothing is hidden but the inputs' clock: what is logged is stamped early by so much, of one input or all.
/// @param apart_s of the beginnings of trials
testing::RecordedCase logged_early(const Delay& delay, double apart_s = 20.0, int trials = 4) {
  testing::RecordedCase drawn = testing::drawn_case("{count_weights: [1]}", 8, trials, 14.0);
  for (const rig::Scenario& scenario : drawn.truth) {
    const double session_s = apart_s * static_cast<double>(drawn.trials.size());
    const auto logged = [&](rig::InputSample& sample) {
      if (delay.input == 0 || sample.number == delay.input - 1)
        sample.stamp_s -= delay.offset_s + delay.rate * (session_s + sample.stamp_s);
      return true;
    };
    const std::string name = "trial_" + std::to_string(drawn.trials.size() + 1);
    drawn.trials.push_back(testing::record(drawn.arm, scenario, name, logged, 100.0 + session_s));
  }
  return drawn;
}

struct Case {
  const char* name;
  Delay delay;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class Delays : public ::testing::TestWithParam<Case> {};

TEST_P(Delays, AreFoundBeforeAnythingIsFitted) {
  const Delay& delay = GetParam().delay;
  const testing::RecordedCase recorded = logged_early(delay);
  const model::Prepared prepared = model::prepare(recorded.arm, recorded.trials);
  const std::vector<Delay> found = find_delays(recorded.arm, prepared.trials);
  ASSERT_EQ(found.size(), delay.rate == 0.0 ? 1U : 2U);
  EXPECT_NEAR(found[0].offset_s, delay.offset_s, 0.15);
  EXPECT_NEAR(found[0].rate, delay.rate, delay.rate == 0.0 ? 0.0 : 0.003);
  EXPECT_EQ(found[0].input, delay.input);
  EXPECT_EQ(found.back().rate, 0.0);
}

TEST_P(Delays, AreNamedWithTheirSize) {
  const Delay& delay = GetParam().delay;
  const testing::RecordedCase recorded = logged_early(delay);
  const Diagnosis d = diagnose(recorded.arm, recorded.trials);
  ASSERT_FALSE(d.effects.empty()) << report::describe(d);
  const NamedEffect& first = d.effects.front();
  EXPECT_GT(first.probability, 0.9) << report::describe(d);
  if (delay.rate != 0.0) {
    EXPECT_EQ(first.id, "clock_drift") << report::describe(d);
    EXPECT_NEAR(first.parameters.at(0).value, delay.rate, 0.001) << report::describe(d);
    EXPECT_NEAR(first.parameters.at(1).value, delay.offset_s, 0.03) << report::describe(d);
  } else {
    EXPECT_EQ(first.id, "clock_offset") << report::describe(d);
    EXPECT_NEAR(first.parameters.at(0).value, delay.offset_s, 0.02) << report::describe(d);
    EXPECT_EQ(first.parameters.at(1).value, delay.input);
  }
  EXPECT_EQ(d.verdict, Verdict::kExplained) << report::describe(d);
  EXPECT_LT(d.extended.held_out_mean_m, 0.1 * d.baseline.held_out_mean_m);
}

INSTANTIATE_TEST_SUITE_P(Clocks, Delays,
                         ::testing::Values(Case{"two_seconds_late", {2.0, 0, 0.0}},
                                           Case{"early", {-1.2, 0, 0.0}}, Case{"one_input", {0.9, 2, 0.0}},
                                           Case{"later_and_later", {0.0, 0, 0.03}},
                                           Case{"early_and_less_so", {-1.0, 0, 0.02}},
                                           Case{"between_steps", {2.05, 0, 0.0}}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(NoDelay, IsFoundWhereThereIsNone) {
  const testing::RecordedCase recorded = logged_early({});
  EXPECT_TRUE(find_delays(recorded.arm, model::prepare(recorded.arm, recorded.trials).trials).empty());
}

/// Then a rate shows within the trials alone.
TEST(NoDelay, GrowsWhereAllTrialsBeginAtOnce) {
  for (const int trials : {1, 4}) {
    for (const double offset_s : {2.0, -1.25}) {
      const testing::RecordedCase recorded = logged_early({offset_s, 0, 0.0}, 0.0, trials);
      const std::vector<Delay> found =
          find_delays(recorded.arm, model::prepare(recorded.arm, recorded.trials).trials);
      ASSERT_EQ(found.size(), 1U) << offset_s << " s, " << trials;
      EXPECT_NEAR(found[0].offset_s, offset_s, 0.15);
      EXPECT_EQ(found[0].rate, 0.0);
    }
  }
}

TEST(NoDelay, IsLookedForBeyondWhatTheCatalogueCanSay) {
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    if (!info.of_clocks && !info.of_clock_rates) continue;
    for (const model::Parameter& size : {info.parameters.at(0), info.parameters.at(1)}) {
      if (size.counts) continue;
      const double most = size.unit == "s" ? kPolicy.delay.longest_s : kPolicy.delay.greatest_rate;
      EXPECT_EQ(size.high, most) << info.id << ' ' << size.symbol;
      EXPECT_EQ(size.low, -most) << info.id << ' ' << size.symbol;
    }
  }
}

TEST(ADelay, ThatGrowsIsNoneInTrialsAnHourLater) {
  model::Series series;
  series.session_s = 100.0;
  const Delay grows{0.5, 0, 0.01}, stays{0.5, 0, 0.0};
  EXPECT_DOUBLE_EQ(grows.at(series, 20.0), 1.7);
  EXPECT_DOUBLE_EQ(stays.at(series, 20.0), 0.5);
  series.session_s = 3700.0;
  EXPECT_EQ(grows.at(series, 20.0), 0.0);
  EXPECT_DOUBLE_EQ(stays.at(series, 20.0), 0.5);
}

/// What is left out at the ends grows with it.
TEST(ADelay, ThatGrowsLeavesOutMoreOfLaterTrials) {
  const testing::RecordedCase recorded = logged_early({});
  const model::Prepared prepared = model::prepare(recorded.arm, recorded.trials);
  JointModel model(recorded.arm, prepared.trials, 0);
  const auto left_out = [&](std::size_t t) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < prepared.trials[t].blocks.size(); ++k)
      count += !prepared.trials[t].blocks[k].set_aside && !model.uses(t, k);
    return count;
  };
  std::vector<std::size_t> before;
  for (std::size_t t = 0; t < 4; ++t) before.push_back(left_out(t));
  const std::size_t all = model.leave_out_ends({0.0, 0, 0.03});
  std::size_t sum = 0, last = 0;
  for (std::size_t t = 0; t < 4; ++t) {
    const std::size_t more = left_out(t) - before[t];
    if (t > 0) {
      EXPECT_GT(more, last) << t;
    }
    last = more;
    sum += more;
  }
  EXPECT_EQ(all, sum);
}

}  // namespace
}  // namespace softarm::diagnose
