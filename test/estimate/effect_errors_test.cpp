// How well the numbers of effects are known reaches the estimate: intervals cover what the file says is not
// known of them, in single frames and in windows, for they are the same in all frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <random>
#include <vector>

#include "frames.h"
#include "model/online_effects.h"
#include "softarm/arm/laws.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::estimate::testing::effect_errors {
namespace {

struct Case {
  const char* name;
  std::vector<arm::EffectEntry> effects;
  arm::Unknown unknown = arm::Unknown::kStiffness;
  bool prior = false;
  double window_s = 0.0;
  double seconds = 0.0;  ///< of frames before the one that counts
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

arm::Arm arm_of(const Case& c) {
  arm::Arm arm = placed_exactly(paper_arm());
  arm.segments[0].length_range_m = {0.1, 0.4};
  arm.payload.range_kg = {-5.0, 5.0};
  arm::EstimatorOptions& options = arm.estimator;
  options.unknown = c.unknown;
  options.window_s = c.window_s;
  options.prior.enabled = c.prior;
  options.prior.moment_sd_nm = 0.002;
  options.prior.moment_sd_rel = 0.0;
  options.prior.moment_jitter_sd_nm = 1e-4;
  options.prior.bending_stiffness_sd_rel = 0.03;
  options.prior.length_sd_m = 0.0005;
  options.prior.length_jitter_sd_m = 1e-5;
  return arm;
}

/// An arm whose effects are as they are, not as the file has them, and whose laws err as the prior says.
class RealArm {
 public:
  RealArm(const arm::Arm& arm, std::vector<model::Present> effects, std::mt19937_64& random)
      : arm_(arm), random_(random) {
    Eigen::VectorXd common(effects.empty() ? 0 : effects[0].correlated.cols());  // to all numbers of the file
    for (Eigen::Index i = 0; i < common.size(); ++i) common[i] = normal();
    for (model::Present& present : effects) {
      for (Eigen::Index k = 0; k < present.values.size(); ++k) {
        const model::Parameter& parameter = present.effect->info().parameters[static_cast<std::size_t>(k)];
        double error = normal();
        if (k < present.correlated.rows() && !present.correlated.row(k).isZero(0.0))
          error = present.correlated.row(k).dot(common);
        present.values[k] =
            std::clamp(present.values[k] + present.sd[k] * error, parameter.low, parameter.high);
      }
    }
    model_.emplace(arm, effects);
    const arm::LawPrior& prior = arm.estimator.prior;
    moment_nm_ = prior.moment_sd_nm * Eigen::Vector2d(normal(), normal());
    stiffness_rel_ = prior.bending_stiffness_sd_rel * normal();
    length_m_ = prior.length_sd_m * normal();
  }
  double stiffness_rel() const { return stiffness_rel_; }

  trial::Frame frame(double stamp_s, const arm::InputValues& inputs, double payload_kg, double noise_sd_m) {
    const Eigen::Isometry3d base = horizontal();
    const auto driven = model_->begin(stamp_s, inputs, payload_kg, base);
    auto laws = predict(arm_, driven.inputs).value();
    stiffness_nm2 =
        laws[0].bending_stiffness_nm2 * (arm_.estimator.prior.enabled ? 1.0 + stiffness_rel_ : 1.0);
    laws[0].bending_stiffness_nm2 = stiffness_nm2;
    if (arm_.estimator.prior.enabled) {
      laws[0].moment_nm += moment_nm_;
      laws[0].length_m += length_m_;
    }
    if (!model_->solve(laws, *driven.payload_kg)) throw std::logic_error("a frame without equilibrium");
    model_->keep();
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(stamp_s);
    frame.base_body = base;
    frame.inputs = inputs;
    for (int k = 0; k < static_cast<int>(arm_.bodies.size()); ++k)
      frame.bodies.push_back(
          {k, base * model_->bodies().p.col(k) + noise_sd_m * normal3(random_), std::nullopt});
    return frame;
  }
  double stiffness_nm2 = 0.0;  ///< true, of the last frame

