// Unknowns at the ends of their ranges: how first-order steps, signatures and evidence take them.
#include "diagnose/ranges.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "diagnose/beyond_range.h"
#include "diagnose/evidence_data.h"
#include "diagnose/refits.h"
#include "diagnose/screen.h"
#include "diagnose/selection.h"
#include "diagnose/unseen.h"
#include "effects/catalogue.h"
#include "looked.h"
#include "recorded_case.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Ranges, TheLeastWithinThemIsThatOfAGrid) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 50; ++n) {
    const MatrixXd a = MatrixXd::NullaryExpr(3, 2, [&] { return normal(random); });
    const MatrixXd h = a.transpose() * a + 0.1 * MatrixXd::Identity(2, 2);
    const VectorXd g = VectorXd::NullaryExpr(2, [&] { return normal(random); });
    const std::vector<Room> rooms = {{0.0, 1.0}, {-10.0, 10.0}};  // the second is wide enough
    VectorXd x;
    const double least = least_within(h, g, 100.0, rooms, x);
    EXPECT_NEAR(least, 100.0 - 2.0 * g.dot(x) + x.dot(h * x), 1e-9);
    EXPECT_GE(x[0], 0.0);
    EXPECT_LE(x[0], 1.0);
    double by_grid = 1e300;
    for (int i = 0; i <= 200; ++i) {
      const double x0 = i / 200.0, x1 = std::clamp((g[1] - h(0, 1) * x0) / h(1, 1), -10.0, 10.0);
      const Eigen::Vector2d there(x0, x1);
      by_grid = std::min(by_grid, 100.0 - 2.0 * g.dot(there) + there.dot(h * there));
    }
    EXPECT_NEAR(least, by_grid, 1e-3);
  }
}

TEST(Ranges, NothingDrawsTheLeastWithinThemAnyFurther) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int at_ends = 0, would_return = 0;
  for (int n = 0; n < 200; ++n) {
    // Nearly degenerate: the least without rooms lies far outside in many of them.
    const MatrixXd a = MatrixXd::NullaryExpr(8, 8, [&] { return normal(random); });
    const MatrixXd h = a.transpose() * a + 1e-3 * MatrixXd::Identity(8, 8);
    const VectorXd g = VectorXd::NullaryExpr(8, [&] { return 3.0 * normal(random); });
    std::vector<Room> rooms;
    for (int j = 0; j < 8; ++j) rooms.push_back({-std::abs(normal(random)), j == 7 ? 0.0 : 1.0});
    VectorXd x;
    least_within(h, g, 0.0, rooms, x);
    const VectorXd drawn = g - h * x, alone = h.ldlt().solve(g);
    for (int j = 0; j < 8; ++j) {
      const Room& room = rooms[static_cast<std::size_t>(j)];
      const bool low = x[j] == room.low, high = x[j] == room.high;
      EXPECT_TRUE(x[j] >= room.low && x[j] <= room.high) << n << " " << j;
      if (!low) {
        EXPECT_GT(drawn[j], -1e-6) << n << " " << j;
      }
      if (!high) {
        EXPECT_LT(drawn[j], 1e-6) << n << " " << j;
      }
      at_ends += low || high;
      would_return += !low && !high && (alone[j] < room.low || alone[j] > room.high);
    }
  }
  EXPECT_GT(at_ends, 100);
  EXPECT_GT(would_return, 100);  // those that one round would have left at their ends
}

/// An arm whose file does not let EI be as low as it is: the fit ends at the end of the range.
struct AtAnEnd {
  explicit AtAnEnd(const std::string& effects = "{count_weights: [1]}")
      : drawn(testing::recorded_case(effects, 43, 4, 8.0)) {
    const testing::Looked free(drawn.arm, drawn.trials);
    const JointUnknown& stiffness = free.baseline.columns[column_of(free)];
    fitted = value_of(free.baseline.at, stiffness);
    drawn.arm.segments[0].bending_stiffness_range_nm2 = {1.1 * fitted, 10.0 * fitted};
    drawn.arm.segments[0].bending_stiffness.base_nm2 = 1.3 * fitted;
  }
  static std::size_t column_of(const testing::Looked& looked) {
    for (std::size_t j = 0; j < looked.baseline.columns.size(); ++j) {
      const JointUnknown& c = looked.baseline.columns[j];
      if (c.kind != JointUnknown::Kind::kConstant) continue;
      const arm::ConstantRef& constant = looked.model.constants()[static_cast<std::size_t>(c.index)];
      if (constant.kind == arm::ConstantKind::kBendingStiffness) return j;
    }
    throw std::logic_error("no stiffness");
  }
  testing::RecordedCase drawn;
  double fitted = 0.0;  ///< EI without the range
};

