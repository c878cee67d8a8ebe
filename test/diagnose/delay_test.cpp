// Clocks that are apart by seconds: found before anything is fitted, and named.
#include "delay.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <string>

#include "recorded_case.h"
#include "softarm/diagnose/diagnose.h"
#include "softarm/report/report.h"

namespace softarm::diagnose {
namespace {

constexpr double kApart_s = 20.0;  // a trial begins

/// Nothing is hidden but the inputs' clock: what is logged is stamped early by so much, of one input or all.
testing::RecordedCase logged_early(const Delay& delay) {
  testing::RecordedCase drawn = testing::drawn_case("{count_weights: [1]}", 8, 4, 14.0);
  for (const rig::Scenario& scenario : drawn.truth) {
    const double session_s = kApart_s * static_cast<double>(drawn.trials.size());
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
  const std::optional<Delay> found = find_delay(recorded.arm, prepared.trials);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_s, delay.offset_s, 0.15);
  EXPECT_NEAR(found->rate, delay.rate, 0.005);
  EXPECT_EQ(found->input, delay.input);
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
                                           Case{"early_and_less_so", {-1.0, 0, 0.02}}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(NoDelay, IsFoundWhereThereIsNone) {
  const testing::RecordedCase recorded = logged_early({});
  EXPECT_FALSE(find_delay(recorded.arm, model::prepare(recorded.arm, recorded.trials).trials));
}

}  // namespace
}  // namespace softarm::diagnose