 private:
  double normal() { return std::normal_distribution<double>()(random_); }

  const arm::Arm arm_;
  std::mt19937_64& random_;
  std::optional<model::OnlineEffects> model_;
  Eigen::Vector2d moment_nm_;
  double stiffness_rel_ = 0.0, length_m_ = 0.0;
};

struct Coverage {
  int count = 0, stiffness = 0, payload = 0;
  double sum_of_stiffness_sd_nm2 = 0.0;
  double share_of_stiffness() const { return static_cast<double>(stiffness) / count; }
  double share_of_payload() const { return static_cast<double>(payload) / count; }
};

/// What the estimator has of the file.
enum class Has { kAll, kNoCorrelations, kNumbersAlone };

/// 95 % intervals in the last frame of each of many recordings.
Coverage coverage(const Case& c, Has has, int trials) {
  const arm::Arm arm = arm_of(c);
  const std::vector<model::Present> of_file = effects::effects_of(arm, c.effects);
  std::vector<model::Present> believed = of_file;
  for (model::Present& present : believed) {
    if (has != Has::kAll) present.correlated.resize(0, 0);
    if (has == Has::kNumbersAlone) present.sd.setZero();
  }
  std::mt19937_64 random(11);
  Coverage coverage;
  for (int trial = 0; trial < trials; ++trial) {
    RealArm real(arm, of_file, random);
    const double payload_kg = uniform(random, 0.1, 0.25);
    const arm::InputValues from{uniform(random, 10e3, 35e3), uniform(random, 0.0, 15e3), 0.0};
    const arm::InputValues to{uniform(random, 10e3, 35e3), uniform(random, 0.0, 15e3), 0.0};
    estimate::Estimator estimator(arm, arm.estimator, believed);
    estimator.set_backbone_points(0);
    estimate::Estimate estimate;
    const int frames = 1 + static_cast<int>(30.0 * c.seconds);
    for (int i = 0; i < frames; ++i) {
      const double share = frames > 1 ? static_cast<double>(i) / (frames - 1) : 1.0;
      arm::InputValues inputs = to;
      for (std::size_t k = 0; k < 2; ++k) inputs[k] = *from[k] + share * (*to[k] - *from[k]);
      trial::Frame frame = real.frame(1.0 + i / 30.0, inputs, payload_kg, arm.bodies[0].position_sd_m);
      if (c.unknown == arm::Unknown::kStiffness) frame.payload_kg = payload_kg;
      estimate = estimator.estimate(frame);
    }
    if (estimate.status != estimate::Status::kOk) throw std::logic_error(estimate.detail);
    const SegmentEstimate& segment = estimate.segments[0];
    ++coverage.count;
    if (segment.sd_bending_stiffness_nm2) {
      coverage.stiffness += std::abs(*segment.bending_stiffness_nm2 - real.stiffness_nm2) <
                            1.96 * *segment.sd_bending_stiffness_nm2;
      coverage.sum_of_stiffness_sd_nm2 += *segment.sd_bending_stiffness_nm2;
    }
    if (estimate.sd_payload_kg)
      coverage.payload += std::abs(*estimate.payload_kg - payload_kg) < 1.96 * *estimate.sd_payload_kg;
  }
  return coverage;
}

const arm::EffectEntry kBase{"base_compliance", {{"compliance_rad_per_nm", 0.3, 0.08}}};
const arm::EffectEntry kTip{"tip_mass", {{"mass_kg", 0.06, 0.02}}};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"stiffness", {kBase, kTip}},
      {"stiffness_of_a_told_payload", {{"payload_scale", {{"share", 0.1, 0.15}}}}},
      {"stiffness_with_memory",
       {{"creep", {{"share", 0.4, 0.15}, {"time_s", 1.5, 0.5}}}, kTip},
       arm::Unknown::kStiffness,
       false,
       0.0,
       1.5},
      {"payload", {kBase, kTip}, arm::Unknown::kPayload},
      {"payload_by_laws",
       {{"gain_nonlinearity", {{"share", 0.2, 0.1}}}, kBase},
       arm::Unknown::kPayload,
       true},
      {"both_by_laws",
       {{"pressure_offset", {{"offset_1_pa", 500.0, 1500.0}}}, kTip},
       arm::Unknown::kBoth,
       true},
      {"window_of_stiffness", {kBase, kTip}, arm::Unknown::kStiffness, false, 0.5, 0.5},
      {"window_of_payload",
       {{"gain_nonlinearity", {{"share", 0.2, 0.1}}}, kBase},
       arm::Unknown::kPayload,
       true,
       0.5,
       1.0},
      {"window_of_both", {kBase, kTip}, arm::Unknown::kBoth, true, 0.5, 0.5},
  };
  return list;
}