TEST(Ranges, WhatTheTrialsDrawBeyondAnEndStaysThereAndAbsorbsLittle) {
  AtAnEnd arm;
  testing::Looked looked(arm.drawn.arm, arm.drawn.trials);
  const auto j = static_cast<Eigen::Index>(AtAnEnd::column_of(looked));
  const std::vector<bool> held = held_at_ends(looked.baseline);
  ASSERT_EQ(std::count(held.begin(), held.end(), true), 1);
  ASSERT_TRUE(held[static_cast<std::size_t>(j)]);
  const VectorXd spread = spread_at_ends(looked.baseline);
  EXPECT_GT(spread[j], 0.0);
  EXPECT_LT(spread[j], looked.baseline.columns[static_cast<std::size_t>(j)].prior_sd);
  EXPECT_EQ((spread.array() > 0.0).count(), 1);
  EXPECT_TRUE(drawn_beyond(looked.baseline)[static_cast<std::size_t>(j)]);

  // What the screen expects of an effect is what a fit with it finds.
  const Standing alone{looked.baseline, unseen(looked.model, looked.baseline)};
  for (const Screened& s : screen(looked.model, looked.baseline, 0, [](double) {})) {
    if (s.effect->info().id != "soft_spot" && s.effect->info().id != "stiffness_taper") continue;
    SCOPED_TRACE(s.effect->info().id);
    EXPECT_LT(std::abs(s.absorbed[j]), 3.0 * spread[j]);
    const double fall = looked.baseline.square - refit(looked.model, alone, s).fit.square;
    EXPECT_NEAR(s.gain, fall, 0.3 * fall);
  }
}

TEST(Ranges, UnseenTrialsArePredictedFromWithinThem) {
  AtAnEnd arm;
  testing::Looked looked(arm.drawn.arm, arm.drawn.trials);
  const Unseen first_order = unseen(looked.model, looked.baseline),
               refitted = refitted_unseen(looked.model, looked.baseline);
  EXPECT_NEAR(first_order.total_rms_m, refitted.total_rms_m, 0.01 * refitted.total_rms_m);
}

TEST(Ranges, APlaceOnTheArmIsLookedForWithinItsLength) {
  const testing::RecordedCase drawn = testing::recorded_case("{count_weights: [1]}", 43, 2, 5.0);
  testing::Looked looked(drawn.arm, drawn.trials);
  int places = 0;
  for (const char* id : {"contact", "soft_spot"}) {
    JointParameters with = looked.model.start();
    with.effects.push_back(
        {effects::find(id), effects::find(id)->grid(drawn.arm, looked.model.rod()).front()});
    for (const JointUnknown& c : looked.model.columns(with)) {
      if (c.kind != JointUnknown::Kind::kEffect) continue;
      const model::Parameter& parameter =
          effects::find(id)->info().parameters[static_cast<std::size_t>(c.parameter)];
      EXPECT_FALSE(parameter.held) << parameter.symbol << " is no unknown";
      EXPECT_EQ(c.high, parameter.along ? drawn.arm.total_length_m() : parameter.high) << parameter.symbol;
      places += parameter.along;
    }
  }
  EXPECT_EQ(places, 2);
}

TEST(Ranges, EvidenceHasTheSliceOfThePriorThatTheEndLeaves) {
  AtAnEnd arm;
  testing::Looked looked(arm.drawn.arm, arm.drawn.trials);
  const std::size_t j = AtAnEnd::column_of(looked);
  const EvidenceData data = evidence_of_refit(looked.model, looked.baseline, looked.baseline);
  const JointUnknown& column = looked.baseline.columns[j];
  const double mean = column.start - looked.baseline.unknowns()[static_cast<Eigen::Index>(j)];
  const double spread = spread_at_ends(looked.baseline)[static_cast<Eigen::Index>(j)];
  double share = 0.0;  // of the prior, as the likelihood falls off from the end
  const double step = 1e-3 * spread;
  for (double y = 0.5 * step; y < 20.0 * spread; y += step)
    share += step * std::exp(-y / spread - 0.5 * std::pow((y - mean) / column.prior_sd, 2)) /
             (std::sqrt(2.0 * M_PI) * column.prior_sd);
  EXPECT_NEAR(data.unknowns[j].log_weight, std::log(share), 0.05);
  EXPECT_EQ(data.unknowns[j].prior_sd, spread);
  for (std::size_t i = 0; i < data.unknowns.size(); ++i) {
    if (i == j) continue;
    EXPECT_EQ(data.unknowns[i].log_weight, 0.0);
    EXPECT_EQ(data.unknowns[i].prior_sd, looked.baseline.columns[i].prior_sd);
  }
}

TEST(Ranges, ThatAreTooNarrowAreSaidWithWhatTheConstantWouldBe) {
  AtAnEnd arm;
  testing::Looked looked(arm.drawn.arm, arm.drawn.trials);
  Selection selection;
  selection.baseline = looked.baseline;
  selection.baseline_unseen = unseen(looked.model, looked.baseline);
  const BeyondRange said = beyond_range(looked.model, selection, {});
  EXPECT_TRUE(said.helps);
  EXPECT_TRUE(said.still_there.empty());
  EXPECT_NE(said.text.find("segment_1.bending_stiffness.base rests at"), std::string::npos) << said.text;
  EXPECT_NE(said.text.find(fmt::format("With segment_1.bending_stiffness.base at {:.3g}", arm.fitted)),
            std::string::npos)
      << said.text;
  const Unseen narrow = selection.baseline_unseen;
  selection.baseline_unseen.total_rms_m = 0.0;  // by next to nothing
  EXPECT_FALSE(beyond_range(looked.model, selection, {}).helps);
  selection.baseline_unseen = narrow;
  selection.baseline_unseen.mean_m = 0.0;
  const BeyondRange no_better = beyond_range(looked.model, selection, {});
  EXPECT_FALSE(no_better.helps);
  EXPECT_FALSE(no_better.text.empty());

  arm.drawn.arm.segments[0].bending_stiffness_range_nm2.low = 0.5 * arm.fitted;
  testing::Looked wide(arm.drawn.arm, arm.drawn.trials);
  selection.baseline = wide.baseline;
  EXPECT_EQ(beyond_range(wide.model, selection, {}).text, "");
}

/// The selection of an arm whose range is too narrow, and how sure each effect of it is without that range.
std::map<std::string, double> there_beyond(const AtAnEnd& arm, int most_effects, Selection& selection) {
  testing::Looked looked(arm.drawn.arm, arm.drawn.trials);
  Options options;
  options.most_effects = most_effects;
  selection = select(looked.model, looked.baseline, std::nullopt, options, [](double, const std::string&) {});
  const BeyondRange beyond = beyond_range(looked.model, selection, options);
  std::map<std::string, double> there;
  for (std::size_t e = 0; e < beyond.still_there.size(); ++e)
    there[selection.extended.at.effects[e].effect->info().id] = beyond.still_there[e];
  return there;
}

TEST(Ranges, EffectsThatStandInForOneThatIsTooNarrowAreHardlyThere) {
  Selection selection;
  const std::map<std::string, double> there = there_beyond(AtAnEnd(), 1, selection);
  ASSERT_EQ(there.size(), 1U);
  EXPECT_GT(selection.doubt.still_there[0], 0.9) << there.begin()->first;
  EXPECT_LT(there.begin()->second, 0.1) << there.begin()->first;
}

TEST(Ranges, EffectsThatAreThereBesideOneThatIsTooNarrowStay) {
  Selection selection;
  const std::map<std::string, double> there = there_beyond(
      AtAnEnd("{count_weights: [0, 1], from: [base_compliance], size: [0.5, 0.6]}"), 2, selection);
  ASSERT_EQ(there.count("base_compliance"), 1U);
  EXPECT_GT(there.at("base_compliance"), 0.9);
}

TEST(Ranges, TheVerdictBeginsWithOneThatIsTooNarrow) {
  AtAnEnd arm;
  Options options;
  options.most_effects = 1;
  const Diagnosis d = diagnose(arm.drawn.arm, arm.drawn.trials, options);
  EXPECT_NE(d.verdict, Verdict::kConsistent);
  EXPECT_EQ(
      d.summary.find("In the fit of the arm's constants alone, segment_1.bending_stiffness.base rests at"),
      0U)
      << d.summary;
  EXPECT_TRUE(d.narrow_range);
}

}  // namespace
}  // namespace softarm::diagnose