class EffectErrors : public ::testing::TestWithParam<Case> {};

TEST_P(EffectErrors, IntervalsCoverWhereEffectsErrAsTheFileSays) {
  const Case& c = GetParam();
  const int trials = 300;
  const Coverage with = coverage(c, Has::kAll, trials), without = coverage(c, Has::kNumbersAlone, trials / 3);
  std::printf("%-28s EI %3.0f %% (exact: %3.0f %%), payload %3.0f %% (exact: %3.0f %%)\n", c.name,
              100.0 * with.share_of_stiffness(), 100.0 * without.share_of_stiffness(),
              100.0 * with.share_of_payload(), 100.0 * without.share_of_payload());
  const auto covers = [](double share, double exact) {
    EXPECT_GE(share, 0.90);
    EXPECT_LE(share, 0.97);
    EXPECT_LT(exact, 0.8) << "with the numbers taken for exact";
  };
  if (c.unknown != arm::Unknown::kStiffness) covers(with.share_of_payload(), without.share_of_payload());
  if (c.unknown == arm::Unknown::kBoth) {
    EXPECT_GE(with.share_of_stiffness(), 0.90);
  }
  if (c.unknown == arm::Unknown::kStiffness) covers(with.share_of_stiffness(), without.share_of_stiffness());
}

INSTANTIATE_TEST_SUITE_P(Frames, EffectErrors, ::testing::ValuesIn(cases()),
                         [](const auto& one) { return std::string(one.param.name); });

/// Pairs of numbers of which trials determine what both do together, not either of them: each alone makes
/// two to four times the error of a frame's noise, both together about as much as that.
const std::vector<Case>& against_each_other() {
  static const std::vector<Case> list{
      // With payloads of one size, a mass at the tip is hidden by payloads that weigh less than stated.
      {"told_payload_and_tip",
       {{"tip_mass", {{"mass_kg", 0.15, 0.02, {{1, "share", 0.98}}}}},
        {"payload_scale", {{"share", 0.1, 0.12}}}}},
      {"creep_and_tip",
       {{"creep", {{"share", 0.4, 0.1}, {"time_s", 1.5}}},
        {"tip_mass", {{"mass_kg", 0.15, 0.03, {{0, "share", -0.95}}}}}},
       arm::Unknown::kStiffness,
       false,
       0.0,
       1.5},
      {"window_of_base_and_tip",
       {{"base_compliance", {{"compliance_rad_per_nm", 0.3, 0.045, {{1, "mass_kg", -0.97}}}}},
        {"tip_mass", {{"mass_kg", 0.15, 0.03}}}},
       arm::Unknown::kStiffness,
       false,
       0.5,
       0.5},
  };
  return list;
}

class CorrelatedErrors : public ::testing::TestWithParam<Case> {};

TEST_P(CorrelatedErrors, IntervalsAreNarrowerByTheCorrelationAndCover) {
  const Case& c = GetParam();
  const int trials = 200;
  const Coverage with = coverage(c, Has::kAll, trials),
                 without = coverage(c, Has::kNoCorrelations, trials / 2);
  const double sd = with.sum_of_stiffness_sd_nm2 / with.count,
               sd_without = without.sum_of_stiffness_sd_nm2 / without.count;
  std::printf("%-28s EI %3.0f %%, +- %.4f N m^2 (without the correlation %3.0f %%, +- %.4f N m^2)\n", c.name,
              100.0 * with.share_of_stiffness(), sd, 100.0 * without.share_of_stiffness(), sd_without);
  EXPECT_GE(with.share_of_stiffness(), 0.90);
  EXPECT_LE(with.share_of_stiffness(), 0.99);
  EXPECT_LT(sd, 0.6 * sd_without);
  // A window learns of its numbers by a belief that is wrong: wide as it is, it need not be wide enough.
  if (c.window_s == 0.0) {
    EXPECT_GE(without.share_of_stiffness(), 0.97) << "far too wide";
  }
}

INSTANTIATE_TEST_SUITE_P(Frames, CorrelatedErrors, ::testing::ValuesIn(against_each_other()),
                         [](const auto& one) { return std::string(one.param.name); });

/// Numbers that err alike make larger errors than each by itself would.
TEST(EffectCorrelations, IntervalsAreWiderWhereErrorsAddUp) {
  const Case c{"base_and_tip_alike",
               {{"base_compliance", {{"compliance_rad_per_nm", 0.3, 0.03, {{1, "mass_kg", 0.97}}}}},
                {"tip_mass", {{"mass_kg", 0.15, 0.02}}}}};
  const Coverage with = coverage(c, Has::kAll, 200), without = coverage(c, Has::kNoCorrelations, 200);
  EXPECT_GE(with.share_of_stiffness(), 0.90);
  EXPECT_GT(with.sum_of_stiffness_sd_nm2, 1.15 * without.sum_of_stiffness_sd_nm2);
  EXPECT_LT(without.share_of_stiffness(), with.share_of_stiffness());
}

/// Correlations of 0 are none: estimates are the same to the last digit.
TEST(EffectCorrelations, WithoutAnyEstimatesAreAsBefore) {
  for (const double window_s : {0.0, 0.5}) {
    Case c{"none", {kBase, kTip}, arm::Unknown::kBoth, true, window_s};
    const arm::Arm arm = arm_of(c);
    const std::vector<model::Present> without = effects::effects_of(arm, c.effects);
    c.effects[1].numbers[0].correlations = {{0, "compliance_rad_per_nm", 0.0}};
    const std::vector<model::Present> with = effects::effects_of(arm, c.effects);
    ASSERT_EQ(with[0].correlated.cols(), 2);
    std::mt19937_64 random(5);
    RealArm real(arm, without, random);
    estimate::Estimator one(arm, arm.estimator, without), other(arm, arm.estimator, with);
    for (int i = 0; i < 15; ++i) {
      const trial::Frame frame = real.frame(1.0 + i / 30.0, {10e3 + 1e3 * i, 8e3, 0.0}, 0.2, 5e-4);
      const estimate::Estimate a = one.estimate(frame), b = other.estimate(frame);
      ASSERT_EQ(a.status, estimate::Status::kOk) << a.detail;
      EXPECT_EQ(a.segments[0].bending_stiffness_nm2, b.segments[0].bending_stiffness_nm2);
      EXPECT_EQ(a.segments[0].sd_bending_stiffness_nm2, b.segments[0].sd_bending_stiffness_nm2);
      EXPECT_EQ(a.payload_kg, b.payload_kg);
      EXPECT_EQ(a.sd_payload_kg, b.sd_payload_kg);
    }
  }
}

}  // namespace
}  // namespace softarm::estimate::testing::effect_errors
